//! The second reading of a log: reading by reading.

use super::line::{self, Line};
use super::{Lines, Rules};
use crate::assemble::{Assembler, Waiting};
use crate::log::RawReadings;
use crate::summary::LogError;
use interfaces::{LaserReading, Twist};
use nalgebra::Isometry2;

/// Scans that wait for a later pose; more are not kept.
const MAX_WAITING: usize = 64;

/// The readings of a log, one after the other.
pub(super) struct Readings {
    lines: Lines,
    rules: Rules,
    /// With each scan the pose of the laser in its line.
    assembler: Assembler<Option<Isometry2<f64>>>,
    /// The pose in the last line, if it is a scan.
    scan_pose: Option<Isometry2<f64>>,
    is_over: bool,
}

impl Readings {
    pub(super) fn new(lines: Lines, rules: Rules) -> Self {
        Self { lines, rules, assembler: Assembler::default(), scan_pose: None, is_over: false }
    }

    /// The first waiting scan as a reading, if its pose is known, or if it does not wait any longer.
    fn resolved(&mut self) -> Option<LaserReading> {
        let Self { rules: Rules { has_times, takes_scan_poses, .. }, assembler, .. } = self;
        let now_s = assembler.waiting.back()?.time_s;
        let is_due = self.is_over || assembler.waiting.len() > MAX_WAITING || !*has_times;
        if !is_due && assembler.must_wait(now_s) {
            return None;
        }
        let (mut reading, laser) = assembler.next_reading()?;
        if *has_times {
            assembler.odometry.holes.add_scan(reading.time_s);
        } else {
            reading = LaserReading { pose: assembler.odometry.newest().0, twist: Twist::STOP, ..reading };
        }
        if let Some(laser) = laser.filter(|_| *takes_scan_poses) {
            reading.pose = laser * reading.mount.inverse();
        }
        Some(reading)
    }
}

impl RawReadings for Readings {
    fn next_reading(&mut self) -> Result<Option<LaserReading>, LogError> {
        loop {
            let reading = self.resolved();
            if reading.is_some() || self.is_over {
                return Ok(reading);
            }
            let scan_pose = self.scan_pose.take();
            let Rules { geometry, .. } = &self.rules;
            match line::next(&mut self.lines, geometry)? {
                None => self.is_over = true,
                Some(Line::Scan(line)) => {
                    self.scan_pose = line.reference;
                    let mount = geometry.robotlaser_mount.filter(|_| !line.is_flaser);
                    let mount = mount.unwrap_or_else(|| geometry.mount());
                    let (time_s, tag, scan) = (line.time_s, line.reference, line.scan);
                    self.assembler.waiting.push_back(Waiting { time_s, mount, scan, tag });
                }
                Some(Line::Odometry { .. }) if self.rules.stands => {}
                Some(Line::Odometry { time_s, pose, .. }) => {
                    let repeats_scan = self.rules.is_corrected && scan_pose == Some(pose);
                    if repeats_scan || time_s == 0.0 && self.rules.has_origins {
                        self.assembler.odometry.set_origin(pose);
                    } else {
                        self.assembler.odometry.add(time_s, pose);
                    }
                }
                Some(_) => {}
            }
        }
    }
}
