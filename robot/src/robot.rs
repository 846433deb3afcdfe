use crate::pilot::{Belief, Permission, Pilot};
use crate::session::Session;
use agent::Features;
use interfaces::{LaserReading, Reading, ValueError, from_bytes, to_bytes};
use localizer::{Correction, GivenPoses, Localized, LoopClosed, LoopClosingLocalizer, PoseState};
use mapper::{Mapper, ReadingError, ScanFilter};
use nalgebra::{Isometry2, Matrix3};

/// A robot that localizes itself, maps what it sees, and decides where to go. Its source gives readings and takes commands.
pub struct Robot<R, P> {
    /// Removes from scans what must not enter a map; `None`: the sensor has no errors.
    pub(crate) filter: Option<ScanFilter>,
    /// Gives the readings their poses.
    pub(crate) localization: Box<dyn Localization<R> + Send + Sync>,
    /// The map and the change statistics.
    pub mapper: Mapper,
    /// Decides the commands.
    pub pilot: P,
    session: Session,
}

/// What the robot has made of one reading.
#[derive(Clone, Debug)]
pub struct Turn<R, C> {
    /// The reading as it has entered the map: filtered, at the believed pose, with the times of the map.
    pub reading: R,
    /// What the robot believes about its pose.
    pub belief: Belief,
    /// The features by which the agent chooses a strategy.
    pub features: Features,
    /// The command until the next reading.
    pub command: C,
}

impl<R: Reading, P: Pilot> Robot<R, P> {
    /// A robot that has seen nothing, or goes on with what its parts have learned.
    pub fn new(localization: Box<dyn Localization<R> + Send + Sync>, mapper: Mapper, pilot: P) -> Self {
        Self { filter: None, localization, mapper, pilot, session: Session::default() }
    }

    /// The same robot, with a filter for its scans.
    #[must_use]
    pub fn with_filter(self, filter: ScanFilter) -> Self {
        Self { filter: Some(filter), ..self }
    }

    /// Makes of a reading the next command. A reading whose pose is not certain does not enter the map.
    ///
    /// # Errors
    ///
    /// When the mapper refuses the reading: the map stays as it was, and there is no command.
    pub fn step(&mut self, mut reading: R) -> Result<Turn<R, P::Command>, ReadingError> {
        // The times of the map never go back; what must not enter it is removed.
        if let Some(laser) = reading.laser_mut() {
            self.session.shift(laser);
            if let Some(filter) = &mut self.filter {
                filter.apply(laser);
            }
        }
        if reading.time() - self.mapper.time() > self.session.max_step_s && self.mapper.readings() > 0 {
            self.mapper.pause(reading.time());
        }
        // Localize.
        let (mut reading, belief) = self.localization.localize(reading, &mut self.mapper);
        // Map.
        if belief.is_certain() {
            if let (Some(filter), Some(laser)) = (&self.filter, reading.laser_mut()) {
                filter.protect(laser);
            }
            self.mapper.update(&reading)?;
            if let Some(filter) = &mut self.filter {
                filter.learn(&belief.pose);
            }
        } else {
            self.mapper.skip(&reading);
        }
        // Decide.
        let features = Features::of(&mut self.mapper);
        if belief.correction.is_some() {
            self.pilot.forget_map();
        }
        let command = self.pilot.command(&belief, features, &self.mapper);
        Ok(Turn { reading, belief, features, command })
    }

    /// How the times of the source become those of the map.
    pub fn session_mut(&mut self) -> &mut Session {
        &mut self.session
    }

    /// Begins another session in the place that was mapped before. The time between the sessions counts as not observed, and
    /// the localization begins without a pose, in the map that it has learned. `first_s` is the time of the first reading by
    /// the clock of its source, `gap_s` the time since the last reading, see [`Session::after`].
    pub fn begin_session(&mut self, first_s: f64, gap_s: Option<f64>) {
        self.settle();
        self.session = self.session.after(self.mapper.time(), first_s, gap_s);
        self.mapper.pause(first_s + self.session.offset_s);
        self.localization.begin_session();
    }

    /// Puts the robot at a pose in the map, with its covariance (x and y in m, heading in rad), set by the user or another
    /// program. Scans must agree before they enter the map.
    pub fn seat(&mut self, pose: Isometry2<f64>, covariance: &Matrix3<f64>) {
        self.settle();
        if let Some(localizer) = self.localization.localizer_mut() {
            localizer.seat(pose, covariance);
        }
        self.pilot.forget_map();
    }

    /// Whether nothing is being learned again in another thread.
    pub fn is_settled(&self) -> bool {
        self.localization.localizer().is_none_or(LoopClosingLocalizer::is_settled)
    }

    /// Whether [`settle`](Self::settle) would not wait long.
    pub fn is_up_to_date(&self) -> bool {
        self.localization.localizer().is_none_or(LoopClosingLocalizer::is_up_to_date)
    }

    /// Waits for what is being learned again, and takes it over. Returns whether the map is another one now.
    pub fn settle(&mut self) -> bool {
        let unsettled = self.localization.localizer_mut().filter(|localizer| !localizer.is_settled());
        let Some(localizer) = unsettled else { return false };
        localizer.settle(&mut self.mapper);
        self.pilot.forget_map();
        true
    }

    /// What is removed from scans; `None` if nothing is.
    pub fn filter(&self) -> Option<&ScanFilter> {
        self.filter.as_ref()
    }
}

/// Gives every reading its pose: the part between the filter and the mapper.
pub trait Localization<R> {
    /// The reading at the pose that the robot believes in; all beams of a scan belong to this pose. The map contains all
    /// earlier readings whose pose was certain. If their poses have become better, the map is learned again.
    fn localize(&mut self, reading: R, mapper: &mut Mapper) -> (R, Belief);

    /// Everything that readings have changed, as bytes; settings are not in it.
    fn snapshot(&mut self) -> Vec<u8> {
        Vec::new()
    }

    /// Goes on from the snapshot of a localization of the same kind, with the same settings, bit for bit.
    ///
    /// # Errors
    ///
    /// When the bytes are no such snapshot. The localization must not be used then.
    fn restore(&mut self, snapshot: &[u8]) -> Result<(), ValueError> {
        if snapshot.is_empty() { Ok(()) } else { Err(ValueError) }
    }

    /// Begins another session in the place that was learned, at a pose that is not known.
    fn begin_session(&mut self) {}

    /// The localizer that finds the poses; `None` where they are given.
    fn localizer(&self) -> Option<&LoopClosingLocalizer> {
        None
    }

    /// As [`localizer`](Self::localizer).
    fn localizer_mut(&mut self) -> Option<&mut LoopClosingLocalizer> {
        None
    }
}

/// The poses of the source, taken as exact.
#[derive(Clone, Copy, Debug, Default)]
pub struct ExactPoses;

impl<R: Reading> Localization<R> for ExactPoses {
    fn localize(&mut self, reading: R, _: &mut Mapper) -> (R, Belief) {
        let belief = Belief::exact(*reading.pose());
        (reading, belief)
    }
}

impl Localization<LaserReading> for GivenPoses {
    fn localize(&mut self, reading: LaserReading, mapper: &mut Mapper) -> (LaserReading, Belief) {
        ExactPoses.localize(self.deskewed(reading), mapper)
    }

    fn snapshot(&mut self) -> Vec<u8> {
        to_bytes(self)
    }

    fn restore(&mut self, snapshot: &[u8]) -> Result<(), ValueError> {
        *self = from_bytes(snapshot)?;
        Ok(())
    }

    fn begin_session(&mut self) {
        *self = GivenPoses::default();
    }
}

impl Localization<LaserReading> for LoopClosingLocalizer {
    fn localize(&mut self, reading: LaserReading, mapper: &mut Mapper) -> (LaserReading, Belief) {
        let LoopClosed { localized, correction } = LoopClosingLocalizer::localize(self, &reading, mapper);
        believed(localized, self.wants_rest(), correction)
    }

    fn snapshot(&mut self) -> Vec<u8> {
        LoopClosingLocalizer::snapshot(self)
    }

    fn restore(&mut self, snapshot: &[u8]) -> Result<(), ValueError> {
        LoopClosingLocalizer::restore(self, snapshot)
    }

    fn begin_session(&mut self) {
        LoopClosingLocalizer::begin_session(self);
    }

    fn localizer(&self) -> Option<&LoopClosingLocalizer> {
        Some(self)
    }

    fn localizer_mut(&mut self) -> Option<&mut LoopClosingLocalizer> {
        Some(self)
    }
}

fn believed(
    Localized { reading, estimate }: Localized,
    wants_rest: bool,
    correction: Option<Correction>,
) -> (LaserReading, Belief) {
    let permission = match estimate.state {
        _ if wants_rest => Permission::Rest,
        PoseState::Lost => Permission::LookAround,
        PoseState::Tracking | PoseState::Uncertain => Permission::Drive,
    };
    let belief = Belief { pose: reading.pose, estimate: Some(estimate), permission, correction };
    (reading, belief)
}
