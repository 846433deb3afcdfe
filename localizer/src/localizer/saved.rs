//! A localizer in a state file, and in the next session.

use super::Localizer;
use crate::constants::NEAR_STD;
use crate::estimate::Start;
use crate::faults::FaultFinder;
use crate::local_trajectory_builder::LocalTrajectoryBuilder;
use crate::surfel_map::SurfelMap;
use interfaces::{CellState, Grid, ValueError, Values, values};
use nalgebra::{Isometry2, Matrix3};

impl Localizer {
    /// Everything that readings have changed, as bytes; settings are not in it.
    pub fn snapshot(&mut self) -> Vec<u8> {
        interfaces::snapshot(self.values())
    }

    /// Goes on from the snapshot of a localizer with the same settings and the same frame, bit for bit.
    ///
    /// # Errors
    ///
    /// When the bytes are no such snapshot. The localizer must not be used then.
    pub fn restore(&mut self, snapshot: &[u8]) -> Result<(), ValueError> {
        interfaces::restore(self.values(), snapshot)?;
        self.builder.matcher.surfels.check()
    }

    /// Begins another session in the map that was learned: the robot can be anywhere in it. What was learned about the
    /// odometry holds on. Without a map, the session begins as the first one.
    pub fn begin_session(&mut self) {
        let builder = &mut self.builder;
        (builder.faults, builder.time_s) = (FaultFinder::default(), None);
        builder.motion_prior.begin_session();
        builder.track.last_motion = Isometry2::identity();
        self.much_has_moved = false;
        if let Some(covariance) = builder.matcher.begin_session() {
            builder.track.covariance = covariance;
        }
    }

    /// Puts the robot where another source says that it is, in the map that was learned: the next scans confirm the pose, correct it
    /// from scans around it, or refuse it, and then the pose is searched for.
    pub fn seat(&mut self, pose: Isometry2<f64>, covariance: &Matrix3<f64>) {
        let track = &mut self.builder.track;
        (track.pose, track.covariance) = (pose, covariance + NEAR_STD.covariance());
        track.last_motion = Isometry2::identity();
        self.builder.matcher.seat(pose);
        self.much_has_moved = false;
    }

    /// The surfaces in which poses are found, as bytes: also for a [`KnownPlace`](crate::KnownPlace).
    pub fn surfaces(&mut self) -> Vec<u8> {
        self.builder.matcher.surfels.saved()
    }

    /// Begins at an unknown pose in surfaces that were learned before, in the frame of this localizer, or in a map if there are
    /// none. If the map has no surface either, the localizer stays as it is. Returns whether there are surfaces.
    ///
    /// # Errors
    ///
    /// When the bytes are no surfaces.
    pub fn begin_in(&mut self, surfaces: &[u8], map: &Grid<CellState>) -> Result<bool, ValueError> {
        let known = match surfaces {
            [] => SurfelMap::from_grid(map),
            bytes => SurfelMap::restored(bytes)?.moved_to(map.frame()),
        };
        let is_known = !known.is_empty();
        if is_known {
            let settings = self.builder.matcher.settings.clone();
            *self = Self::new(&settings, known, Start::Unknown, false).map_err(|_| ValueError)?;
        }
        Ok(is_known)
    }

    fn values(&mut self) -> Values<'_> {
        let LocalTrajectoryBuilder { faults, motion_prior, matcher, track, time_s, .. } = &mut self.builder;
        values![
            matcher.checker, matcher.state, matcher.verification, matcher.relocalization, matcher.times,
            matcher.by_odometry, matcher.accepted_support, matcher.from_nothing, matcher.ignores_prior,
            *faults, *motion_prior, *track, *time_s; matcher.surfels
        ]
    }
}
