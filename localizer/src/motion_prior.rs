//! The motion between two readings before the scan is seen: odometry with learned gains, as far as it can be trusted.

use crate::calibration::Calibration;
use crate::constants::{DISTRUST_SCANS, MIN_MOTION};
use crate::motion::Motion;
use nalgebra::Isometry2;

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
