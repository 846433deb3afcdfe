//! The surfaces along a known route, in which scans of other routes find their exact place.

use super::TrajectorySettings;
use super::keyframe::filled;
use super::matching::fit;
use crate::constants::{EXAMINED, KEYFRAME, MIN_AGREEMENT, MIN_OVERLAP, PLACE_STD};
use crate::given_poses::GivenPoses;
use crate::scan_points::{ScanPoint, ScanPoints};
use crate::score_grid::ScoreGrid;
use crate::search::search;
use crate::spread::Spread;
use crate::surfel_map::SurfelMap;
use interfaces::{GridFrame, LaserReading, SettingsError, ValueError};
use nalgebra::Isometry2;

/// The surfaces of a place as short straight lines, from the readings of a log along its trajectory. Unlike a grid, it is
/// exact to some millimeters.
#[derive(Clone, Debug)]
pub struct LineMap {
    settings: TrajectorySettings,
    map: SurfelMap,
    given: GivenPoses,
    points: ScanPoints,
    /// The pose of the last reading that was learned.
    last: Option<Isometry2<f64>>,
}

impl LineMap {
    /// An empty map of the rectangle of `frame`.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn new(settings: &TrajectorySettings, frame: &GridFrame) -> Result<Self, SettingsError> {
        settings.check()?;
        Ok(Self {
            settings: settings.clone(),
            map: SurfelMap::new(frame),
            given: GivenPoses::default(),
            points: ScanPoints::default(),
            last: None,
        })
    }

    /// Adds the next reading of the log, whose pose is that on the trajectory, if the robot has moved by a keyframe since the
    /// last one that was added.
    pub fn add(&mut self, reading: &LaserReading) {
        if reading.scan.check().is_err() {
            return;
        }
        let reading = self.given.deskewed(reading.clone());
        let pose = reading.pose;
        let step = self.last.map(|last| last.inv_mul(&pose));
        if step.is_some_and(|step| KEYFRAME.contains(&step)) {
            return;
        }
        self.last = Some(pose);
        let rules = self.settings.point_rules();
        let points = self.points.of(&reading, |_| 1.0, &rules);
        self.map.learn_keyframe(&filled(&points), &pose, rules.noise_m);
    }

    /// The surfaces, as bytes: what readings of other logs are matched with.
    pub fn snapshot(&mut self) -> Vec<u8> {
        self.map.saved()
    }

    /// The map with surfaces from a [snapshot](Self::snapshot), or from a [localizer](crate::Localizer::surfaces). No more readings
    /// of the log can be added.
    ///
    /// # Errors
    ///
    /// When the bytes are no surfaces.
    pub fn restored(settings: &TrajectorySettings, surfaces: &[u8]) -> Result<Self, ValueError> {
        let (given, points) = (GivenPoses::default(), ScanPoints::default());
        Ok(Self {
            settings: settings.clone(),
            map: SurfelMap::restored(surfaces)?,
            given,
            points,
            last: None,
        })
    }

    /// A matcher for the readings of another log.
    pub fn matcher(&self) -> LineMatcher<'_> {
        LineMatcher {
            line_map: self,
            given: GivenPoses::default(),
            points: ScanPoints::default(),
            scores: None,
        }
    }
}

/// A pose at which a scan agrees with a line map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineFit {
    /// The pose of the robot in the map, m and rad.
    pub pose: Isometry2<f64>,
    /// The share of the scan that lies on surfaces of the map, from 0 to 1.
    pub confirmed: f64,
}

/// Matches the readings of a log with a line map, one after the other.
#[derive(Clone, Debug)]
pub struct LineMatcher<'a> {
    line_map: &'a LineMap,
    given: GivenPoses,
    points: ScanPoints,
    /// How well points fit at each place, once a search has needed it.
    scores: Option<ScoreGrid>,
}

impl LineMatcher<'_> {
    /// The fit of the next reading, whose pose in the map is `near` with these standard deviations (m, rad). `None` if its
    /// scan does not agree with the map.
    pub fn matched(
        &mut self,
        reading: &LaserReading,
        near: &Isometry2<f64>,
        std: (f64, f64),
    ) -> Option<LineFit> {
        let points = self.points(reading);
        self.fit(&points, near, Spread { m: std.0, rad: std.1 })
    }

    /// The fits of the next reading anywhere in the map.
    pub fn anywhere(&mut self, reading: &LaserReading) -> Vec<LineFit> {
        let points = self.points(reading);
        let scores = self.scores.get_or_insert_with(|| ScoreGrid::anywhere(&self.line_map.map));
        let candidates = search(scores, &points, None, MIN_OVERLAP, EXAMINED);
        candidates.iter().filter_map(|candidate| self.fit(&points, &candidate.pose, PLACE_STD)).collect()
    }

    /// The points of a reading; none of an invalid one.
    fn points(&mut self, reading: &LaserReading) -> Vec<ScanPoint> {
        if reading.scan.check().is_err() {
            return Vec::new();
        }
        let reading = self.given.deskewed(reading.clone());
        self.points.of(&reading, |_| 1.0, &self.line_map.settings.point_rules())
    }

    fn fit(&self, points: &[ScanPoint], near: &Isometry2<f64>, std: Spread) -> Option<LineFit> {
        let noise_m = self.line_map.settings.point_rules().noise_m;
        let (found, agreement) = fit(&self.line_map.map, points, near, std, noise_m)?;
        let agrees = agreement.overlap() >= MIN_OVERLAP && agreement.share() >= MIN_AGREEMENT;
        let confirmed = agreement.confirmed / agreement.all;
        agrees.then_some(LineFit { pose: found.placement.pose, confirmed })
    }
}
