mod estimating;
mod map_matcher;
mod saved;
mod state;
#[cfg(test)]
mod tests;

use crate::changing_map::ChangingMap;
use crate::constants::{LOST_STD, NEAR_STD};
use crate::estimate::{Localized, PoseEstimate, Start};
use crate::local_trajectory_builder::{LocalTrajectoryBuilder, Track};
use crate::motion::Predicted;
use crate::scan_points::PointRules;
use crate::settings::LocalizerSettings;
use crate::surfel_map::SurfelMap;
use interfaces::{CellState, Grid, GridFrame, LaserReading, SettingsError};
use map_matcher::MapMatcher;
use nalgebra::{Isometry2, Matrix3};

/// Rest at the start from nothing, s: the first scans decide the heading of all that follows (0.076° → 0.024°).
const SETTLE_S: f64 = 2.0;

/// Estimates the pose of a robot from odometry and scans. The same readings give the same bits.
#[derive(Clone, Debug)]
pub struct Localizer {
    builder: LocalTrajectoryBuilder<MapMatcher>,
    /// Whether much of the view has moved at once at the last reading.
    pub(crate) much_has_moved: bool,
}

impl Localizer {
    /// A localizer without a map: the first scans make one, in the frame in which `pose` is the pose of the first
    /// reading. `frame` covers the place.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn from_nothing(
        settings: &LocalizerSettings,
        frame: &GridFrame,
        pose: Isometry2<f64>,
    ) -> Result<Self, SettingsError> {
        Self::new(settings, SurfelMap::new(frame), Start::At(pose), true)
    }

    /// A localizer in a known map.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn in_map(
        settings: &LocalizerSettings,
        map: &Grid<CellState>,
        start: Start,
    ) -> Result<Self, SettingsError> {
        Self::new(settings, SurfelMap::from_grid(map), start, false)
    }

    fn new(
        settings: &LocalizerSettings,
        surfels: SurfelMap,
        start: Start,
        from_nothing: bool,
    ) -> Result<Self, SettingsError> {
        settings.check()?;
        let matcher = MapMatcher::new(settings, surfels, start, from_nothing);
        let rules = PointRules { noise_m: settings.range_noise_std_m, grazing: true };
        let mut builder = LocalTrajectoryBuilder::new(matcher, rules);
        builder.motion_prior.exists = true;
        let (pose, covariance) = match start {
            Start::At(pose) if from_nothing => (pose, Matrix3::zeros()),
            Start::At(pose) => (pose, NEAR_STD.covariance()),
            Start::Unknown => (Isometry2::identity(), LOST_STD.covariance()),
        };
        (builder.track.pose, builder.track.covariance) = (pose, covariance);
        Ok(Self { builder, much_has_moved: false })
    }

    /// Whether the robot should rest: at a start without a map, the first scans decide the heading of all that
    /// follows, and should all be made from one pose.
    pub fn wants_rest(&self) -> bool {
        let MapMatcher { from_nothing, times, .. } = &self.builder.matcher;
        *from_nothing && times.start_s.is_none_or(|start_s| times.now_s - start_s < SETTLE_S)
    }

    /// Estimates the pose of a reading. `map` has learned changes from the readings so far whose pose was certain.
    ///
    /// A reading that cannot be true (an invalid scan, a frozen scan, a time that goes back) is never an error: its
    /// estimate is the prediction by odometry, and is not certain.
    pub fn localize(&mut self, reading: &LaserReading, map: &impl ChangingMap) -> Localized {
        self.localize_near(reading, map, None)
    }

    /// The same with a pose prior. It helps where the scans fit, but do not fix the pose well enough; and a robot with a pose
    /// prior is not lost: in a map that is not finished, a search would always find something that looks like the place.
    pub(crate) fn localize_near(
        &mut self,
        reading: &LaserReading,
        map: &impl ChangingMap,
        prior: Option<Predicted>,
    ) -> Localized {
        let (mut reading, support) = match self.builder.add(reading, (map, prior)) {
            Some((reading, found)) => {
                self.much_has_moved = found.follower.is_some();
                (reading, found.support)
            }
            None => {
                self.builder.matcher.doubt();
                (reading.clone(), 0.0)
            }
        };
        let Track { pose, covariance, .. } = self.builder.track;
        reading.pose = pose;
        let state = self.builder.matcher.state.reported(self.builder.matcher.is_timed_out());
        Localized { reading, estimate: PoseEstimate { pose, covariance, support, state } }
    }
}
