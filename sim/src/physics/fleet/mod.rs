//! Any number of robots in one world.

mod slide;
mod start;
mod teleport;
mod time;

pub use teleport::TeleportError;
pub use time::Controller;

use super::bodies::Bodies;
use super::drives::Velocity;
use super::obstacles::Obstacle;
use super::past::Past;
use super::rays::Scene;
use super::report::{Contact, ObstacleView};
use super::robot::{RobotView, SimulatedRobot};
use super::shape::Rectangle;
use super::snapshot::{self, SnapshotError, value};
use super::spec::FleetSpec;
use interfaces::{Values, heading_rad, values};
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
    pub(super) bodies: Bodies,
    pub(super) robots: Vec<SimulatedRobot>,
    pub(super) obstacles: Vec<Obstacle>,
    pub(super) scene: Scene,
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

    /// The walls, and the obstacles that are present now.
    pub(super) fn standing_boxes(&self) -> Vec<Rectangle> {
        let standing = self.obstacles.iter().filter(|obstacle| obstacle.is_standing());
        self.spec().walls.iter().copied().chain(standing.map(|obstacle| obstacle.shape)).collect()
    }

    /// The obstacles that moved in the last step, each with the shapes before and after the step.
    pub(super) fn moved(&self) -> impl ExactSizeIterator<Item = (usize, Rectangle, Rectangle)> {
        self.moved.iter().map(|(index, before)| (*index, *before, self.obstacles[*index].shape))
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

// Fresh measurements, and the scans and poses of all robots in memory of the caller.

/// The error for a slice of another length than that of the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the slice for the {what} has {found} values, and must have {expected}")]
pub struct LengthError {
    /// What the slice is for.
    pub what: &'static str,
    /// The length of the slice.
    pub found: usize,
    /// The right length.
    pub expected: usize,
}

fn check(what: &'static str, found: usize, expected: usize) -> Result<(), LengthError> {
    if found == expected { Ok(()) } else { Err(LengthError { what, found, expected }) }
}

impl Fleet {
    /// Measures with the main laser of a robot (by index) now, whether or not a scan is due, so that scan and pose are
    /// of the same instant: after a step, the latest scan is from before the step. `None` if there is no such robot.
    ///
    /// A second look at the same time returns the same reading. A scan that is due at this time is this reading. A look
    /// at another time is one more measurement: it draws noise, so that later readings of this laser have other noise.
    pub fn look(&mut self, robot: usize) -> Option<RobotView<'_>> {
        let sweeps = self.robots.get(robot)?.sweeps();
        let surroundings = self.surroundings(sweeps);
        self.robots[robot].look(&surroundings);
        self.robot(robot)
    }

    /// Measures with the main lasers of all robots now, as [`Fleet::look`] does with one. With
    /// [parallel lasers](Fleet::set_parallel_lasers) on all threads.
    pub fn look_all(&mut self) {
        let surroundings = &self.surroundings(self.robots.iter().any(SimulatedRobot::sweeps));
        self.for_robots(|_| true, |robot| robot.look(surroundings));
    }

    /// The number of beams of the main lasers of all robots together: the length of the slice of [`Fleet::copy_scans`].
    pub fn beams(&self) -> usize {
        self.spec().robots.iter().map(|robot| robot.laser.beams).sum()
    }

    /// Copies the latest scan of the main laser of every robot, one robot after the other in the order of the spec, m.
    /// A robot that has not measured yet has NaN.
    ///
    /// # Errors
    ///
    /// When the length of the slice is not [`Fleet::beams`]. Nothing is copied then.
    pub fn copy_scans(&self, ranges_m: &mut [f32]) -> Result<(), LengthError> {
        check("scans of all robots", ranges_m.len(), self.beams())?;
        let mut rest = ranges_m;
        for robot in &self.robots {
            let (scan, others) = rest.split_at_mut(robot.spec.laser.beams);
            match robot.reading() {
                Some(reading) => scan.copy_from_slice(&reading.scan.ranges_m),
                None => scan.fill(f32::NAN),
            }
            rest = others;
        }
        Ok(())
    }

    /// Copies the true pose of every robot in the order of the spec: x (m), y (m), heading (rad, in (−π, π]).
    ///
    /// # Errors
    ///
    /// When the length of the slice is not the number of robots. Nothing is copied then.
    pub fn copy_poses(&self, poses: &mut [[f64; 3]]) -> Result<(), LengthError> {
        check("poses of all robots", poses.len(), self.robots.len())?;
        for (robot, pose) in self.robots.iter().zip(poses) {
            *pose = [robot.pose.translation.x, robot.pose.translation.y, heading_rad(&robot.pose)];
        }
        Ok(())
    }
}

// The state of a fleet: reset to the start, to bytes, and from bytes.

impl Fleet {
    /// Resets the fleet to the start, with the same seed or another one: the result is that of [`Fleet::new`] with the
    /// same spec, bit for bit. The place is kept, so that a reset takes little more time than a clone.
    pub fn reset(&mut self, seed: u64) {
        let parallel_lasers = self.parallel_lasers;
        *self = Self { parallel_lasers, ..Self::begin(Arc::clone(&self.start), seed) };
    }

    /// The state as bytes. A fleet that [`Fleet::restored`] makes from the bytes continues bit for bit like
    /// this one.
    pub fn snapshot(&self) -> Vec<u8> {
        let mut fleet = self.clone();
        let mut seed = fleet.seed;
        let mut values = vec![value(&mut seed)];
        values.extend(fleet.values());
        snapshot::write(fingerprint(self.spec()), values)
    }

    /// The fleet of `spec` in the state of a snapshot.
    ///
    /// # Errors
    ///
    /// When the bytes are not a snapshot, are damaged, or were taken of a fleet with another spec.
    pub fn restored(spec: &FleetSpec, snapshot: &[u8]) -> Result<Self, SnapshotError> {
        let bytes = snapshot::check(snapshot, fingerprint(spec))?;
        Self::at_snapshot(Arc::new(Start::new(spec)), bytes)
    }

    /// Returns to the state of a snapshot of a fleet with the same spec. The place is kept, as in [`Fleet::reset`].
    ///
    /// # Errors
    ///
    /// The errors of [`Fleet::restored`]. The state is then unchanged.
    pub fn restore(&mut self, snapshot: &[u8]) -> Result<(), SnapshotError> {
        let bytes = snapshot::check(snapshot, fingerprint(self.spec()))?;
        let parallel_lasers = self.parallel_lasers;
        *self = Self { parallel_lasers, ..Self::at_snapshot(Arc::clone(&self.start), bytes)? };
        Ok(())
    }

    fn at_snapshot(start: Arc<Start>, mut bytes: &[u8]) -> Result<Self, SnapshotError> {
        let mut seed = 0_u64;
        snapshot::read(&mut bytes, vec![value(&mut seed)])?;
        let mut fleet = Self::begin(start, seed);
        snapshot::read(&mut bytes, fleet.values())?;
        if !bytes.is_empty() {
            return Err(SnapshotError::Damaged);
        }
        (0..fleet.robots.len()).for_each(|index| fleet.show_robot(index));
        (0..fleet.obstacles.len()).for_each(|index| fleet.show_obstacle(index));
        Ok(fleet)
    }

    fn values(&mut self) -> Values<'_> {
        let mut values = values![self.step; self.bodies, self.past];
        values.extend(self.robots.iter_mut().flat_map(|robot| robot.values()));
        values.extend(self.obstacles.iter_mut().flat_map(|obstacle| obstacle.values()));
        values
    }
}

/// A number that differs between specs.
fn fingerprint(spec: &FleetSpec) -> u64 {
    snapshot::fingerprint(format!("{spec:?}").as_bytes())
}
