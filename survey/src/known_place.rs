//! The surfaces that the first log has seen: the place in which later logs find theirs.

use crate::error::SurveyError;
use crate::route::{Route, frame};
use crate::settings::SurveySettings;
use interfaces::{GridFrame, LaserReading, ValueError};
use localizer::{LineMap, PoseState, TrajectoryPose, TrajectorySettings};
use mapper::ScanFilter;
use nalgebra::Vector2;

/// How far later logs may leave the extent of the first one and still be aligned there, m.
const AROUND_M: f64 = 10.0;

/// The surfaces along the route of the first log, as later logs need them.
#[derive(Clone, Debug)]
pub struct KnownPlace {
    pub(crate) filter: ScanFilter,
    pub(crate) lines: LineMap,
}

impl KnownPlace {
    /// A place without surfaces, around the route of the first log.
    ///
    /// # Errors
    ///
    /// When the route has no extent, or is too large for a map.
    pub fn new(settings: &SurveySettings, first: &Route) -> Result<Self, SurveyError> {
        let extent = frame(std::slice::from_ref(first), settings)?;
        let around = (AROUND_M / extent.resolution_m()).ceil();
        let origin = extent.origin() - Vector2::repeat(around * extent.resolution_m());
        let sides = [extent.width(), extent.height()].map(|cells| cells + 2 * around as usize);
        // Around a place of the largest size, there is no space left.
        let frame = GridFrame::new(origin, extent.resolution_m(), sides[0], sides[1]).unwrap_or(extent);
        let lines = LineMap::new(&TrajectorySettings::default(), &frame)?;
        Ok(Self { filter: settings.scan_filter(), lines })
    }

    /// Adds a reading of the first log, with the pose that was found for it; if the pose is not certain, it says nothing.
    pub fn add(&mut self, reading: LaserReading, found: &TrajectoryPose) {
        if found.state == PoseState::Tracking {
            self.lines.add(&LaserReading { pose: found.pose, ..self.filter.filter(reading) });
        }
    }

    /// The surfaces, as bytes.
    pub(crate) fn surfaces(mut self) -> Vec<u8> {
        self.lines.snapshot()
    }

    /// The place with surfaces from their bytes. No more readings can be added.
    pub(crate) fn restored(settings: &SurveySettings, surfaces: &[u8]) -> Result<Self, ValueError> {
        let lines = LineMap::restored(&TrajectorySettings::default(), surfaces)?;
        Ok(Self { filter: settings.scan_filter(), lines })
    }
}
