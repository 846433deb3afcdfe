//! The route of a log, and the cells that cover several of them.

use crate::extent::{self, Reach, SeenArea};
use crate::quality::{Quality, QualityCheck, Verdict};
use crate::range_noise::RangeNoise;
use crate::settings::{SurveyError, SurveySettings};
use interfaces::{GridFrame, LaserReading, PoseMode, Scan, heading_rad, wrap_rad};
use localizer::{
    DistanceScale, GivenPoses, LocalizerSettings, PoseState, Trajectory, TrajectoryFinder, TrajectoryPose,
};
use mapper::ScanFilter;
use nalgebra::{Isometry2, Point2};
use std::ops::Range;

/// A log along its trajectory.
#[derive(Clone, Debug)]
pub struct Route {
    /// The trajectory, in the frame of the map; without loops, a residual and a scale where none was searched.
    pub trajectory: Trajectory,
    /// The standard deviation of the ranges of a laser that stands, m; `None` where it is not known.
    pub range_std_m: Option<f64>,
    /// How far the trajectory agrees with its own scans.
    pub quality: Quality,
    /// The scale with which the pass was repeated; `None` if it was not.
    pub scaled: Option<DistanceScale>,
    /// The readings whose poses are in doubt.
    in_doubt: Vec<Range<usize>>,
    reaches: Vec<Reach>,
    /// The area that was seen, m²: more where the route was corrected later.
    pub(crate) seen_m2: f64,
}

impl Route {
    /// The route of a log, in the frame of its first pose. `pass_over` adds all readings to the pass that it gets; it is called
    /// again if the distances of the odometry have a scale that wheels can explain.
    ///
    /// # Errors
    ///
    /// When a setting is out of range, and those of `pass_over`.
    pub fn of_passes(
        settings: &SurveySettings,
        mut pass_over: impl FnMut(FirstPass) -> Result<Self, SurveyError>,
    ) -> Result<Self, SurveyError> {
        let route = pass_over(FirstPass::new(settings)?)?;
        match route.trajectory.distance_scale.filter(|scale| scale.is_significant() && scale.is_plausible()) {
            Some(scale) => {
                let scaled = pass_over(FirstPass::new(settings)?.with_distance_scale(&scale))?;
                Ok(Self { scaled: Some(scale), ..scaled })
            }
            None => Ok(route),
        }
    }

    /// What users should know about the scale of the distances of the odometry, in a sentence.
    pub(crate) fn scale_note(&self) -> Option<String> {
        if let Some(DistanceScale { scale, .. }) = self.scaled {
            let percent = 100.0 * (scale.recip() - 1.0);
            let direction = if percent < 0.0 { "short" } else { "long" };
            return Some(format!(
                "the odometry measures distances {:.1} % too {direction}: the route was found once more with this scale",
                percent.abs()
            ));
        }
        let DistanceScale { scale, .. } =
            self.trajectory.distance_scale.filter(|scale| !scale.is_plausible())?;
        Some(format!(
            "by its scans, the robot moves {scale:.2} times as far as by its odometry, which wheels do not explain: the odometry was \
             used as it is; check its units, and whether it is of this robot"
        ))
    }

    /// The route without certain poses where they are in doubt, if the map is usable with care: what only such scans show is no
    /// change. In a good map, what contradicts other scans is one, and a map that is not usable is used as it is, or not at all.
    #[must_use]
    pub(crate) fn without_doubts(mut self) -> Self {
        if self.quality.verdict() == Verdict::UsableWithCare {
            let poses = &mut self.trajectory.poses;
            let in_doubt = self.in_doubt.iter().flat_map(Range::clone);
            for reading in in_doubt {
                if poses[reading].state == PoseState::Tracking {
                    poses[reading].state = PoseState::Uncertain;
                }
            }
        }
        self
    }

    /// The cells of the map that cover what was seen along the route.
    ///
    /// # Errors
    ///
    /// When no reading has a certain pose, or when the place is too large for a map.
    pub(crate) fn frame(&self, settings: &SurveySettings) -> Result<GridFrame, SurveyError> {
        let readings = self.trajectory.poses.iter().zip(&self.reaches);
        let certain = readings.filter(|(at, _)| at.state == PoseState::Tracking);
        extent::frame(
            certain.flat_map(|(at, reach)| reach.hits().map(|hit| at.pose * hit)),
            settings.resolution_m,
        )
    }

    /// The route in another frame, whose pose of this frame is `by`.
    #[must_use]
    pub fn moved(mut self, by: &Isometry2<f64>) -> Self {
        self.trajectory.poses.iter_mut().for_each(|at| at.pose = by * at.pose);
        for doubt in &mut self.quality.doubts {
            let at = by * Point2::new(doubt.x_m, doubt.y_m);
            (doubt.x_m, doubt.y_m) = (at.x, at.y);
        }
        self
    }
}

/// The distance between two poses, m.
pub(crate) fn distance_m(from: &TrajectoryPose, to: &TrajectoryPose) -> f64 {
    (to.pose.translation.vector - from.pose.translation.vector).norm()
}

/// The number of readings in a part of a route whose scan does not support their pose.
pub(crate) fn uncertain(poses: &[TrajectoryPose]) -> usize {
    poses.iter().filter(|pose| pose.state != PoseState::Tracking).count()
}

/// The first pass over a log: its trajectory, and how far its readings reach.
#[derive(Debug)]
pub struct FirstPass {
    settings: SurveySettings,
    filter: ScanFilter,
    /// Finds the trajectory; `None` where the poses of the log are used.
    finder: Option<TrajectoryFinder>,
    given: Vec<TrajectoryPose>,
    deskew: GivenPoses,
    range_noise: RangeNoise,
    quality: QualityCheck,
    reaches: Vec<Reach>,
    /// The corners of the rectangle that was seen so far.
    seen: Option<(Point2<f64>, Point2<f64>)>,
    area: SeenArea,
    turns: Turns,
}

/// Before its loops are closed, a trajectory can be longer than the place: this share of its sides counts.
const SURE_SHARE: f64 = 0.8;

impl FirstPass {
    /// A pass without a reading.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn new(settings: &SurveySettings) -> Result<Self, SurveyError> {
        settings.check()?;
        let finder = match settings.pose {
            PoseMode::Localized => Some(TrajectoryFinder::new(&LocalizerSettings::of_logs())?),
            PoseMode::Exact | PoseMode::Odometry | PoseMode::Corrected => None,
        };
        Ok(Self {
            settings: settings.clone(),
            filter: settings.scan_filter(),
            finder,
            given: Vec::new(),
            deskew: GivenPoses::default(),
            range_noise: RangeNoise::default(),
            quality: QualityCheck::default(),
            reaches: Vec::new(),
            seen: None,
            area: SeenArea::default(),
            turns: Turns::default(),
        })
    }

    /// The same pass, for an odometry whose distances have a scale.
    fn with_distance_scale(mut self, scale: &DistanceScale) -> Self {
        self.finder = self.finder.map(|finder| finder.with_distance_scale(scale));
        self
    }

    /// Adds the next reading.
    pub fn add(&mut self, reading: LaserReading) {
        let filtered = self.filter.filter(reading.clone());
        let reach = Reach::of(&filtered);
        self.reaches.push(reach);
        self.turns.add(&reading);
        let (deskewed, found) = match &mut self.finder {
            Some(finder) => {
                let deskewed = finder.add(reading);
                (deskewed, finder.newest())
            }
            None => {
                self.range_noise.add(&reading);
                let (time_s, pose, state) = (reading.time_s, reading.pose, PoseState::Tracking);
                self.given.push(TrajectoryPose { time_s, pose, state });
                (self.deskew.deskewed(reading), self.given.last().copied())
            }
        };
        if let Some(found) = &found {
            self.quality.add(&deskewed, &found.pose);
        }
        let certain = found.filter(|found| found.state == PoseState::Tracking);
        if let Some(found) = &certain {
            self.area.add(&filtered, &found.pose);
        }
        for hit in certain.iter().flat_map(|found| reach.hits().map(|hit| found.pose * hit)) {
            let (low, high) = self.seen.unwrap_or((hit, hit));
            self.seen = Some((low.inf(&hit), high.sup(&hit)));
        }
    }

    /// Checks what was seen so far: beams that are mirrored, and a place that is too large for a map, need not be seen to their
    /// end.
    ///
    /// # Errors
    ///
    /// When the scans turn against the poses, and when the place is too large for a map.
    pub fn check(&self) -> Result<(), SurveyError> {
        self.turns.check()?;
        let Some((low, high)) = self.seen else { return Ok(()) };
        let share = if self.finder.is_some() { SURE_SHARE } else { 1.0 };
        extent::around(low, low + (high - low) * share, self.settings.resolution_m).map(drop)
    }

    /// The log along its trajectory, in the frame of its first pose.
    pub fn finish(self) -> Route {
        let trajectory = match self.finder {
            Some(finder) => finder.finish(),
            None => Trajectory { poses: self.given, ..Trajectory::default() },
        };
        let (quality, in_doubt) = self.quality.finish(&trajectory.poses);
        let (range_std_m, seen_m2, reaches) = (self.range_noise.std_m(), self.area.m2(), self.reaches);
        Route { trajectory, range_std_m, quality, scaled: None, in_doubt, reaches, seen_m2 }
    }
}

// Whether scans turn as the poses of a log say.

/// Scans are compared over turns from and to this angle, rad: a smaller one is within the errors of the odometry, over a
/// larger one little is seen twice.
const MIN_TURN_RAD: f64 = 0.1;
const MAX_TURN_RAD: f64 = 0.8;
/// On which the robot moves less than this, m.
const MAX_TRANSLATION_M: f64 = 0.3;
/// At least this number of beams must have a range in both scans.
const MIN_BEAMS: usize = 40;
/// Differences of ranges count up to this one, m.
const MAX_DIFFERENCE_M: f64 = 1.0;
/// Scans fit one way if their mean difference there is below this share of the other one.
const FITS_SHARE: f64 = 0.6;
/// Beams are mirrored if this number of turns says so, and at least this number of times as many as say the contrary.
const MIN_TURNS: usize = 8;
const TIMES_MORE: usize = 5;

/// Compares scans over turns of the robot.
#[derive(Debug, Default)]
pub(crate) struct Turns {
    /// The last scan of each laser that was compared, the pose of the robot, and that of the laser on it.
    last: Vec<(Isometry2<f64>, Isometry2<f64>, Scan)>,
    with: usize,
    against: usize,
}

impl Turns {
    /// Adds the next reading.
    pub(crate) fn add(&mut self, reading: &LaserReading) {
        let Some(known) = self.last.iter_mut().find(|(_, mount, _)| *mount == reading.mount) else {
            // A laser that pans has as many places as readings.
            self.last.truncate(3);
            self.last.insert(0, (reading.pose, reading.mount, reading.scan.clone()));
            return;
        };
        let motion = known.0.inv_mul(&reading.pose);
        let turn_rad = heading_rad(&motion);
        let is_near = motion.translation.vector.norm() < MAX_TRANSLATION_M;
        if is_near && turn_rad.abs() < MIN_TURN_RAD {
            return;
        }
        if is_near && turn_rad.abs() < MAX_TURN_RAD {
            let way = |turn_rad: f64| difference_m(&known.2, &reading.scan, turn_rad);
            if let Some((with_m, against_m)) = way(turn_rad).zip(way(-turn_rad)) {
                self.with += usize::from(with_m < FITS_SHARE * against_m);
                self.against += usize::from(against_m < FITS_SHARE * with_m);
            }
        }
        *known = (reading.pose, reading.mount, reading.scan.clone());
    }

    /// Checks that the beams are not mirrored.
    pub(crate) fn check(&self) -> Result<(), SurveyError> {
        let Self { with, against, .. } = *self;
        let is_mirrored = against >= MIN_TURNS && against >= TIMES_MORE * with;
        if is_mirrored { Err(SurveyError::Mirrored { against, with }) } else { Ok(()) }
    }
}

/// The mean difference of the ranges of two scans, of which the second was taken after this turn, m. `None` if too few
/// beams can be compared.
fn difference_m(before: &Scan, after: &Scan, turn_rad: f64) -> Option<f64> {
    let (mut sum_m, mut count) = (0.0, 0);
    for (beam, range_m) in after.ranges_m.iter().enumerate() {
        let angle_rad = wrap_rad(after.angle_rad(beam) + turn_rad - before.angle_min_rad);
        // From the first beam on, once around.
        let angle_rad = if before.angle_increment_rad < 0.0 { -angle_rad } else { angle_rad };
        let angle_rad = angle_rad.rem_euclid(std::f64::consts::TAU);
        let same = (angle_rad / before.angle_increment_rad.abs()).round();
        let Some(other_m) = before.ranges_m.get(same as usize) else { continue };
        let difference_m = f64::from(range_m - other_m).abs();
        if difference_m.is_finite() {
            sum_m += difference_m.min(MAX_DIFFERENCE_M);
            count += 1;
        }
    }
    (count >= MIN_BEAMS).then(|| sum_m / f64::from(count as u32))
}
