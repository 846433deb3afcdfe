use crate::belief::{Belief, Permission};
use interfaces::{CellState, Grid, LaserReading, Reading, ValueError, from_bytes, to_bytes};
use localizer::{Correction, GivenPoses, Localized, LoopClosed, LoopClosingLocalizer, PoseState};
use mapper::Mapper;
use nalgebra::{Isometry2, Matrix3};

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

    /// The surfaces in which poses are found, as bytes; none where poses are given.
    fn surfaces(&mut self) -> Vec<u8> {
        Vec::new()
    }

    /// Begins at an unknown pose in surfaces that another localization or a survey has left, or in a map if there are none.
    ///
    /// # Errors
    ///
    /// When the bytes are no surfaces.
    fn begin_in(&mut self, _surfaces: &[u8], _map: &Grid<CellState>) -> Result<(), ValueError> {
        Ok(())
    }

    /// Begins another session in the place that was learned, at a pose that is not known.
    fn begin_session(&mut self) {}

    /// Puts the robot at a pose with a covariance, by the word of a person or of another program. Poses that the source gives stay.
    fn seat(&mut self, _: Isometry2<f64>, _: &Matrix3<f64>) {}

    /// Whether nothing is being learned again in another thread.
    fn is_settled(&self) -> bool {
        true
    }

    /// Waits for what is being learned again, and takes it over: before a snapshot, and before another session.
    fn settle(&mut self, _: &mut Mapper) {}

    /// See [`LoopClosingLocalizer::switches`].
    fn switches(&self) -> &[usize] {
        &[]
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

    fn surfaces(&mut self) -> Vec<u8> {
        LoopClosingLocalizer::surfaces(self)
    }

    fn begin_in(&mut self, surfaces: &[u8], map: &Grid<CellState>) -> Result<(), ValueError> {
        LoopClosingLocalizer::begin_in(self, surfaces, map)
    }

    fn begin_session(&mut self) {
        LoopClosingLocalizer::begin_session(self);
    }

    fn seat(&mut self, pose: Isometry2<f64>, covariance: &Matrix3<f64>) {
        LoopClosingLocalizer::seat(self, pose, covariance);
    }

    fn is_settled(&self) -> bool {
        LoopClosingLocalizer::is_settled(self)
    }

    fn settle(&mut self, mapper: &mut Mapper) {
        LoopClosingLocalizer::settle(self, mapper);
    }

    fn switches(&self) -> &[usize] {
        LoopClosingLocalizer::switches(self)
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
