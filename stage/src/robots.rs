//! Robots, and what they carry.

use super::heights::{Beam, Solid};
use super::outline;
use super::senses::Sensor;
use super::tree::Thing;
use super::values::Pose;
use super::world::{Builder, DEFAULT_SIZE_M};
use super::{StageRobot, body::Body};
use nalgebra::Isometry2;

/// The size of a ranger and a laser, where the file gives none, m.
const DEFAULT_RANGER_SIZE_M: [f64; 3] = [0.15, 0.15, 0.2];
/// An outline that is larger than the body by no more than this share goes without saying.
const MOST_GAIN: f64 = 0.01;

impl Builder<'_, '_> {
    /// A thing that drives, with all that it carries.
    pub(super) fn robot(&mut self, thing: &Thing) {
        let looks = self.looks(thing);
        if !looks.is_there() {
            let help = "here every robot is solid and seen";
            self.reader.sources.warning(thing.place, "this robot is a ghost in Stage", "", help);
        }
        let (at, body, top) = self.place(thing, &Pose::origin(), DEFAULT_SIZE_M, true);
        self.warn_of_half_ghost(thing, &looks, &body);
        let motion = self.reader.motion(thing);
        let mass_kg = self.reader.number(thing, "mass", 0.0..=1e5);
        let controllers = self.controllers(thing);
        let index = self.robots.len();
        let mut robot = StageRobot {
            name: looks.name,
            color: looks.color,
            place: self.reader.sources.name(thing.place),
            pose: at.flat,
            footprint: Vec::new(),
            outline: Vec::new(),
            drive: motion.drive,
            velocity: motion.velocity,
            acceleration: motion.acceleration,
            odometry: motion.odometry,
            lasers: Vec::new(),
            sonars: Vec::new(),
            fiducial: None,
            tag: looks.tag.map(|(tag, _)| tag),
            mass_kg,
            controllers,
            at: thing.place,
            keys: thing.properties.iter().map(|(name, key)| (name.clone(), key.place())).collect(),
        };
        self.add_body(&mut robot, thing, &body, index);
        for part in thing.parts.iter().filter(|part| part.kind != "block") {
            self.carried(part, &top, &mut robot, index);
        }
        if robot.footprint.is_empty() {
            let help = "give it a `size`, a `block` or a `bitmap`";
            self.reader.sources.error(thing.place, "a robot without a body", "", help);
        }
        if !robot.footprint.is_empty() && !robot.is_round() {
            self.outline(&mut robot);
        }
        self.robots.push(robot);
    }

    /// A thing on a robot.
    fn carried(&mut self, thing: &Thing, on: &Pose, robot: &mut StageRobot, index: usize) {
        let (is_sensor, size_m) = match thing.kind.as_str() {
            "ranger" | "laser" => (true, DEFAULT_RANGER_SIZE_M),
            "fiducial" => (true, [0.0; 3]),
            "model" | "puck" => (false, DEFAULT_SIZE_M),
            "position" => {
                let help = "here it is a part of the robot that carries it";
                self.reader.sources.warning(thing.place, "a robot on a robot", "", help);
                self.reader.motion(thing);
                (false, DEFAULT_SIZE_M)
            }
            _ => return self.other(thing),
        };
        let looks = self.looks(thing);
        if let Some((_, place)) = looks.tag {
            let help = "a robot has one tag here, that of its own `position`";
            self.reader.sources.warning(place, "a tag of a part of a robot is left out", "", help);
        }
        let (at, body, top) = self.place(thing, on, size_m, !is_sensor);
        self.warn_of_half_ghost(thing, &looks, &body);
        if looks.is_there() {
            self.add_body(robot, thing, &body, index);
        }
        if is_sensor {
            self.sense(thing, &at, robot, index);
        }
        for part in thing.parts.iter().filter(|part| part.kind != "block" && part.kind != "sensor") {
            self.carried(part, &top, robot, index);
        }
    }

    /// A sensor on a robot, which stands `at` in the world.
    fn sense(&mut self, thing: &Thing, at: &Pose, robot: &mut StageRobot, index: usize) {
        let seen_from_robot = |at: &Pose| Pose { flat: robot.pose.inverse() * at.flat, ..*at };
        if thing.kind == "fiducial" {
            // Stage looks from its pose, whatever its origin.
            if robot.fiducial.is_some() {
                let help = "a robot has one here, its first";
                return self.left_out(thing, "a second fiducial finder on one robot is left out", help);
            }
            robot.fiducial = self.reader.fiducial(thing, &seen_from_robot(at));
            self.heights.beams.push(Beam { robot: index, place: thing.place, z_m: at.z_m });
            return;
        }
        let origin = self.reader.pose(thing, "origin").unwrap_or(Pose::origin());
        let mount = seen_from_robot(&at.then(&origin));
        let sensors: Vec<(Sensor, f64)> = match thing.kind.as_str() {
            "laser" => self.reader.old_laser(thing, &mount).into_iter().collect(),
            _ => self.reader.ranger(thing, &mount),
        };
        for (sensor, z_m) in sensors {
            match sensor {
                Sensor::Laser(laser) => robot.lasers.push(laser),
                Sensor::Sonar(sonar) => robot.sonars.push(sonar),
            }
            self.heights.beams.push(Beam { robot: index, place: thing.place, z_m });
        }
    }

    /// Gives a robot that is not round the outline that it has here.
    fn outline(&mut self, robot: &mut StageRobot) {
        let (at, name) = (robot.at, &robot.name);
        let Some(outline) = outline::of(&robot.footprint) else {
            let radius_m = robot.radius_m();
            let help = format!(
                "it is a disc of {radius_m:.3} m about that point here, which holds all of it; an outline must hold it, 0.02 m inside or more"
            );
            let what = format!("`{name}` does not hold the point that it turns about");
            return self.reader.sources.warning(at, &what, "", &help);
        };
        if outline.gain > MOST_GAIN {
            let help = "here its outline is the smallest convex one around it";
            let what = format!("`{name}` is not convex: here it covers {:.0} % more", outline.gain * 100.0);
            self.reader.sources.warning(at, &what, "", help);
        }
        robot.outline = outline.corners;
    }

    fn add_body(&mut self, robot: &mut StageRobot, thing: &Thing, body: &Body, index: usize) {
        if body.is_empty() {
            return;
        }
        let to_robot: Isometry2<f64> = robot.pose.inverse();
        let corners = body.corners().map(|polygon| polygon.iter().map(|corner| to_robot * corner).collect());
        robot.footprint.extend(corners);
        let name = robot.name.clone();
        self.heights.solids.push(Solid { name, robot: Some(index), place: thing.place, z_m: body.z_m });
    }

    fn controllers(&mut self, robot: &Thing) -> Vec<String> {
        let Some(property) = self.reader.property(robot, "ctrl") else {
            return Vec::new();
        };
        let names: Vec<String> =
            property.values.iter().map(|value| self.reader.sources.text(value.place).to_owned()).collect();
        let help =
            "Stage's controllers are programs of its own; `wander` is replaced by our own, others by none";
        self.reader.sources.warning(property.place(), "controllers of Stage cannot be loaded", "", help);
        names
    }
}
