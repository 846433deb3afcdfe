use crate::matcher::difference;
use crate::motion::Predicted;
use crate::spread::Spread;
use nalgebra::{Isometry2, Matrix3};

/// A pose is elsewhere if it is farther from the pose prior than this, beyond its errors.
const ELSEWHERE: Spread = Spread::of_motion(0.3);
const ELSEWHERE_STDS: f64 = 4.0;

/// Where the robot is by another source, in the frame of the map: a pose with its covariance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PosePrior {
    pub(crate) pose: Isometry2<f64>,
    pub(crate) covariance: Matrix3<f64>,
}

impl PosePrior {
    /// Whether the robot may be at a pose.
    fn allows(&self, pose: &Isometry2<f64>) -> bool {
        let std_m = (self.covariance[(0, 0)] + self.covariance[(1, 1)]).sqrt();
        let off = difference(pose, &self.pose);
        off.xy().norm() <= ELSEWHERE.m + ELSEWHERE_STDS * std_m && off.z.abs() <= ELSEWHERE.rad
    }

    /// The predicted pose, and what the prior says.
    pub(crate) fn with(&self, predicted: Predicted) -> Predicted {
        match self.allows(&predicted.pose) {
            true => predicted.and(&self.pose, &self.covariance),
            false => Predicted::rigid(self.pose, self.covariance),
        }
    }
}
