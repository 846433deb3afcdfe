//! Robots, and what they carry.

use super::body::Body;
use super::models::{DEFAULT_SIZE_M, Placed};
use super::tree::Entity;
use super::world::Builder;
use super::{StageRobot, outline};
use nalgebra::Isometry2;

/// The length and the width of a ranger and a laser, where the file gives none, m.
const DEFAULT_RANGER_SIZE_M: f64 = 0.15;
/// The share by which an outline may be larger than the body without a warning.
const MAX_GAIN: f64 = 0.01;

impl Builder<'_, '_> {
    /// Adds a robot with all that it carries.
    pub(super) fn robot(&mut self, entity: &Entity) {
        let on_floor = Isometry2::identity();
        let Placed { name, is_solid, at, body } = self.placed(entity, &on_floor, DEFAULT_SIZE_M, true);
        if !is_solid {
            let help = "here every robot is solid and seen";
            self.sources.warning(entity.place, "this robot is a ghost in Stage", help);
        }
        let (drive, velocity, acceleration, odometry) = self.motion(entity);
        let mut robot = StageRobot {
            name,
            place: self.sources.name(entity.place),
            pose: at,
            footprint: Vec::new(),
            outline: Vec::new(),
            drive,
            velocity,
            acceleration,
            odometry,
            lasers: Vec::new(),
            sonars: Vec::new(),
            mass_kg: self.number(entity, "mass", 0.0..=1e5),
            wanders: self.wanders(entity),
            at: entity.place,
            keys: entity.properties.iter().map(|(name, key)| (name.clone(), key.place())).collect(),
        };
        add_body(&mut robot, &body);
        for part in entity.carried() {
            self.carry(part, &at, &mut robot);
        }
        if robot.footprint.is_empty() {
            let help = "give it a `size`, a `block` or a `bitmap`";
            self.sources.error(entity.place, "a robot without a body", help);
        } else if !robot.is_round() {
            self.outline(&mut robot);
        }
        self.robots.push(robot);
    }

    /// Adds an entity to the robot that carries it.
    fn carry(&mut self, entity: &Entity, on: &Isometry2<f64>, robot: &mut StageRobot) {
        let (is_sensor, size_m) = match entity.kind.as_str() {
            "ranger" | "laser" => (true, DEFAULT_RANGER_SIZE_M),
            "model" | "puck" => (false, DEFAULT_SIZE_M),
            "position" => {
                let help = "here it is a part of the robot that carries it";
                self.sources.warning(entity.place, "a robot on a robot", help);
                self.motion(entity);
                (false, DEFAULT_SIZE_M)
            }
            _ => return self.other(entity),
        };
        let Placed { at, body, is_solid, .. } = self.placed(entity, on, size_m, !is_sensor);
        if is_solid {
            add_body(robot, &body);
        }
        if is_sensor {
            self.sense(entity, &at, robot);
        }
        for part in entity.carried().filter(|part| part.kind != "sensor") {
            self.carry(part, &at, robot);
        }
    }

    /// Gives a robot that is not round the outline that it has here.
    fn outline(&mut self, robot: &mut StageRobot) {
        let (at, name) = (robot.at, &robot.name);
        let Some(outline) = outline::of(&robot.footprint) else {
            let help = "which holds all of it; an outline must hold it, 0.02 m inside or more";
            let help = format!("it is a disc of {:.3} m about that point here, {help}", robot.radius_m());
            let what = format!("`{name}` does not hold the point that it turns about");
            return self.sources.warning(at, what, help);
        };
        if outline.gain > MAX_GAIN {
            let help = "here its outline is the smallest convex one around it";
            let what = format!("`{name}` is not convex: here it covers {:.0} % more", outline.gain * 100.0);
            self.sources.warning(at, what, help);
        }
        robot.outline = outline.corners;
    }

    fn wanders(&mut self, robot: &Entity) -> bool {
        let Some(property) = robot.get("ctrl") else { return false };
        let help =
            "Stage's controllers are programs of its own; `wander` is replaced by our own, others by none";
        self.sources.warning(property.place(), "controllers of Stage cannot be loaded", help);
        let mut names = property.values.iter().map(|value| self.sources.text(value.place));
        names.any(|name| name.split_whitespace().next() == Some("wander"))
    }
}

fn add_body(robot: &mut StageRobot, body: &Body) {
    let to_robot = robot.pose.inverse();
    let corners = body.corners().map(|polygon| polygon.iter().map(|corner| to_robot * corner).collect());
    robot.footprint.extend(corners);
}
