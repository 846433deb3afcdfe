//! The second pass as the loop of a robot: a log as a world that ignores commands.

use crate::settings::SurveySettings;
use interfaces::{LaserReading, ValueError, World};
use localizer::{GivenPoses, PoseEstimate, PoseState, TrajectoryPose};
use logs::{Log, LogError};
use mapper::{Mapper, NoReturn, NoReturns};
use nalgebra::Matrix3;
use robot::{Belief, Localization, Permission, Pilot, Posed, Session};

/// A log as a world. It has at least one reading; the last one is repeated at the end, see [`Replay::is_over`].
pub struct Replay<I> {
    readings: I,
    settings: SurveySettings,
    session: Session,
    no_returns: NoReturns,
    now: LaserReading,
    next: Option<LaserReading>,
    problem: Option<LogError>,
}

impl<I: Iterator<Item = Result<LaserReading, LogError>>> Replay<I> {
    /// The log from its first reading on, `offset_s` later than its own times; `None` if there is no reading.
    ///
    /// # Errors
    ///
    /// When the first reading cannot be read.
    pub fn new(mut readings: I, settings: &SurveySettings, offset_s: f64) -> Result<Option<Self>, LogError> {
        let Some(now) = readings.next().transpose()? else { return Ok(None) };
        let session = Session::with_offset(offset_s);
        let mut replay = Self {
            readings,
            settings: settings.clone(),
            session,
            no_returns: NoReturns::new(NoReturn::Free),
            now,
            next: None,
            problem: None,
        };
        replay.read();
        Ok(Some(replay))
    }

    /// Leaves out the beams without a return that are not trusted; before, all are.
    pub(crate) fn judge(&mut self, no_returns: NoReturns) {
        self.no_returns = no_returns;
    }

    /// What was learned about beams without a return.
    pub fn no_returns(&self) -> &NoReturns {
        &self.no_returns
    }

    /// The time of the present reading, s.
    pub fn time_s(&self) -> f64 {
        self.now.time_s + self.session.offset_s()
    }

    /// Whether the present reading is the last one.
    pub fn is_over(&self) -> bool {
        self.next.is_none()
    }

    /// Why the log ended before its end; the next call gives `None`.
    pub fn take_problem(&mut self) -> Option<LogError> {
        self.problem.take()
    }

    fn read(&mut self) {
        match self.readings.next() {
            Some(Ok(reading)) => self.next = Some(reading),
            Some(Err(problem)) => self.problem = Some(problem),
            None => {}
        }
    }
}

impl<I: Iterator<Item = Result<LaserReading, LogError>>> World for Replay<I> {
    type Reading = LaserReading;
    type Command = ();

    fn sense(&mut self) -> LaserReading {
        let mut reading = self.now.clone();
        self.no_returns.apply(&mut reading); // before ranges that are too long become free ones
        self.session.shifted(self.settings.filtered(reading))
    }

    fn poses_are_exact(&self) -> bool {
        true // There is no better pose to compare with.
    }

    fn act(&mut self, (): &()) {
        if let Some(next) = self.next.take() {
            self.now = next;
            self.read();
        }
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
}

impl FoundPoses {
    /// Gives a reading its pose, without a map.
    pub(crate) fn posed(&mut self, mut reading: LaserReading) -> (LaserReading, PoseState) {
        let state = self.poses.next().map_or_else(Default::default, |found| {
            reading.pose = found.pose;
            found.state
        });
        (self.given.deskewed(reading), state)
    }

    /// Passes a reading from which was learned before.
    pub(crate) fn pass(&mut self, reading: LaserReading) {
        self.posed(reading);
    }
}

impl Localization<LaserReading> for FoundPoses {
    /// A reading beyond the last pose keeps its own pose and is not certain. The covariance is not estimated: 0.
    fn localize(&mut self, reading: LaserReading, _: &mut Mapper) -> Posed<LaserReading> {
        let (reading, state) = self.posed(reading);
        let (pose, covariance, support) = (reading.pose, Matrix3::zeros(), 1.0);
        let estimate = Some(PoseEstimate { pose, covariance, support, state });
        Posed { reading, estimate, permission: Permission::Drive, correction: None }
    }

    fn snapshot(&mut self) -> Vec<u8> {
        GivenPoses::snapshot(&mut self.given)
    }

    fn restore(&mut self, snapshot: &[u8]) -> Result<(), ValueError> {
        GivenPoses::restore(&mut self.given, snapshot)
    }

    fn begin_session(&mut self) {
        self.given = GivenPoses::default();
    }
}

/// Judges the beams without a return of a log along its trajectory, in one more pass over the log.
pub(crate) fn judged(
    log: &Log,
    poses: &[TrajectoryPose],
    settings: &SurveySettings,
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

/// A pilot that gives no command.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoPilot;

impl Pilot for NoPilot {
    type Command = ();

    fn command(&mut self, _: &Belief) {}
}
