//! Learns the systematic errors of odometry from the estimated motions: the gains of distance and turn, and the turn per
//! meter. A prior with a bias bends the map that grows ahead of the robot.
//!
//! Recursive least squares with forgetting (Ljung 1999, section 11.2): the errors of wheels change with the floor, the
//! load and the air in the tires.

use crate::constants::{HARD_DRIFT, HARD_DRIFT_RADPM};
use interfaces::{Spread, heading_rad};
use nalgebra::{Isometry2, Matrix2, Vector2};

/// The gains are learned from about this many motions: the floor and the load change.
const LEARNED_MOTIONS: f64 = 300.0;
/// Minimum motion that says something about the gains.
const LEARNED_MOTION: Spread = Spread { m: 0.01, rad: 0.005 };
/// Errors of a matched motion, from scan to scan and between keyframes: those of two matches.
const MOTION_STD: Spread = Spread { m: 0.004, rad: 0.002 };

/// The learned systematic errors.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(crate) struct Calibration {
    /// The true distance per measured distance, and its variance.
    pub(crate) distance: (f64, f64),
    /// The true turn per measured turn, and per measured distance (rad/m), and their covariance.
    turn: (Vector2<f64>, Matrix2<f64>),
}

/// The variances of the gains before anything was learned, which they never exceed: of the turn, also per measured distance.
const DISTANCE_VARIANCE: f64 = HARD_DRIFT * HARD_DRIFT;
const TURN_VARIANCES: [f64; 2] = [DISTANCE_VARIANCE, HARD_DRIFT_RADPM * HARD_DRIFT_RADPM];

impl Default for Calibration {
    fn default() -> Self {
        let turn = (Vector2::new(1.0, 0.0), Matrix2::from_diagonal(&TURN_VARIANCES.into()));
        Self { distance: (1.0, DISTANCE_VARIANCE), turn }
    }
}

impl Calibration {
    /// The motion that a measured motion means.
    pub(crate) fn correct(&self, measured: &Isometry2<f64>) -> Isometry2<f64> {
        let at = measured.translation.vector * self.distance.0;
        let turn_rad = self.features(measured).dot(&self.turn.0);
        // The motion is an arc: a turn that was missed bends it, half of the turn at its middle.
        let bend = interfaces::rotation((turn_rad - heading_rad(measured)) / 2.0) * at;
        interfaces::pose(bend.x, bend.y, turn_rad)
    }

    /// The measured turn, and the measured distance forward.
    fn features(&self, measured: &Isometry2<f64>) -> Vector2<f64> {
        Vector2::new(heading_rad(measured), measured.translation.x)
    }

    /// Learns from a measured motion, and the motion that was estimated with the help of scans.
    pub(crate) fn learn(&mut self, measured: &Isometry2<f64>, estimated: &Isometry2<f64>) {
        let square = |x: f64| x * x;
        let (distance_m, turn_rad) = (measured.translation.vector.norm(), heading_rad(measured).abs());
        let memory = 1.0 - 1.0 / LEARNED_MOTIONS;
        if distance_m >= LEARNED_MOTION.m {
            let noise = square(MOTION_STD.m) + square(HARD_DRIFT) * distance_m;
            let (gain, variance) = &mut self.distance;
            *variance = (*variance / memory).min(DISTANCE_VARIANCE);
            let k = *variance * distance_m / (noise + *variance * square(distance_m));
            let along_m = estimated.translation.vector.dot(&measured.translation.vector) / distance_m;
            *gain += k * (along_m - *gain * distance_m);
            *variance *= 1.0 - k * distance_m;
        }
        if distance_m >= LEARNED_MOTION.m || turn_rad >= LEARNED_MOTION.rad {
            let x = self.features(measured);
            let noise = square(MOTION_STD.rad) + square(HARD_DRIFT) * turn_rad;
            let (gains, covariance) = &mut self.turn;
            *covariance /= memory;
            // What was never excited must not grow without a limit.
            for (index, most) in TURN_VARIANCES.into_iter().enumerate() {
                if covariance[(index, index)] > most {
                    let scale = (most / covariance[(index, index)]).sqrt();
                    for other in 0..2 {
                        covariance[(index, other)] *= scale;
                        covariance[(other, index)] *= scale;
                    }
                }
            }
            let spread = *covariance * x;
            let k = spread / (noise + x.dot(&spread));
            *gains += k * (heading_rad(estimated) - gains.dot(&x));
            // Joseph's form stays symmetric and positive. `covariance - k * spread^T` does not: forgetting lets the rounding
            // errors that are not symmetric grow, and after half an hour the gains with them.
            let left = Matrix2::identity() - k * x.transpose();
            let next = left * *covariance * left.transpose() + k * k.transpose() * noise;
            *covariance = (next + next.transpose()) / 2.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Purpose, RandomStream, pose};

    #[test]
    fn systematic_errors_are_learned_and_undone() {
        let mut calibration = Calibration::default();
        let truth = |step: u32| pose(0.05, 0.0, if step % 40 < 20 { 0.03 } else { -0.06 });
        let measured = |step: u32| {
            let turn = heading_rad(&truth(step)) * 0.95 + 0.05 * 0.05;
            pose(0.05 * 1.05, 0.0, turn)
        };
        for step in 0..1000 {
            calibration.learn(&measured(step), &truth(step));
        }
        for step in [0, 30] {
            let error = truth(step).inv_mul(&calibration.correct(&measured(step)));
            assert!(error.translation.vector.norm() < 1e-3, "{error}");
            assert!(heading_rad(&error).abs() < 2e-4, "{error}");
        }
    }

    #[test]
    fn hours_of_driving_change_nothing() {
        let mut calibration = Calibration::default();
        let mut random = RandomStream::new(1, Purpose::OdometryNoise(0));
        let mut signed = || random.uniform(-1.0..1.0);
        for _ in 0..200_000 {
            let truth = pose(0.03 * signed().max(0.0), 0.0, 0.1 * signed());
            let seen =
                pose(truth.translation.x + 1e-3 * signed(), 0.0, heading_rad(&truth) + 1e-3 * signed());
            calibration.learn(&truth, &seen);
            let error = truth.inv_mul(&calibration.correct(&truth));
            assert!(error.translation.vector.norm() < 1e-3, "{error}");
            assert!(heading_rad(&error).abs() < 1e-3, "{error}");
        }
    }
}
