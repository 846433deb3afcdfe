use interfaces::{LaserReading, ValueError};
use localizer::{GivenPoses, Localizer, PoseEstimate, PoseState};
use mapper::Mapper;

/// Gives every reading its pose: the part between the source and the mapper.
pub trait Localization<R> {
    /// The pose of a reading. The map contains all earlier readings whose pose was certain.
    fn localize(&mut self, reading: R, mapper: &Mapper) -> Posed<R>;

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
    fn localize(&mut self, reading: R, _: &Mapper) -> Posed<R> {
        Posed { reading, estimate: None, permission: Permission::Drive }
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
    fn localize(&mut self, reading: LaserReading, _: &Mapper) -> Posed<LaserReading> {
        Posed { reading: self.unswept(reading), estimate: None, permission: Permission::Drive }
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
    fn localize(&mut self, reading: LaserReading, mapper: &Mapper) -> Posed<LaserReading> {
        let localized = Localizer::localize(self, &reading, mapper);
        let permission = match localized.estimate.state {
            _ if self.wants_rest() => Permission::Rest,
            PoseState::Lost => Permission::LookAround,
            PoseState::Tracking | PoseState::Uncertain => Permission::Drive,
        };
        Posed { reading: localized.reading, estimate: Some(localized.estimate), permission }
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
