//! Any number of robots in one world.

mod carry;
mod controller;
mod snapshots;
mod teleport;
mod time;

pub use controller::Controller;
pub use teleport::TeleportError;

use super::bodies::Bodies;
use super::command::Command;
use super::form::Form;
use super::obstacles::Obstacle;
use super::past::Past;
use super::rays::{Disc, Scene};
use super::report::{Body, Contact, ObstacleView};
use super::robot::{Robot, RobotView};
use super::sensors::{SharedBeams, Tagged};
use super::shape::Rectangle;
use super::spec::{FleetSpec, RobotSpec};
use carry::Carrying;
use interfaces::GridFrame;
use nalgebra::{Point2, Vector2};
use std::sync::Arc;

/// A world with any number of robots.
///
/// The same spec, seed and commands give the same bits, on every machine and any number of threads. A clone is
/// independent, and behaves in the same way under the same commands.
#[derive(Clone)]
pub struct Fleet {
    spec: FleetSpec,
    seed: u64,
    /// Steps since the start. Time is a multiple of the step, so that it never drifts.
    step: u64,
    bodies: Bodies,
    robots: Vec<Robot>,
    obstacles: Vec<Obstacle>,
    /// The robots that have corners.
    cornered: Vec<usize>,
    /// Whether any robot has a fiducial finder.
    has_fiducial_finders: bool,
    scene: Scene,
    past: Past,
    carrying: Arc<Carrying>,
    contacts: Vec<Contact>,
    /// The obstacles that moved in the last step, with the shape before the step.
    moved: Vec<(usize, Rectangle)>,
    parallel_lasers: bool,
}

impl Fleet {
    /// The world of `spec` at its start. All random streams are seeded by `seed`: sensor noise, odometry noise, and
    /// the decisions of robots and doors, each with a separate stream.
    pub fn new(spec: &FleetSpec, seed: u64) -> Self {
        let mut bodies = Bodies::new(spec);
        for (index, wall) in spec.walls.iter().enumerate() {
            bodies.add_box(Body::Wall(index), wall);
        }
        let mut beams = SharedBeams::default();
        let mut robots = Vec::with_capacity(spec.robots.len());
        for (index, robot) in spec.robots.iter().enumerate() {
            bodies.add_robot(robot, spec.step_s);
            robots.push(Robot::new(robot, index, bodies.pose(index), spec.step_s, seed, &mut beams));
        }
        let obstacles =
            spec.obstacles.iter().enumerate().map(|(i, o)| Obstacle::new(o, i, seed, &mut bodies));
        let obstacles = obstacles.collect();
        // A robot with corners is a disc of radius 0, and a polygon after those of the obstacles.
        let radius_m = |robot: &Robot| if robot.spec.corners.is_empty() { robot.spec.radius_m } else { 0.0 };
        let discs = robots.iter().map(|robot| Disc { center: robot.at(), radius_m: radius_m(robot) });
        let cornered = spec.robots.iter().enumerate().filter(|(_, robot)| !robot.corners.is_empty());
        let cornered: Vec<usize> = cornered.map(|(index, _)| index).collect();
        let range_m = spec.robots.iter().map(RobotSpec::range_m).fold(0.0, f64::max);
        let polygons = spec.obstacles.len() + cornered.len();
        let scene = Scene::new(corners(&spec.frame), &spec.walls, discs.collect(), polygons, range_m);
        let mut fleet = Self {
            spec: spec.clone(),
            seed,
            step: 0,
            bodies,
            robots,
            obstacles,
            cornered,
            has_fiducial_finders: spec.robots.iter().any(|robot| robot.fiducial.is_some()),
            scene,
            past: Past::new(spec),
            carrying: Arc::new(Carrying::new(spec)),
            contacts: Vec::new(),
            moved: Vec::new(),
            parallel_lasers: false,
        };
        fleet.show_obstacles();
        (0..fleet.robots.len()).for_each(|index| fleet.show_robot(index));
        fleet
    }

    /// The time since the start, s.
    pub fn time_s(&self) -> f64 {
        self.step as f64 * self.spec.step_s
    }

    /// The spec of the world.
    pub fn spec(&self) -> &FleetSpec {
        &self.spec
    }

    /// All robots, in the order of the spec.
    pub fn robots(&self) -> impl ExactSizeIterator<Item = RobotView<'_>> {
        self.robots.iter().map(Robot::view)
    }

    /// The corners of all walls, counter-clockwise, m.
    pub fn walls(&self) -> impl ExactSizeIterator<Item = [Point2<f64>; 4]> {
        self.spec.walls.iter().map(Rectangle::corners)
    }

    /// The obstacles that are present now, at their present poses.
    pub fn obstacles(&self) -> impl Iterator<Item = ObstacleView<'_>> {
        let standing = self.obstacles.iter().enumerate().filter(|(_, obstacle)| obstacle.is_standing());
        standing.map(|(index, o)| ObstacleView { index, name: &o.spec.name, corners: o.shape.corners() })
    }

    /// The contacts that began in the last [`Fleet::step`] or [`Fleet::run_until`], by step and robot. Snapshots do
    /// not contain them.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Whether lasers measure on all threads of rayon's thread pool, or only on this thread (the default). The
    /// result is the same. Threads save time if a step takes at least about 0.1 ms.
    pub fn set_parallel_lasers(&mut self, parallel: bool) {
        self.parallel_lasers = parallel;
    }

    /// Sets the command of a robot (by index), at any step and not only at a new scan. Returns whether the robot
    /// executes commands: a robot that is not driven does not.
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

    /// Measures with the sensors of a robot now: with its main laser scanner, and with all other sensors that are
    /// due.
    pub(super) fn look(&mut self, robot: usize) -> &Robot {
        let surroundings = self.surroundings(self.robots[robot].sweeps());
        self.robots[robot].look(&surroundings);
        &self.robots[robot]
    }

    /// All present bodies with a tag, robots first; none if no robot has a fiducial finder.
    pub(in crate::physics) fn tagged(&self) -> Vec<Tagged> {
        if !self.has_fiducial_finders {
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

    /// The walls, and the obstacles that are present now.
    pub(super) fn standing_boxes(&self) -> Vec<Rectangle> {
        let standing = self.obstacles.iter().filter(|obstacle| obstacle.is_standing());
        self.spec.walls.iter().copied().chain(standing.map(|obstacle| obstacle.shape)).collect()
    }

    /// Whether an obstacle is present now.
    pub(super) fn is_standing(&self, obstacle: usize) -> bool {
        self.obstacles[obstacle].is_standing()
    }

    /// The obstacles that moved in the last step, each with the shapes before and after the step.
    pub(super) fn moved(&self) -> impl ExactSizeIterator<Item = (usize, Rectangle, Rectangle)> {
        self.moved.iter().map(|(index, before)| (*index, *before, self.obstacles[*index].shape))
    }

    /// The scene that lasers see, and the bodies.
    #[cfg(test)]
    pub(super) fn into_parts(self) -> (Scene, Bodies) {
        (self.scene, self.bodies)
    }

    /// The kinetic energy of all dynamic bodies, J.
    #[cfg(test)]
    pub(super) fn kinetic_j(&self) -> f64 {
        self.bodies.kinetic_j()
    }

    /// Updates all obstacles in the scene that lasers see.
    fn show_obstacles(&mut self) {
        (0..self.obstacles.len()).for_each(|index| self.show_obstacle(index));
    }

    /// Updates a robot in the scene that lasers see.
    fn show_robot(&mut self, index: usize) {
        let robot = &self.robots[index];
        self.scene.move_disc(index, robot.at());
        if let Ok(polygon) = self.cornered.binary_search(&index) {
            let corners = robot.spec.corners.iter().map(|corner| robot.pose * corner);
            self.scene.set_polygon(self.obstacles.len() + polygon, Some(index), corners);
        }
    }

    /// Updates an obstacle in the scene that lasers see.
    fn show_obstacle(&mut self, index: usize) {
        let obstacle = &self.obstacles[index];
        let corners = obstacle.shape.corners();
        let corners: &[Point2<f64>] = if obstacle.is_standing() { &corners } else { &[] };
        self.scene.set_polygon(index, None, corners.iter().copied());
    }
}

/// The lower left and the upper right corner of a grid, m.
pub(super) fn corners(frame: &GridFrame) -> (Point2<f64>, Point2<f64>) {
    let size = Vector2::new(frame.width() as f64, frame.height() as f64) * frame.resolution_m();
    (frame.origin(), frame.origin() + size)
}
