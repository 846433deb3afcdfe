//! Any number of robots in one place.

mod controller;
mod state;
mod teleport;
mod time;

pub use controller::Controller;
pub use teleport::TeleportError;

use super::bodies::Bodies;
use super::command::Command;
use super::finder::Tagged;
use super::form::Form;
use super::laser::beams;
use super::obstacles::Obstacle;
use super::rays::{Beams, Disc, Scene, Scratch};
use super::report::{Body, Contact, ObstacleView, RobotView};
use super::robot::{Now, Robot};
use super::shape::Rectangle;
use super::spec::{FleetSpec, LaserSpec, RobotSpec};
use interfaces::{GridFrame, LaserReading};
use nalgebra::{Point2, Vector2};
use std::sync::Arc;

/// A place with any number of robots.
///
/// The same spec, seed and commands give the same bits, on every machine and any number of threads.
/// A clone is a fork: it lives on by itself, and alike under the same commands.
#[derive(Clone)]
pub struct Fleet {
    spec: FleetSpec,
    seed: u64,
    /// Steps since the start; time is a multiple, so that it never drifts.
    step: u64,
    bodies: Bodies,
    robots: Vec<Robot>,
    obstacles: Vec<Obstacle>,
    /// The robots that have corners.
    cornered: Vec<usize>,
    /// Whether any robot looks for tags.
    has_finders: bool,
    scene: Scene,
    contacts: Vec<Contact>,
    /// The obstacles that moved in the last step, with where they were.
    moved: Vec<(usize, Rectangle)>,
    parallel_lasers: bool,
    scratch: Scratch,
}

impl Fleet {
    /// The place of `spec` at its start. `seed` starts all chance: the noise of lasers, that of
    /// odometry, and what robots do by themselves, each in a stream of its own.
    pub fn new(spec: &FleetSpec, seed: u64) -> Self {
        let mut bodies = Bodies::new(spec);
        for (index, wall) in spec.walls.iter().enumerate() {
            bodies.add_box(Body::Wall(index), wall);
        }
        let mut lasers = Lasers::default();
        let mut robots = Vec::with_capacity(spec.robots.len());
        for (index, robot) in spec.robots.iter().enumerate() {
            bodies.add_robot(robot, spec.step_s);
            let beams = robot.lasers().map(|laser| lasers.beams(laser)).collect();
            robots.push(Robot::new(robot, index, bodies.pose(index), spec.step_s, seed, beams));
        }
        let obstacles =
            spec.obstacles.iter().enumerate().map(|(i, o)| Obstacle::new(o, i, seed, &mut bodies));
        let obstacles = obstacles.collect();
        // A robot with corners is no disc to be seen, but a hull after those of the obstacles.
        let radius_m = |robot: &Robot| if robot.spec.corners.is_empty() { robot.spec.radius_m } else { 0.0 };
        let discs = robots.iter().map(|robot| Disc { center: robot.at(), radius_m: radius_m(robot) });
        let cornered = spec.robots.iter().enumerate().filter(|(_, robot)| !robot.corners.is_empty());
        let cornered: Vec<usize> = cornered.map(|(index, _)| index).collect();
        let ranges_m = spec.robots.iter().flat_map(RobotSpec::lasers).map(|laser| laser.range_max_m);
        let range_m = ranges_m.fold(0.0, f64::max);
        let hulls = spec.obstacles.len() + cornered.len();
        let scene = Scene::new(corners(&spec.frame), &spec.walls, discs.collect(), hulls, range_m);
        let mut fleet = Self {
            spec: spec.clone(),
            seed,
            step: 0,
            bodies,
            robots,
            obstacles,
            cornered,
            has_finders: spec.robots.iter().any(|robot| robot.fiducial.is_some()),
            scene,
            contacts: Vec::new(),
            moved: Vec::new(),
            parallel_lasers: false,
            scratch: Scratch::default(),
        };
        fleet.show_obstacles();
        (0..fleet.robots.len()).for_each(|index| fleet.show_robot(index));
        fleet
    }

    /// The time since the start, s.
    pub fn time_s(&self) -> f64 {
        self.step as f64 * self.spec.step_s
    }

    /// What the place was made from.
    pub fn spec(&self) -> &FleetSpec {
        &self.spec
    }

    /// All robots, in the order of the file.
    pub fn robots(&self) -> impl ExactSizeIterator<Item = RobotView<'_>> {
        self.robots.iter().map(Robot::view)
    }

    /// The corners of all walls, counter-clockwise, m.
    pub fn walls(&self) -> impl ExactSizeIterator<Item = [Point2<f64>; 4]> {
        self.spec.walls.iter().map(Rectangle::corners)
    }

    /// The obstacles that are there now, where they are now.
    pub fn obstacles(&self) -> impl Iterator<Item = ObstacleView<'_>> {
        let standing = self.obstacles.iter().enumerate().filter(|(_, obstacle)| obstacle.is_standing());
        standing.map(|(index, o)| ObstacleView { index, name: &o.spec.name, corners: o.shape.corners() })
    }

    /// The contacts that began in the last [`Fleet::step`] or since the last [`Fleet::run_until`] began, step by
    /// step and robot by robot. No snapshot has them.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Whether lasers look around on all threads of rayon's pool, or on this one alone, as at
    /// first. The result is the same; a step must take some 0.1 ms for it to be worth it.
    pub fn set_parallel_lasers(&mut self, parallel: bool) {
        self.parallel_lasers = parallel;
    }

    /// Tells a robot (by its place in the world file) what to do, until it is told otherwise: at any step,
    /// and not only when it has a new scan. Returns whether it obeys; one that is not driven does not.
    pub fn command(&mut self, robot: usize, wanted: impl Into<Command>) -> bool {
        let driven = self.robots.get_mut(robot).filter(|robot| robot.is_driven());
        driven.map(|robot| robot.command(&wanted.into())).is_some()
    }

    /// The contacts since they were last taken.
    pub(super) fn take_contacts(&mut self) -> Vec<Contact> {
        std::mem::take(&mut self.contacts)
    }

    /// One robot.
    pub(super) fn robot(&self, robot: usize) -> &Robot {
        &self.robots[robot]
    }

    /// What a robot sees now.
    pub(super) fn look(&mut self, robot: usize) -> &LaserReading {
        self.scene.sort();
        let (step, time_s, tagged) = (self.step, self.time_s(), self.tagged());
        let now = Now { step, time_s, scene: &self.scene, tagged: &tagged };
        self.robots[robot].look(&now, &mut self.scratch)
    }

    /// Everything with a tag that is there, robots first; nothing if no robot looks for it.
    pub(in crate::physics) fn tagged(&self) -> Vec<Tagged> {
        if !self.has_finders {
            return Vec::new();
        }
        let robots = self.robots.iter().enumerate().filter_map(|(index, robot)| {
            let tag = robot.spec.tag?;
            Some(Tagged { tag, body: Body::Robot(index), center: robot.at(), form: robot.form() })
        });
        let standing = self.obstacles.iter().enumerate().filter(|(_, obstacle)| obstacle.is_standing());
        let obstacles = standing.filter_map(|(index, obstacle)| {
            let (tag, shape) = (obstacle.spec.tag?, &obstacle.shape);
            let (center, form) =
                (shape.pose.translation.vector.into(), Form::Convex(shape.corners().to_vec()));
            Some(Tagged { tag, body: Body::Obstacle(index), center, form })
        });
        robots.chain(obstacles).collect()
    }

    /// Walls, and the obstacles that stand now.
    pub(super) fn standing_boxes(&self) -> Vec<Rectangle> {
        let standing = self.obstacles.iter().filter(|obstacle| obstacle.is_standing());
        self.spec.walls.iter().copied().chain(standing.map(|obstacle| obstacle.shape)).collect()
    }

    /// Whether an obstacle stands now.
    pub(super) fn is_standing(&self, obstacle: usize) -> bool {
        self.obstacles[obstacle].is_standing()
    }

    /// The obstacles that moved in the last step, each with where it was and is.
    pub(super) fn moved(&self) -> impl ExactSizeIterator<Item = (usize, Rectangle, Rectangle)> {
        self.moved.iter().map(|(index, before)| (*index, *before, self.obstacles[*index].shape))
    }

    /// What lasers see, and the bodies.
    #[cfg(test)]
    pub(super) fn into_parts(self) -> (Scene, Bodies) {
        (self.scene, self.bodies)
    }

    /// The energy of motion of everything that is pushed or drives, J.
    #[cfg(test)]
    pub(super) fn kinetic_j(&self) -> f64 {
        self.bodies.kinetic_j()
    }

    /// Shows the lasers what stands now.
    fn show_obstacles(&mut self) {
        (0..self.obstacles.len()).for_each(|index| self.show_obstacle(index));
    }

    /// Shows the lasers where a robot is.
    fn show_robot(&mut self, index: usize) {
        let robot = &self.robots[index];
        self.scene.move_disc(index, robot.at());
        if !robot.spec.corners.is_empty()
            && let Form::Convex(corners) = robot.form()
            && let Ok(place) = self.cornered.binary_search(&index)
        {
            self.scene.set_hull(self.obstacles.len() + place, Some(index), &corners);
        }
    }

    /// Shows the lasers what has become of an obstacle.
    fn show_obstacle(&mut self, index: usize) {
        let obstacle = &self.obstacles[index];
        let corners = obstacle.shape.corners();
        self.scene.set_hull(index, None, if obstacle.is_standing() { &corners } else { &[] });
    }
}

/// The beams of all lasers, each kind once.
#[derive(Default)]
struct Lasers {
    known: Vec<(LaserSpec, Arc<Beams>)>,
}

impl Lasers {
    fn beams(&mut self, spec: &LaserSpec) -> Arc<Beams> {
        if let Some((_, beams)) = self.known.iter().find(|(known, _)| known == spec) {
            return Arc::clone(beams);
        }
        let beams = Arc::new(beams(spec));
        self.known.push((*spec, Arc::clone(&beams)));
        beams
    }
}

/// The lower left and the upper right corner of a grid, m.
pub(super) fn corners(frame: &GridFrame) -> (Point2<f64>, Point2<f64>) {
    let size = Vector2::new(frame.width() as f64, frame.height() as f64) * frame.resolution_m();
    (frame.origin(), frame.origin() + size)
}
