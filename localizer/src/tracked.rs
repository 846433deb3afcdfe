//! The pose of a scan, as tracking has found it.

use crate::changing_map::ChangingMap;
use crate::matcher::Match;
use crate::placement::Placement;
use crate::scene::Scene;
use crate::support::Support;
use nalgebra::{Matrix3, Vector3};

/// Errors of the model that do not average out: surfaces that are not straight, surfels that are off. Per scan.
const MODEL_STD_M: f64 = 5e-4;
const MODEL_STD_RAD: f64 = 1.5e-4;

/// The pose of a scan by tracking.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tracked {
    pub(crate) placement: Placement,
    pub(crate) covariance: Matrix3<f64>,
    /// The covariance of the pose of a beam, in the mean over the scan.
    pub(crate) beam_covariance: Matrix3<f64>,
    pub(crate) support: Support,
    /// Much of the view may have moved, but the robot moved as its odometry says: what stayed in place fixes the pose.
    pub(crate) stayed: bool,
    /// Most of the view shifted: where the scan would lie if it had not.
    pub(crate) shifted: Option<Placement>,
    /// The robot did not move as its odometry says.
    pub(crate) is_other: bool,
}

impl Tracked {
    /// The pose by the odometry or a match. `covariances`: of the pose, and of the pose of a beam.
    pub(crate) fn new(placement: Placement, covariances: [Matrix3<f64>; 2], support: Support) -> Self {
        let [covariance, beam_covariance] = covariances;
        Self { placement, covariance, beam_covariance, support, stayed: false, shifted: None, is_other: false }
    }

    /// The result of a match, with an honest covariance: inflated where the residuals are larger than the noise, and by the
    /// errors that all points share.
    pub(crate) fn matched<M: ChangingMap>(scene: &Scene<M>, found: &Match) -> Self {
        let inverse = found.information.try_inverse().unwrap_or_else(|| Matrix3::identity() * 1e3);
        let model = Vector3::new(MODEL_STD_M, MODEL_STD_M, MODEL_STD_RAD);
        let honest = |covariance: Matrix3<f64>| {
            covariance * found.residual_ratio.max(1.0) + Matrix3::from_diagonal(&model.component_mul(&model))
        };
        let covariances = [inverse, found.beam_covariance].map(honest);
        Self::new(found.placement, covariances, scene.judge(&found.placement))
    }
}
