//! Scans, poses and transforms that come one after the other become readings: of logs, and of live robots.

mod frames;
mod odometry;

pub use frames::{Chain, Frames};
pub(crate) use frames::{can_be_base, is_base, is_odom, is_world};
pub use odometry::Odometry;

use interfaces::{LaserReading, Scan};
use nalgebra::{Isometry2, Isometry3};
use ros::{LaserScan, flat, mounted, scan_of};
use std::collections::VecDeque;

/// A scan that waits for its pose.
#[derive(Debug)]
pub struct Waiting<T> {
    /// The time of its last beam, s.
    pub time_s: f64,
    /// The pose of the laser on the robot.
    pub mount: Isometry2<f64>,
    /// The scan.
    pub scan: Scan,
    /// What else its source knows of it.
    pub tag: T,
}

/// The transforms and the poses of a robot so far, and the scans that wait for a later pose.
#[derive(Debug)]
pub struct Assembler<T> {
    /// The transforms.
    pub frames: Frames,
    /// The poses.
    pub odometry: Odometry,
    /// The scans, in the order in which they become readings.
    pub waiting: VecDeque<Waiting<T>>,
}

impl<T> Default for Assembler<T> {
    fn default() -> Self {
        Self { frames: Frames::default(), odometry: Odometry::default(), waiting: VecDeque::new() }
    }
}

impl<T> Assembler<T> {
    /// The scan of a message, and the pose of its laser on the robot: `chain` leads from the robot to the laser.
    ///
    /// # Errors
    ///
    /// When the laser is tilted, or when the message is no scan.
    pub fn placed(&self, chain: &Chain, message: LaserScan) -> Result<(Isometry2<f64>, Scan), String> {
        let place = mounted(&self.frames.along(chain)).map_err(|why| format!("its laser {why}"));
        let (mount, is_upside_down) = place?;
        Ok((mount, scan_of(message, is_upside_down)?))
    }

    /// Adds a pose by odometry of a frame from which `chain` leads to the robot. As [`Odometry::add`].
    pub fn add_pose(&mut self, time_s: f64, pose: &Isometry3<f64>, chain: &Chain) -> Option<Isometry2<f64>> {
        self.odometry.add(time_s, flat(&(pose * self.frames.along(chain))))
    }

    /// Whether a later pose can be nearer to the time of the first scan, where all is known until `now_s`.
    pub fn must_wait(&self, now_s: f64) -> bool {
        self.waiting.front().is_some_and(|first| self.odometry.must_wait(first.time_s, now_s))
    }

    /// The first scan with the pose that is known for it now.
    pub fn next_reading(&mut self) -> Option<(LaserReading, T)> {
        let Waiting { time_s, mount, scan, tag } = self.waiting.pop_front()?;
        Some((self.odometry.reading(time_s, mount, scan), tag))
    }
}
