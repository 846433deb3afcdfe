//! The map of the first log, in which later logs find their place.

use crate::error::SurveyError;
use crate::known_place::{KnownCells, KnownPlace};
use crate::permanent::permanent;
use crate::route::{Route, frame};
use crate::settings::SurveySettings;
use interfaces::{GridFrame, LaserReading};
use localizer::{LineMap, PoseState, TrajectoryPose, TrajectorySettings};
use mapper::{Mapper, ReadingError};
use nalgebra::Vector2;

/// How far later logs may leave the extent of the first one and still be aligned there, m.
const AROUND_M: f64 = 10.0;

/// Makes the map of the first log, in which later logs find their place.
#[derive(Debug)]
pub struct Aligner {
    settings: SurveySettings,
    mapper: Mapper,
    /// The surfaces, which are more exact than cells.
    lines: LineMap,
}

impl Aligner {
    /// An empty map around the route of the first log.
    ///
    /// # Errors
    ///
    /// When the route has no extent, or a setting is out of range.
    pub fn new(settings: &SurveySettings, first: &Route) -> Result<Self, SurveyError> {
        let extent = frame(std::slice::from_ref(first), settings)?;
        let around = (AROUND_M / extent.resolution_m()).ceil();
        let origin = extent.origin() - Vector2::repeat(around * extent.resolution_m());
        let sides = [extent.width(), extent.height()].map(|cells| cells + 2 * around as usize);
        // Around a place of the largest size, there is no space left.
        let frame = GridFrame::new(origin, extent.resolution_m(), sides[0], sides[1]).unwrap_or(extent);
        let mapper = Mapper::new(&settings.mapper, frame)?;
        let lines = LineMap::new(&TrajectorySettings::default(), &frame)?;
        Ok(Self { settings: settings.clone(), mapper, lines })
    }

    /// Adds a reading of the first log, with the pose that was found for it.
    ///
    /// # Errors
    ///
    /// When the mapper refuses the reading.
    pub fn add(&mut self, reading: LaserReading, found: &TrajectoryPose) -> Result<(), ReadingError> {
        let mut reading = self.settings.filtered(reading);
        reading.pose = found.pose;
        if found.state == PoseState::Tracking {
            self.lines.add(&reading);
        }
        match found.state {
            PoseState::Tracking => self.mapper.update(&reading)?,
            PoseState::Uncertain | PoseState::Lost => self.mapper.skip(&reading),
        }
        Ok(())
    }

    /// The map when the log is over.
    pub fn finish(self) -> KnownPlace {
        let Self { settings, mapper, lines } = self;
        let rates = mapper.changed().map(|index| (index, mapper.rate(index))).collect();
        let cells = KnownCells { states: mapper.states().clone(), rates };
        KnownPlace::new(settings, cells, permanent(&mapper), lines)
    }
}
