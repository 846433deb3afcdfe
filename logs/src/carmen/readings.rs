//! The second reading of a log: reading by reading.

use super::line::{self, Line, ScanLine};
use super::survey::Survey;
use crate::error::LogError;
use crate::lines::Lines;
use crate::odometry::Odometry;
use interfaces::{LaserReading, Twist};
use nalgebra::Isometry2;
use std::collections::VecDeque;

/// Scans that wait for a later pose; more are not kept.
const MOST_WAITING: usize = 64;

/// The readings of a log, one after the other. After an error, there are no more.
pub(crate) struct Readings {
    lines: Lines,
    survey: Survey,
    odometry: Odometry,
    /// Scans whose pose may be between the last pose and the next.
    waiting: VecDeque<ScanLine>,
    /// The number of readings that were given out.
    given: usize,
    is_over: bool,
}

impl Readings {
    pub(super) fn new(lines: Lines, survey: Survey) -> Self {
        let (odometry, waiting) = (Odometry::default(), VecDeque::new());
        Self { lines, survey, odometry, waiting, given: 0, is_over: false }
    }

    /// The first waiting scan as a reading, if its pose is known. With `now`, it does not wait any longer.
    fn resolved(&mut self, now: bool) -> Option<LaserReading> {
        let time_s = self.waiting.front()?.time_s;
        if self.survey.has_times && !now && self.odometry.must_wait(time_s) {
            return None;
        }
        let line = self.waiting.pop_front()?;
        let (pose, twist) =
            if self.survey.has_times { self.odometry.at(time_s) } else { self.odometry.newest() };
        self.reading(line, pose, if self.survey.has_times { twist } else { Twist::STOP })
    }

    fn reading(&mut self, line: ScanLine, pose: Isometry2<f64>, twist: Twist) -> Option<LaserReading> {
        // The file can have grown since the survey.
        let time_s = *self.survey.times_s.get(self.given)?;
        self.given += 1;
        let mount = interfaces::pose(self.survey.geometry.offset_m, 0.0, 0.0);
        Some(LaserReading { time_s, pose, twist, velocities: Vec::new(), mount, scan: line.scan })
    }

    fn advance(&mut self) -> Result<Option<LaserReading>, LogError> {
        loop {
            if let Some(reading) = self.resolved(self.is_over || self.waiting.len() > MOST_WAITING) {
                return Ok(Some(reading));
            }
            if self.is_over {
                return Ok(None);
            }
            match line::next(&mut self.lines, &self.survey.geometry)? {
                None => self.is_over = true,
                Some(Line::Scan(scan)) => self.waiting.push_back(scan),
                Some(Line::Odometry { .. }) if self.survey.summary.stands => {}
                Some(Line::Odometry { time_s, pose }) if time_s == 0.0 && self.survey.has_origins => {
                    self.odometry.set_origin(pose);
                }
                Some(Line::Odometry { time_s, pose }) => self.odometry.add(time_s, pose),
                Some(_) => {}
            }
        }
    }
}

impl Iterator for Readings {
    type Item = Result<LaserReading, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = self.advance();
        if next.is_err() {
            self.is_over = true;
            self.waiting.clear();
        }
        next.transpose()
    }
}
