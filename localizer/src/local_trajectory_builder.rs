//! The local trajectory builder: the pose of a robot from reading to reading. Live localization matches scans with the line
//! map of the place ([`crate::localizer::MapMatcher`]), trajectories of logs with the submap of the last keyframes
//! ([`crate::trajectory::SubmapMatcher`]).
//!
//! ```text
//! reading ─▶ faults ─▶ motion prior ─▶ deskew ─▶ match ─▶ calibrate ─▶ deskew again ─▶ insert in the map
//! ```

use crate::deskew::Deskew;
use crate::faults::{Fault, FaultFinder};
use crate::motion::{Motion, MotionPrior, Predicted};
use crate::placement::shifted;
use crate::scan_path::ScanPath;
use crate::scan_points::{PointRules, ScanPoint};
use interfaces::LaserReading;
use nalgebra::{Isometry2, Matrix3, Vector3};

/// Matches scans with a map, and inserts them in it. `C` is what a scan brings along.
pub(crate) trait ScanMatcher<C> {
    /// What a match says beside the pose.
    type Found;

    /// Moves the track to the pose of a scan.
    fn matched(&mut self, scan: &IncomingScan, track: &mut Track, context: C) -> Matched<Self::Found>;

    /// Inserts a scan in the map, if its match allows it.
    fn insert(&mut self, scan: &IncomingScan, track: &Track, found: &Self::Found, context: C);
}

/// The result of a match.
pub(crate) struct Matched<F> {
    /// How far the robot was from the last pose of the track, as the scan shows: x, y (m) and heading (rad).
    pub(crate) begin: Vector3<f64>,
    /// Whether the odometry can learn from the motion.
    pub(crate) is_reliable: bool,
    /// Whether the odometry is an outlier, as a scan shows that supports the pose.
    pub(crate) is_outlier: Option<bool>,
    pub(crate) found: F,
}

/// The last pose of the robot.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct Track {
    pub(crate) pose: Isometry2<f64>,
    pub(crate) covariance: Matrix3<f64>,
    /// The motion from the pose before.
    pub(crate) last_motion: Isometry2<f64>,
}

/// A valid reading with the values that belong to it.
#[derive(Clone, Debug)]
pub(crate) struct IncomingScan {
    /// The reading with a deskewed scan, and with the pose by odometry.
    pub(crate) reading: LaserReading,
    /// The points of the scan on surfaces.
    pub(crate) points: Vec<ScanPoint>,
    pub(crate) fault: Option<Fault>,
    /// The motion since the last reading, and the pose after it.
    pub(crate) motion: Motion,
    pub(crate) predicted: Predicted,
    /// The motion as the odometry measured it.
    pub(crate) measured: Isometry2<f64>,
    /// Whether there is an odometry, as far as is known.
    pub(crate) has_odometry: bool,
    /// The time since the last reading, s.
    pub(crate) elapsed_s: f64,
    /// The time of the latest reading, s.
    pub(crate) now_s: f64,
}

/// Builds the track from readings.
#[derive(Clone, Debug)]
pub(crate) struct LocalTrajectoryBuilder<M> {
    pub(crate) faults: FaultFinder,
    pub(crate) motion_prior: MotionPrior,
    deskew: Deskew,
    pub(crate) matcher: M,
    pub(crate) track: Track,
    /// The time of the latest reading, s.
    pub(crate) time_s: Option<f64>,
}

impl<M> LocalTrajectoryBuilder<M> {
    pub(crate) fn new(matcher: M, rules: PointRules) -> Self {
        Self {
            faults: FaultFinder::default(),
            motion_prior: MotionPrior::default(),
            deskew: Deskew::new(rules),
            matcher,
            track: Track::default(),
            time_s: None,
        }
    }

    /// Moves the track to the next reading. `None` if the reading is invalid.
    pub(crate) fn add<C: Copy>(
        &mut self,
        reading: &LaserReading,
        context: C,
    ) -> Option<(LaserReading, M::Found)>
    where
        M: ScanMatcher<C>,
    {
        let fault = self.faults.find(reading);
        if fault == Some(Fault::Invalid) {
            return None;
        }
        let mut scan = self.incoming(reading, fault);
        let before = self.track.pose;
        let matched = self.matcher.matched(&scan, &mut self.track, context);
        let motion = shifted(&before, &matched.begin).inv_mul(&self.track.pose);
        self.track.last_motion = motion;
        if let Some(is_outlier) = matched.is_outlier {
            self.motion_prior.judge(is_outlier);
        }
        if matched.is_reliable {
            self.motion_prior.calibration.learn(&scan.measured, &motion);
            // The noise of the odometry within a scan bends its walls. The matched motion does not.
            if reading.scan.sweep_s > 0.0 {
                scan.points = self.deskew.update(&mut scan.reading, reading, &motion, scan.elapsed_s);
            }
        }
        self.matcher.insert(&scan, &self.track, &matched.found, context);
        Some((scan.reading, matched.found))
    }

    /// A reading deskewed along the motion by odometry.
    fn incoming(&mut self, reading: &LaserReading, fault: Option<Fault>) -> IncomingScan {
        let measured = self.motion_prior.measure(&reading.pose);
        let motion = self.motion_prior.motion(&measured, &self.track.last_motion);
        let elapsed_s = self.time_s.map_or(0.0, |last_s| reading.time_s - last_s);
        // A log can begin while the robot moves: before its first scan, no pose is known.
        let in_sweep =
            if self.time_s.is_none() { ScanPath::by_velocities(reading) } else { (motion.delta, elapsed_s) };
        let now_s = if fault.is_none() { reading.time_s } else { self.time_s.unwrap_or(reading.time_s) };
        self.time_s = Some(now_s);
        let mut deskewed = reading.clone();
        let points = self.deskew.update(&mut deskewed, reading, &in_sweep.0, in_sweep.1);
        let Track { pose, covariance, .. } = &self.track;
        let predicted = motion.predict(pose, covariance, reading.scan.sweep_s > 0.0);
        let has_odometry = self.motion_prior.exists;
        let reading = deskewed;
        IncomingScan { reading, points, fault, motion, predicted, measured, has_odometry, elapsed_s, now_s }
    }
}
