//! Any number of robots in one world.

mod bulk;
mod carry;
mod rest;
mod rooms;
mod slide;
mod snapshots;
mod start;
mod teleport;
mod time;

pub use bulk::LengthError;
pub use teleport::TeleportError;
pub use time::Controller;

use super::bodies::Bodies;
use super::form::Form;
use super::obstacles::Obstacle;
use super::past::Past;
use super::rays::Scene;
use super::report::{Body, Contact, ObstacleView};
use super::robot::{RobotView, SimulatedRobot};
use super::sensors::Tagged;
use super::shape::Rectangle;
use super::spec::FleetSpec;
use super::velocity::Velocity;
use slide::Sliding;
use start::Start;
use std::sync::Arc;

/// A world with any number of robots.
///
/// The same spec, seed and commands give the same bits, on every machine and any number of threads. A clone is
/// independent, and behaves in the same way under the same commands.
#[derive(Clone)]
pub struct Fleet {
    start: Arc<Start>,
    seed: u64,
    /// Steps since the start. Time is a multiple of the step, so that it never drifts.
    step: u64,
    bodies: Bodies,
    pub(super) robots: Vec<SimulatedRobot>,
    pub(super) obstacles: Vec<Obstacle>,
    scene: Scene,
    past: Past,
    pub(super) contacts: Vec<Contact>,
    /// The obstacles that moved in the last step, with the shape before the step.
    moved: Vec<(usize, Rectangle)>,
    /// Scratch memory: the shapes of all obstacles before a step.
    before: Vec<Rectangle>,
    sliding: Sliding,
    parallel_lasers: bool,
}

impl Fleet {
    /// The world of `spec` at its start. All random streams are seeded by `seed`: sensor noise, odometry noise, and
    /// the decisions of robots and doors, each with a separate stream.
    ///
    /// Most of the time is for the place, which is the same for every seed. For another seed in the same place,
    /// [`Fleet::reset`] a fleet, or a clone: this takes a small part of the time.
    pub fn new(spec: &FleetSpec, seed: u64) -> Self {
        Self::begin(Arc::new(Start::new(spec)), seed)
    }

    /// The time since the start, s.
    pub fn time_s(&self) -> f64 {
        self.step as f64 * self.spec().step_s
    }

    /// The spec of the world.
    pub fn spec(&self) -> &FleetSpec {
        &self.start.spec
    }

    /// All robots, in the order of the spec.
    pub fn robots(&self) -> impl ExactSizeIterator<Item = RobotView<'_>> {
        self.robots.iter().map(SimulatedRobot::view)
    }

    /// One robot (by index); `None` if there is no such robot.
    pub fn robot(&self, robot: usize) -> Option<RobotView<'_>> {
        self.robots.get(robot).map(SimulatedRobot::view)
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
    pub fn command(&mut self, robot: usize, wanted: impl Into<Velocity>) -> bool {
        let driven = self.robots.get_mut(robot).filter(|robot| robot.is_driven());
        driven.map(|robot| robot.command(&wanted.into())).is_some()
    }

    /// All present bodies with a tag, robots first; none if no robot has a fiducial finder.
    pub(crate) fn tagged(&self) -> Vec<Tagged> {
        if self.spec().robots.iter().all(|robot| robot.fiducial.is_none()) {
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
        self.spec().walls.iter().copied().chain(standing.map(|obstacle| obstacle.shape)).collect()
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

    /// Updates a robot in the scene that lasers see.
    fn show_robot(&mut self, index: usize) {
        self.start.show_robot(&mut self.scene, index, &self.robots[index].pose);
    }

    /// Updates an obstacle in the scene that lasers see.
    fn show_obstacle(&mut self, index: usize) {
        start::show_obstacle(&mut self.scene, index, &self.obstacles[index]);
    }
}
