mod estimating;
mod everywhere;
mod guided;
mod relocalizing;
mod saved;
#[cfg(test)]
mod tests;

pub(crate) use guided::Guide;

use crate::calibration::Calibration;
use crate::changing_map::ChangingMap;
use crate::estimate::{Localized, PoseEstimate, PoseState, Start};
use crate::faults::{Fault, FaultFinder};
use crate::hypotheses::Hypotheses;
use crate::motion::Motion;
use crate::placement::shifted;
use crate::scan_points::{PointRules, ScanPoints};
use crate::score_grid::ScoreGrid;
use crate::settings::LocalizerSettings;
use crate::support::ClearBeams;
use crate::surfel_map::{Checker, SurfelMap};
use crate::sweep::SweepUndo;
use crate::verification::Verification;
use everywhere::WideSearch;
use interfaces::{CellState, Grid, GridFrame, LaserReading, SettingsError};
use nalgebra::{Isometry2, Matrix3, Vector3};

/// The number of scans between two updates of the weights by rates.
const RATES_EVERY: u32 = 100;
/// The uncertainty of a pose that is lost, m and rad.
const LOST_STD_M: f64 = 5.0;
const LOST_STD_RAD: f64 = 3.0;

/// Estimates the pose of a robot from odometry and scans. The same readings give the same bits.
#[derive(Clone, Debug)]
pub struct Localizer {
    settings: LocalizerSettings,
    surfels: SurfelMap,
    checker: Checker,
    points: ScanPoints,
    clear: ClearBeams,
    faults: FaultFinder,
    sweeps: SweepUndo,
    calibration: Calibration,
    scores: Option<(u64, ScoreGrid)>,
    hypotheses: Hypotheses,
    /// In a large map: the search in the whole of it, while it goes on.
    wide: Option<WideSearch>,
    /// The last estimate: its pose and covariance.
    pose: Isometry2<f64>,
    covariance: Matrix3<f64>,
    state: PoseState,
    /// The last valid odometry pose, its time, and the estimated motion to it.
    odometry: Option<Isometry2<f64>>,
    last_motion: Isometry2<f64>,
    /// How far the robot was from the last estimate, as the present scan shows: x, y (m) and heading (rad).
    begin: Vector3<f64>,
    /// The last motion by odometry.
    measured: Isometry2<f64>,
    time_s: f64,
    supported_s: Option<f64>,
    start_s: Option<f64>,
    /// Whether the robot started without a map.
    from_nothing: bool,
    /// If much of the view has moved at the present scan: the pose of a robot that follows it.
    follower: Option<Isometry2<f64>>,
    /// Where the odometry says that the robot is, since the last certain pose, and the time of that pose, s.
    by_odometry: Isometry2<f64>,
    certain_s: f64,
    /// While a found pose is verified: what speaks for it and against it.
    verification: Option<Verification>,
    /// Whether the present scan may enter the line map.
    learns: bool,
    /// The number of scans for which the odometry is not trusted.
    distrust: u32,
    /// The number of readings.
    readings: u32,
    /// The number of scans since the last search in the whole map.
    since_search: u32,
    /// The support below which the pose is searched for: lower where a search has confirmed a low support.
    accepted_support: f64,
    /// About where the robot is, if that is known.
    guide: Option<Guide>,
    /// Whether no guide is followed: the last one was wrong, or a search has found another pose. Until the next certain pose, or
    /// until nothing is left of what was found.
    ignores_guide: bool,
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
        let (pose, state) = match start {
            Start::At(pose) => (pose, PoseState::Tracking),
            Start::Unknown => (Isometry2::identity(), PoseState::Lost),
        };
        let std = match (start, from_nothing) {
            (Start::At(_), true) => Vector3::zeros(),
            (Start::At(_), false) => Vector3::new(0.05, 0.05, 0.02),
            (Start::Unknown, _) => Vector3::new(LOST_STD_M, LOST_STD_M, LOST_STD_RAD),
        };
        Ok(Self {
            settings: settings.clone(),
            surfels,
            checker: Checker::default(),
            points: ScanPoints::default(),
            clear: ClearBeams::default(),
            faults: FaultFinder::default(),
            sweeps: SweepUndo::default(),
            calibration: Calibration::new(&settings.odometry),
            scores: None,
            hypotheses: Hypotheses::default(),
            wide: None,
            pose,
            covariance: Matrix3::from_diagonal(&std.component_mul(&std)),
            state,
            odometry: None,
            last_motion: Isometry2::identity(),
            begin: Vector3::zeros(),
            measured: Isometry2::identity(),
            time_s: 0.0,
            supported_s: None,
            start_s: None,
            from_nothing,
            follower: None,
            by_odometry: pose,
            certain_s: f64::NEG_INFINITY,
            verification: None,
            learns: false,
            distrust: 0,
            readings: 0,
            since_search: u32::MAX,
            accepted_support: settings.min_support,
            guide: None,
            ignores_guide: false,
        })
    }

    /// Whether the robot should rest: at a start without a map, the first scans decide the heading of all that
    /// follows, and should all be made from one pose.
    pub fn wants_rest(&self) -> bool {
        let elapsed_s = self.start_s.map_or(0.0, |start_s| self.time_s - start_s);
        self.from_nothing && elapsed_s < self.settings.settle_s
    }

    /// Estimates the pose of a reading. `map` has learned changes from the readings so far whose pose was certain.
    ///
    /// A reading that cannot be true (an invalid scan, a frozen scan, a time that goes back) is never an error: its
    /// estimate is the prediction by odometry, and is not certain.
    pub fn localize(&mut self, reading: &LaserReading, map: &impl ChangingMap) -> Localized {
        let fault = self.faults.find(reading);
        if fault == Some(Fault::Invalid) {
            return self.skip(reading);
        }
        let motion = self.motion(reading);
        let elapsed_s = reading.time_s - self.time_s;
        if fault.is_none() {
            self.time_s = reading.time_s;
        }
        self.start_s.get_or_insert(self.time_s);
        self.readings = self.readings.wrapping_add(1);
        // At the first reading, a known map may bring rates.
        let is_due = self.readings == 1 || self.readings.is_multiple_of(RATES_EVERY);
        if is_due && self.settings.rate_horizon_s > 0.0 {
            self.surfels.weigh_by_rates(map, self.settings.rate_horizon_s);
        }
        let mut posed = reading.clone();
        self.undo_sweep(&mut posed, reading, &motion.delta, elapsed_s);
        let before = self.pose;
        self.begin = Vector3::zeros();
        let was_tracking = self.state == PoseState::Tracking;
        (self.learns, self.follower) = (false, None);
        self.by_odometry = motion.apply(&self.by_odometry);
        // Without a surface in it, a scan is as good as missing.
        let is_missing = self.points.points().is_empty() && !self.surfels.is_empty();
        let support = match is_missing {
            true => self.dead_reckon(&motion, if fault.is_none() { elapsed_s } else { 0.0 }),
            false => self.estimate(&posed, &motion, map, fault),
        };
        if self.state == PoseState::Tracking {
            (self.by_odometry, self.certain_s) = (self.pose, self.time_s);
            (self.ignores_guide, self.wide) = (false, None);
        }
        self.last_motion = shifted(&before, &self.begin).inv_mul(&self.pose);
        if was_tracking && self.state == PoseState::Tracking {
            let found = self.last_motion;
            self.calibration.learn(&self.measured, &found);
            if posed.scan.sweep_s > 0.0 {
                // The noise of the odometry within a scan bends its walls. The motion that the match has found does not.
                self.undo_sweep(&mut posed, reading, &found, elapsed_s);
            }
        }
        if fault.is_some() && self.state == PoseState::Tracking {
            self.state = PoseState::Uncertain;
            self.learns = false;
        }
        if self.learns || !self.settings.gate {
            self.learn(&posed, map);
        }
        self.localized(posed, support.share())
    }
}

impl Localizer {
    /// The motion since the last valid reading, by odometry.
    fn motion(&mut self, reading: &LaserReading) -> Motion {
        let before = self.odometry.replace(reading.pose).unwrap_or(reading.pose);
        self.measured = before.inv_mul(&reading.pose);
        let corrected = self.calibration.correct(&self.measured);
        let motion = Motion::new(corrected, &self.settings.odometry);
        if self.distrust > 0 { motion.distrusted() } else { motion }
    }

    /// Replaces the scan of `posed` by that of `reading` with all beams from the pose at its end, after a robot that
    /// moved by `motion` in the time `elapsed_s`.
    fn undo_sweep(
        &mut self,
        posed: &mut LaserReading,
        reading: &LaserReading,
        motion: &Isometry2<f64>,
        elapsed_s: f64,
    ) {
        let LocalizerSettings { range_noise_std_m: noise_m, weigh_by_arc_length: by_arc_length, .. } =
            self.settings;
        let rules = PointRules { noise_m, by_arc_length, grazing: true };
        self.sweeps.update(posed, &mut self.points, &rules, reading, (motion, elapsed_s));
        self.clear.update(&posed.scan);
    }

    /// Whether much of the view has moved at once at the last reading.
    pub(crate) fn much_has_moved(&self) -> bool {
        self.follower.is_some()
    }

    /// Learns the line map from a scan with a certain pose.
    fn learn(&mut self, reading: &LaserReading, map: &impl ChangingMap) {
        let noise_m = self.settings.range_noise_std_m;
        if let Some(follower) = &self.follower {
            let least_m = self.scene(reading, map).exact_m();
            self.surfels.displace_all(self.points.points(), &self.pose, follower, least_m);
        }
        let points = self.points.points();
        match self.state {
            PoseState::Tracking => self.surfels.learn(points, &self.pose, noise_m),
            _ => self.surfels.learn_uncertain(points, &self.pose, noise_m),
        }
        self.checker.check(&mut self.surfels, reading, &self.pose);
    }

    /// The answer to an invalid reading: the last pose.
    fn skip(&mut self, reading: &LaserReading) -> Localized {
        self.doubt();
        self.localized(reading.clone(), 0.0)
    }

    fn pose_estimate(&self, support: f64) -> PoseEstimate {
        PoseEstimate { pose: self.pose, covariance: self.covariance, support, state: self.state }
    }

    fn localized(&self, mut reading: LaserReading, support: f64) -> Localized {
        reading.pose = self.pose;
        Localized { reading, estimate: self.pose_estimate(support) }
    }
}
