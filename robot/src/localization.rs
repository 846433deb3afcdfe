use crate::belief::{Belief, Permission};
use interfaces::{LaserReading, Reading, ValueError, from_bytes, to_bytes};
use localizer::{Correction, GivenPoses, Localized, LoopClosed, LoopClosingLocalizer, PoseState};
use mapper::Mapper;

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
