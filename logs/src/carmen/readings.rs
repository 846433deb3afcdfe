//! The second reading of a log: reading by reading.

use super::Rules;
use super::line::{self, Line, Poses, ScanLine};
use crate::error::LogError;
use crate::lines::Lines;
use crate::odometry::Odometry;
use crate::raw_readings::RawReadings;
use interfaces::{LaserReading, Twist};
use nalgebra::Isometry2;
use std::collections::VecDeque;

/// Scans that wait for a later pose; more are not kept.
const MAX_WAITING: usize = 64;

/// The readings of a log, one after the other.
pub(super) struct Readings {
    lines: Lines,
    rules: Rules,
    odometry: Odometry,
    /// Scans whose pose may be between the last pose and the next.
    waiting: VecDeque<ScanLine>,
    /// The pose in the last line, if it is a scan.
    scan_pose: Option<Isometry2<f64>>,
    is_over: bool,
}

impl Readings {
    pub(super) fn new(lines: Lines, rules: Rules) -> Self {
        let (odometry, waiting) = (Odometry::default(), VecDeque::new());
        Self { lines, rules, odometry, waiting, scan_pose: None, is_over: false }
    }

    /// The first waiting scan as a reading, if its pose is known. With `now`, it does not wait any longer.
    fn resolved(&mut self, now: bool) -> Option<LaserReading> {
        let (time_s, Rules { has_times, geometry, .. }) = (self.waiting.front()?.time_s, self.rules);
        let now_s = self.waiting.back()?.time_s;
        if has_times && !now && self.odometry.must_wait(time_s, now_s) {
            return None;
        }
        let line = self.waiting.pop_front()?;
        let mount = match line.poses {
            Poses::Laser(_) => geometry.mount(),
            Poses::Mount(_) => geometry.robotlaser_mount.unwrap_or(geometry.mount()),
        };
        if has_times {
            self.odometry.note_scan(time_s);
        }
        let reference = line.reference();
        let mut reading = self.odometry.reading(time_s, mount, line.scan);
        if !has_times {
            reading = LaserReading { pose: self.odometry.newest().0, twist: Twist::STOP, ..reading };
        }
        if let Some(laser) = reference.filter(|_| self.rules.takes_scan_poses) {
            reading.pose = laser * mount.inverse();
        }
        Some(reading)
    }
}

impl RawReadings for Readings {
    fn next_reading(&mut self) -> Result<Option<LaserReading>, LogError> {
        loop {
            if let Some(reading) = self.resolved(self.is_over || self.waiting.len() > MAX_WAITING) {
                return Ok(Some(reading));
            }
            if self.is_over {
                return Ok(None);
            }
            let scan_pose = self.scan_pose.take();
            match line::next(&mut self.lines, &self.rules.geometry)? {
                None => self.is_over = true,
                Some(Line::Scan(scan)) => {
                    self.scan_pose = scan.reference();
                    self.waiting.push_back(scan);
                }
                Some(Line::Odometry { .. }) if self.rules.stands => {}
                Some(Line::Odometry { time_s, pose, .. }) => {
                    let repeats_scan = self.rules.is_corrected && scan_pose == Some(pose);
                    if repeats_scan || time_s == 0.0 && self.rules.has_origins {
                        self.odometry.set_origin(pose);
                    } else {
                        self.odometry.add(time_s, pose);
                    }
                }
                Some(_) => {}
            }
        }
    }
}
