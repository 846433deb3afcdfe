//! The second pass: a robot reads a log, at the poses that the first pass has found.

use interfaces::LaserReading;
use localizer::{GivenPoses, PoseEstimate, PoseState, TrajectoryPose};
use logs::{Log, LogError, Readings};
use mapper::{Mapper, NoReturn, NoReturns, ScanFilterSettings};
use nalgebra::Matrix3;
use robot::{Belief, Localization, Session};
use std::iter::Peekable;

/// The readings of a log, with the times of the survey.
pub struct Replay {
    /// The number of the log in the survey.
    pub(crate) number: usize,
    readings: Peekable<Readings>,
    session: Session,
    last: Option<LaserReading>,
}

impl Replay {
    /// The log from its first reading on, `offset_s` later than its own times.
    ///
    /// # Errors
    ///
    /// When the log cannot be read.
    pub(crate) fn new(number: usize, log: &Log, offset_s: f64) -> Result<Self, LogError> {
        let session = Session { offset_s, ..Session::default() };
        Ok(Self { number, readings: log.readings()?.peekable(), session, last: None })
    }

    /// The last reading, as the log has it.
    pub fn last(&self) -> Option<&LaserReading> {
        self.last.as_ref()
    }

    /// The time of the next reading, s; `None` at the end.
    pub(crate) fn next_s(&mut self) -> Option<f64> {
        let next = self.readings.peek()?.as_ref();
        Some(next.map_or(f64::NAN, |reading| reading.time_s + self.session.offset_s))
    }

    /// Whether there is no other reading.
    pub fn is_over(&mut self) -> bool {
        self.readings.peek().is_none()
    }

    /// The next reading.
    pub(crate) fn next(&mut self) -> Result<Option<LaserReading>, LogError> {
        let Some(mut reading) = self.readings.next().transpose()? else { return Ok(None) };
        self.session.shift(&mut reading);
        self.last = Some(reading.clone());
        Ok(Some(reading))
    }
}

/// Gives every reading the pose that the first pass has found for it.
#[derive(Debug)]
pub struct FoundPoses {
    poses: std::vec::IntoIter<TrajectoryPose>,
    given: GivenPoses,
}

impl FoundPoses {
    /// The poses of the readings, in their order.
    pub fn new(poses: Vec<TrajectoryPose>) -> Self {
        Self { poses: poses.into_iter(), given: GivenPoses::default() }
    }

    /// Gives a reading its pose, without a map.
    pub(crate) fn posed(&mut self, mut reading: LaserReading) -> (LaserReading, PoseState) {
        let state = self.poses.next().map_or_else(Default::default, |found| {
            reading.pose = found.pose;
            found.state
        });
        (self.given.deskewed(reading), state)
    }
}

impl Localization<LaserReading> for FoundPoses {
    /// A reading beyond the last pose keeps its own pose and is not certain. The covariance is not estimated: 0.
    fn localize(&mut self, reading: LaserReading, _: &mut Mapper) -> (LaserReading, Belief) {
        let (reading, state) = self.posed(reading);
        let (pose, covariance, support) = (reading.pose, Matrix3::zeros(), 1.0);
        let estimate = Some(PoseEstimate { pose, covariance, support, state });
        (reading, Belief { estimate, ..Belief::exact(pose) })
    }
}

/// Judges the beams without a return of a log along its trajectory, in one more pass over the log.
pub(crate) fn judged(
    log: &Log,
    poses: &[TrajectoryPose],
    settings: &ScanFilterSettings,
) -> Result<NoReturns, LogError> {
    let mut no_returns = NoReturns::new(settings.no_return);
    if settings.no_return == NoReturn::Learn {
        let mut poses = FoundPoses::new(poses.to_vec());
        for reading in log.readings()? {
            let (reading, state) = poses.posed(reading?);
            if state == PoseState::Tracking {
                no_returns.learn(&reading);
            }
        }
    }
    Ok(no_returns)
}
