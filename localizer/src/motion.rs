//! The motion between two readings by odometry, and how far it can be trusted.

use crate::calibration::Calibration;
use crate::constants::{DISTRUST_SCANS, DISTRUSTED_STD, HARD_DRIFT, HARD_DRIFT_RADPM, MIN_MOTION};
use crate::matcher::{Begin, Prior, blocks, difference};
use crate::placement::shifted;
use interfaces::{Spread, heading_rad};
use nalgebra::{Isometry2, Matrix3, Vector3, Vector6};

/// Errors at rest: vibration, and rounding of the odometry.
const REST_STD: Spread = Spread { m: 2e-4, rad: 1e-4 };
/// Share of a motion that slips to the side.
const SLIP: f64 = 0.02;
/// The expected errors count as larger by this: what is the same from scan to scan would bend the map.
const PRIOR_FACTOR: f64 = 1.5;
/// A pose is elsewhere if it is farther from the pose prior than this, beyond its errors.
const ELSEWHERE: Spread = Spread::of_motion(0.3);
const ELSEWHERE_STDS: f64 = 4.0;

/// A motion in the frame of the robot before the motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub(crate) delta: Isometry2<f64>,
    /// The covariance of x, y and heading, in the frame of the robot before the motion.
    covariance: Matrix3<f64>,
}

impl Motion {
    /// A measured motion.
    pub(crate) fn new(delta: Isometry2<f64>) -> Self {
        let square = |x: f64| x * x;
        let (distance_m, turn_rad) = (delta.translation.vector.norm(), heading_rad(&delta).abs());
        let along = square(HARD_DRIFT * distance_m) + square(HARD_DRIFT) * distance_m;
        let heading = square(HARD_DRIFT * turn_rad)
            + square(HARD_DRIFT_RADPM * distance_m)
            + square(HARD_DRIFT) * (turn_rad + distance_m * HARD_DRIFT_RADPM);
        // An error of the heading on the way shifts the end of the way to the side.
        let across = heading * square(distance_m) / 3.0;
        // A robot that turns in place slips a little in every direction.
        let slip = square(REST_STD.m + SLIP * HARD_DRIFT * turn_rad);
        let covariance = Matrix3::from_diagonal(&Vector3::new(
            along + slip,
            across + square(SLIP * distance_m) + slip,
            heading + square(REST_STD.rad),
        ));
        Self { delta, covariance: covariance * (PRIOR_FACTOR * PRIOR_FACTOR) }
    }

    /// The same motion, of an odometry that cannot be trusted.
    pub(crate) fn distrusted(mut self) -> Self {
        self.covariance += DISTRUSTED_STD.covariance();
        self
    }

    /// The pose after the motion.
    pub(crate) fn apply(&self, pose: &Isometry2<f64>) -> Isometry2<f64> {
        let mut moved = pose * self.delta;
        moved.rotation.renormalize();
        moved
    }

    /// The pose after the motion from a pose with the given covariance, with its covariance; all in the frame of the map.
    pub(crate) fn predict(&self, at: &Isometry2<f64>, covariance: &Matrix3<f64>, sweeps: bool) -> Predicted {
        let (by_heading, own) = self.spread(at);
        let begin = if sweeps { begin(covariance, &by_heading, &own) } else { None };
        let covariance = by_heading * covariance * by_heading.transpose() + own;
        Predicted { pose: self.apply(at), covariance, begin }
    }

    /// The covariance after the motion from a pose with the given covariance; both in the frame of the map.
    pub(crate) fn propagate(&self, pose: &Isometry2<f64>, covariance: &Matrix3<f64>) -> Matrix3<f64> {
        let (by_heading, own) = self.spread(pose);
        by_heading * covariance * by_heading.transpose() + own
    }

    /// How an error of the pose before the motion becomes one of the pose after it, and the covariance of the motion in
    /// the frame of the map.
    fn spread(&self, pose: &Isometry2<f64>) -> (Matrix3<f64>, Matrix3<f64>) {
        let shift = pose.rotation * self.delta.translation.vector;
        // A heading error of the pose turns the motion.
        let by_heading = Matrix3::new(1.0, 0.0, -shift.y, 0.0, 1.0, shift.x, 0.0, 0.0, 1.0);
        let to_map = pose.rotation.to_homogeneous();
        (by_heading, to_map * self.covariance * to_map.transpose())
    }
}

/// The pose before a scan is seen, by odometry or by another source, in the frame of the map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Predicted {
    pub(crate) pose: Isometry2<f64>,
    pub(crate) covariance: Matrix3<f64>,
    /// For a scan that sweeps: what is known about the pose before the motion.
    begin: Option<Begin>,
}

impl Predicted {
    /// A pose about which nothing is known before the motion.
    pub(crate) fn rigid(pose: Isometry2<f64>, covariance: Matrix3<f64>) -> Self {
        Self { pose, covariance, begin: None }
    }

    /// How far the place of the begin has moved with the expected end: x, y (m) and heading (rad).
    pub(crate) fn begin_moved(&self) -> Vector3<f64> {
        self.begin.map_or(Vector3::zeros(), |begin| begin.moved)
    }

    /// The standard deviation of the position, m.
    pub(crate) fn spread_m(&self) -> f64 {
        (self.covariance[(0, 0)] + self.covariance[(1, 1)]).sqrt()
    }

    /// What is known about the pose, together with what another source says about it: the step of a Kalman filter.
    pub(crate) fn and(self, pose: &Isometry2<f64>, covariance: &Matrix3<f64>) -> Self {
        let Some(both) = (self.covariance + covariance).try_inverse() else { return self };
        let gain = self.covariance * both;
        let step = gain * difference(pose, &self.pose);
        let other = covariance.try_inverse().map(|information| (information, difference(pose, &self.pose)));
        let begin = self.begin.zip(other).and_then(|(begin, other)| begin.and_end(&other, &step));
        let mut both = Self { pose: shifted(&self.pose, &step), covariance: gain * covariance, begin };
        both.pose.rotation.renormalize();
        both
    }

    /// The prior of a match; `None` if the covariance cannot be inverted.
    pub(crate) fn prior(&self) -> Option<Prior> {
        Some(Prior { pose: self.pose, information: self.covariance.try_inverse()?, begin: self.begin })
    }

    /// Whether the robot may be at a pose.
    fn allows(&self, pose: &Isometry2<f64>) -> bool {
        let off = difference(pose, &self.pose);
        off.xy().norm() <= ELSEWHERE.m + ELSEWHERE_STDS * self.spread_m() && off.z.abs() <= ELSEWHERE.rad
    }

    /// The predicted pose, and what this pose of another source says.
    pub(crate) fn with(self, predicted: Self) -> Self {
        if self.allows(&predicted.pose) { predicted.and(&self.pose, &self.covariance) } else { self }
    }
}

impl Begin {
    /// What is known about the begin, together with what another source says about the end: its information, and how far it
    /// is from the expected end, which moves by `step`, and with it the place of the begin.
    fn and_end(
        &self,
        (information, off): &(Matrix3<f64>, Vector3<f64>),
        step: &Vector3<f64>,
    ) -> Option<Self> {
        let mut joint = self.joint;
        let mut of_end = joint.fixed_view_mut::<3, 3>(3, 3);
        of_end += information;
        let mut right = Vector6::zeros();
        right.fixed_rows_mut::<3>(3).copy_from(&(information * off));
        let begin = joint.cholesky()?.solve(&right).fixed_rows::<3>(0).into_owned();
        let moved = self.by_heading.try_inverse()? * step;
        Some(Self { joint, expected: begin - moved, moved, ..*self })
    }
}

/// What is known about a pose with `covariance` and the pose after a motion with the covariance `own`. `by_heading`: how
/// an error of the first becomes one of the second.
fn begin(covariance: &Matrix3<f64>, by_heading: &Matrix3<f64>, own: &Matrix3<f64>) -> Option<Begin> {
    let information = (covariance + REST_STD.covariance()).try_inverse()?;
    let motion = own.try_inverse()?;
    let cross = by_heading.transpose() * motion;
    let joint = blocks([[information + cross * by_heading, -cross], [-cross.transpose(), motion]]);
    let (expected, moved) = (Vector3::zeros(), Vector3::zeros());
    Some(Begin { information, joint, by_heading: *by_heading, expected, moved })
}

// The motion between two readings before the scan is seen: odometry with learned gains, as far as it can be trusted.

/// The odometry of a robot.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct MotionPrior {
    pub(crate) calibration: Calibration,
    /// The last valid odometry pose.
    last: Option<Isometry2<f64>>,
    /// The odometry pose from which a motion shows that there is an odometry: of a slow robot with a fast laser, no step between two
    /// readings does.
    #[serde(skip)]
    origin: Option<Isometry2<f64>>,
    /// Whether there is an odometry, as far as is known; it may not have moved yet.
    pub(crate) exists: bool,
    /// The number of scans for which the odometry is not trusted.
    distrust: u32,
}

impl MotionPrior {
    /// Forgets where the odometry was; what was learned about its gains stays.
    pub(crate) fn begin_session(&mut self) {
        (self.last, self.origin, self.distrust) = (None, None, 0);
    }

    /// The motion since the last reading, as the odometry measured it.
    pub(crate) fn measure(&mut self, odometry: &Isometry2<f64>) -> Isometry2<f64> {
        let measured = self.last.replace(*odometry).unwrap_or(*odometry).inv_mul(odometry);
        let since_origin = self.origin.get_or_insert(*odometry).inv_mul(odometry);
        self.exists |= !MIN_MOTION.contains(&since_origin);
        measured
    }

    /// The expected motion. Without odometry, the robot goes on as before.
    pub(crate) fn motion(&self, measured: &Isometry2<f64>, last_motion: &Isometry2<f64>) -> Motion {
        match self.exists {
            true if self.distrust == 0 => Motion::new(self.calibration.correct(measured)),
            true => Motion::new(self.calibration.correct(measured)).distrusted(),
            false => Motion::new(*last_motion).distrusted(),
        }
    }

    /// Learns from a supported scan whether the odometry can be trusted.
    pub(crate) fn judge(&mut self, is_outlier: bool) {
        self.distrust = if is_outlier { DISTRUST_SCANS } else { self.distrust.saturating_sub(1) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::pose;

    #[test]
    fn the_covariance_of_a_pose_turns_with_the_motion() {
        // The derivative of the pose after the motion, by finite differences.
        let (at, delta) = (pose(1.0, -2.0, 0.7), pose(0.4, 0.1, 0.3));
        let motion = Motion { delta, covariance: Matrix3::zeros() };
        let covariance = Matrix3::new(2.0, 0.3, 0.1, 0.3, 1.0, -0.2, 0.1, -0.2, 0.5);
        let values = |pose: &Isometry2<f64>| [pose.translation.x, pose.translation.y, heading_rad(pose)];
        let moved = |x, y, heading| values(&motion.apply(&pose(1.0 + x, -2.0 + y, 0.7 + heading)));
        let step = 1e-6;
        let columns = [moved(step, 0.0, 0.0), moved(0.0, step, 0.0), moved(0.0, 0.0, step)];
        let origin = values(&motion.apply(&at));
        let jacobian = Matrix3::from_fn(|row, column| (columns[column][row] - origin[row]) / step);
        let expected = jacobian * covariance * jacobian.transpose();
        let error = motion.propagate(&at, &covariance) - expected;
        assert!(error.abs().max() < 1e-4, "{error}");
    }

    #[test]
    fn another_source_of_the_end_says_something_about_the_begin() {
        let (at, motion) = (pose(1.0, -2.0, 0.7), Motion::new(pose(0.05, 0.0, 0.06)));
        let covariance = Matrix3::new(2.0, 0.3, 0.1, 0.3, 1.0, -0.2, 0.1, -0.2, 0.5) * 1e-4;
        let predicted = motion.predict(&at, &covariance, true);
        let off = Vector3::new(0.03, -0.02, 0.01);
        let (end, spread) = (shifted(&predicted.pose, &off), Matrix3::identity() * 2e-4);
        let both = predicted.and(&end, &spread);
        // The Kalman filter for begin and end together.
        let (by_heading, own) = motion.spread(&at);
        let of_end = by_heading * covariance * by_heading.transpose() + own;
        let inverse = (of_end + spread).try_inverse().unwrap();
        let begin = covariance * by_heading.transpose() * inverse * off;
        let step = of_end * inverse * off;
        assert!((difference(&both.pose, &predicted.pose) - step).norm() < 1e-9);
        let left = of_end - of_end * inverse * of_end;
        assert!((both.covariance - left).abs().max() < 1e-9);
        let found = both.prior().unwrap().begin.unwrap();
        // The rest at rest is added to the covariance of the begin.
        assert!((found.moved + found.expected - begin).norm() < 3e-4, "{found:?} {begin}");
        let joint = found.joint.try_inverse().unwrap();
        assert!((joint.fixed_view::<3, 3>(3, 3) - left).abs().max() < 1e-6, "{joint} {left}");
        assert!((by_heading * found.moved - step).norm() < 1e-9);
    }
}

#[cfg(test)]
mod motion_prior_tests {
    use super::*;
    use interfaces::pose;

    #[test]
    fn the_odometry_of_a_slow_robot_exists_and_that_of_a_standing_one_does_not() {
        let exists = |step_m: f64| {
            let mut prior = MotionPrior::default();
            for step in 0..100 {
                prior.measure(&pose(step_m * f64::from(step), 0.0, 0.0));
            }
            prior.exists
        };
        assert!(exists(0.001));
        assert!(!exists(0.0));
    }
}
