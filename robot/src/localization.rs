use interfaces::{LaserReading, ValueError};
use localizer::{
    Correction, GivenPoses, Localized, Localizer, LoopClosed, LoopClosingLocalizer, PoseEstimate, PoseState,
};
use mapper::Mapper;

/// Gives every reading its pose: the part between the source and the mapper.
pub trait Localization<R> {
    /// The pose of a reading. The map contains all earlier readings whose pose was certain. If their poses have become
    /// better, the map is learned again.
    fn localize(&mut self, reading: R, mapper: &mut Mapper) -> Posed<R>;

    /// Everything that readings have changed, as bytes; settings are not in it.
    fn snapshot(&mut self) -> Vec<u8>;

    /// Goes on from the snapshot of a localization of the same kind, with the same settings, bit for bit.
    ///
    /// # Errors
    ///
    /// When the bytes are no such snapshot. The localization must not be used then.
    fn restore(&mut self, snapshot: &[u8]) -> Result<(), ValueError>;

    /// Begins another session in the place that was learned, at a pose that is not known.
    fn begin_session(&mut self);

    /// Whether nothing is being learned again in another thread.
    fn is_settled(&self) -> bool {
        true
    }

    /// Waits for what is being learned again, and takes it over: before a snapshot, and before another session.
    fn settle(&mut self, _: &mut Mapper) {}
}

/// A reading with its pose.
#[derive(Clone, Debug)]
pub struct Posed<R> {
    /// The reading. Its pose is the estimated one.
    pub reading: R,
    /// The estimate with its uncertainty; `None` if the source says that its poses are exact.
    pub estimate: Option<PoseEstimate>,
    /// What the robot may do with this pose.
    pub permission: Permission,
    /// If a loop was closed: the map was learned again with better poses.
    pub correction: Option<Correction>,
}

impl<R> Posed<R> {
    /// A reading of a source whose poses are exact.
    fn exact(reading: R) -> Self {
        Self { reading, estimate: None, permission: Permission::Drive, correction: None }
    }
}

/// What a robot may do, as far as its pose is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Permission {
    /// Drive to goals.
    #[default]
    Drive,
    /// Stand: the first scans at a start without a map should all be made from one pose.
    Rest,
    /// Look around, first in place, then from elsewhere: the robot is lost.
    LookAround,
}

/// The poses of the source, taken as exact.
#[derive(Clone, Copy, Debug, Default)]
pub struct ExactPoses;

impl<R> Localization<R> for ExactPoses {
    fn localize(&mut self, reading: R, _: &mut Mapper) -> Posed<R> {
        Posed::exact(reading)
    }

    fn snapshot(&mut self) -> Vec<u8> {
        Vec::new()
    }

    fn restore(&mut self, snapshot: &[u8]) -> Result<(), ValueError> {
        if snapshot.is_empty() { Ok(()) } else { Err(ValueError) }
    }

    fn begin_session(&mut self) {}
}

impl Localization<LaserReading> for GivenPoses {
    fn localize(&mut self, reading: LaserReading, _: &mut Mapper) -> Posed<LaserReading> {
        Posed::exact(self.deskewed(reading))
    }

    fn snapshot(&mut self) -> Vec<u8> {
        GivenPoses::snapshot(self)
    }

    fn restore(&mut self, snapshot: &[u8]) -> Result<(), ValueError> {
        GivenPoses::restore(self, snapshot)
    }

    fn begin_session(&mut self) {
        *self = GivenPoses::default();
    }
}

impl Localization<LaserReading> for Localizer {
    fn localize(&mut self, reading: LaserReading, mapper: &mut Mapper) -> Posed<LaserReading> {
        let localized = Localizer::localize(self, &reading, mapper);
        posed(localized, self.wants_rest(), None)
    }

    fn snapshot(&mut self) -> Vec<u8> {
        Localizer::snapshot(self)
    }

    fn restore(&mut self, snapshot: &[u8]) -> Result<(), ValueError> {
        Localizer::restore(self, snapshot)
    }

    fn begin_session(&mut self) {
        Localizer::begin_session(self);
    }
}

impl Localization<LaserReading> for LoopClosingLocalizer {
    fn localize(&mut self, reading: LaserReading, mapper: &mut Mapper) -> Posed<LaserReading> {
        let LoopClosed { localized, correction } = LoopClosingLocalizer::localize(self, &reading, mapper);
        posed(localized, self.wants_rest(), correction)
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

    fn is_settled(&self) -> bool {
        LoopClosingLocalizer::is_settled(self)
    }

    fn settle(&mut self, mapper: &mut Mapper) {
        LoopClosingLocalizer::settle(self, mapper);
    }
}

fn posed(localized: Localized, rests: bool, correction: Option<Correction>) -> Posed<LaserReading> {
    let permission = match localized.estimate.state {
        _ if rests => Permission::Rest,
        PoseState::Lost => Permission::LookAround,
        PoseState::Tracking | PoseState::Uncertain => Permission::Drive,
    };
    Posed { reading: localized.reading, estimate: Some(localized.estimate), permission, correction }
}
