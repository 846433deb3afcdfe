//! Where the frame of a later log lies in the map of the first one.

use crate::error::SurveyError;
use crate::known_place::{KnownCells, KnownPlace};
use crate::permanent::permanent;
use crate::route::{Route, frame};
use crate::settings::SurveySettings;
use interfaces::{GridFrame, LaserReading, heading_rad, wrap_rad};
use localizer::{
    LineMap, LineMatcher, Localizer, LocalizerSettings, PoseState, Start, TrajectoryPose, TrajectorySettings,
};
use mapper::{Mapper, ReadingError};
use nalgebra::{Isometry2, Vector2};

/// How far later logs may leave the extent of the first one and still be aligned there, m.
const AROUND_M: f64 = 10.0;
/// At least this share of the readings must have a certain pose in the map of the first log.
const LEAST_CERTAIN: f64 = 0.3;
/// The standard deviations of a pose in the map of cells, m and rad.
const CELLS_STD: (f64, f64) = (0.05, 0.01);

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
        if found.state == PoseState::Tracking {
            self.lines.add(&reading, &found.pose);
        }
        reading.pose = found.pose;
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

/// The search for the place of a log in the map of the first one.
#[derive(Debug)]
pub struct Search<'a> {
    settings: &'a SurveySettings,
    cells: &'a KnownCells,
    localizer: Localizer,
    lines: LineMatcher<'a>,
    start: Start,
    /// The same as `pairs`, of the readings that fit where they were expected.
    as_expected: Vec<[Isometry2<f64>; 2]>,
    /// The pose in the map, and the pose on the route of the log, of every reading that is certain in both.
    pairs: Vec<[Isometry2<f64>; 2]>,
    readings: usize,
}

impl<'a> Search<'a> {
    /// Begins the search for a later log, from the pose of its first reading in the map if that is known.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn new(place: &'a KnownPlace, start: Start) -> Result<Self, SurveyError> {
        let settings = &place.settings;
        let of_localizer = LocalizerSettings {
            range_noise_std_m: settings.mapper.steady.range_noise_std_m,
            ..LocalizerSettings::default()
        };
        Ok(Self {
            settings,
            cells: &place.cells,
            localizer: Localizer::in_map(&of_localizer, &place.permanent, start)?,
            lines: place.lines.matcher(),
            start,
            as_expected: Vec::new(),
            pairs: Vec::new(),
            readings: 0,
        })
    }

    /// Adds the next reading of the log, with its pose on the route of this log.
    pub fn add(&mut self, reading: LaserReading, found: &TrajectoryPose) {
        self.readings += 1;
        let reading = self.settings.filtered(reading);
        if let Start::At(start) = &self.start {
            // Where the scan fits at once there is nothing to search, even if it does not fix the pose, as in a corridor.
            let near = start * found.pose;
            if let Some(exact) = self.lines.matched(&reading, &near, CELLS_STD) {
                self.as_expected.push([exact, found.pose]);
                return;
            }
        }
        let estimate = self.localizer.localize(&reading, self.cells).estimate;
        if estimate.state == PoseState::Tracking && found.state == PoseState::Tracking {
            let exact = self.lines.matched(&reading, &estimate.pose, CELLS_STD);
            self.pairs.push([exact.unwrap_or(estimate.pose), found.pose]);
        }
    }

    /// The pose of the frame of the route in the map: the median of all readings that are certain in both.
    ///
    /// # Errors
    ///
    /// When too few readings have a certain pose in the map.
    pub fn finish(self) -> Result<Isometry2<f64>, SurveyError> {
        let pairs = if self.as_expected.len() > self.pairs.len() { self.as_expected } else { self.pairs };
        let (certain, readings) = (pairs.len(), self.readings);
        let turns = pairs.iter().map(|[map, own]| heading_rad(map) - heading_rad(own));
        let turns: Vec<f64> = turns.map(wrap_rad).collect();
        let Some(reference) = turns.first().filter(|_| certain as f64 >= LEAST_CERTAIN * readings as f64)
        else {
            return Err(SurveyError::OtherPlace { certain, readings });
        };
        // Angles are averaged around one of them.
        let about = median(turns.iter().map(|turn| wrap_rad(turn - reference)));
        let rotation = interfaces::rotation(reference + about);
        let offset =
            |[map, own]: &[Isometry2<f64>; 2]| map.translation.vector - rotation * own.translation.vector;
        let (x, y): (Vec<f64>, Vec<f64>) = pairs.iter().map(offset).map(|at| (at.x, at.y)).unzip();
        let translation = Vector2::new(median(x.into_iter()), median(y.into_iter()));
        Ok(Isometry2::from_parts(translation.into(), rotation))
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or_default()
}
