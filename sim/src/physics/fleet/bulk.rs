//! Fresh measurements, and the scans and poses of all robots in memory of the caller.

use super::Fleet;
use crate::physics::robot::{RobotView, SimulatedRobot};
use interfaces::heading_rad;

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
