//! A localizer that reads again what it has read before, with better poses from elsewhere.

use super::Localizer;
use crate::changing_map::ChangingMap;
use crate::estimate::{Localized, PoseState};
use crate::hypotheses::Hypotheses;
use crate::matcher::difference;
use crate::motion::Predicted;
use interfaces::LaserReading;
use nalgebra::{Isometry2, Matrix3, Vector3};

/// The errors of a guide, m and rad. They stay the same for many scans: a single scan must follow the line map, and many
/// must follow the guide.
const GUIDE_STD_M: f64 = 0.01;
const GUIDE_STD_RAD: f64 = 0.003;

impl Localizer {
    /// Estimates the pose of a reading that is known to be near `guide`.
    pub(crate) fn localize_near(
        &mut self,
        reading: &LaserReading,
        map: &impl ChangingMap,
        guide: &Isometry2<f64>,
    ) -> Localized {
        // A robot with a guide is never lost.
        self.hypotheses = Hypotheses::default();
        if self.state == PoseState::Lost {
            self.state = PoseState::Uncertain;
        }
        self.guide = Some(*guide);
        let localized = self.localize(reading, map);
        self.guide = None;
        localized
    }

    /// The predicted pose, and what the guide says.
    pub(super) fn guided(&self, mut predicted: Predicted) -> Predicted {
        let Some(guide) = &self.guide else { return predicted };
        let std = Vector3::new(GUIDE_STD_M, GUIDE_STD_M, GUIDE_STD_RAD);
        let spread = Matrix3::from_diagonal(&std.component_mul(&std));
        // The gain of a Kalman filter: the prediction can be far more certain than the guide.
        let Some(gain) = (predicted.covariance + spread).try_inverse() else { return predicted };
        let gain = predicted.covariance * gain;
        let step = gain * difference(guide, &predicted.pose);
        predicted.pose.translation.vector += step.xy();
        predicted.pose.rotation = interfaces::rotation(step.z) * predicted.pose.rotation;
        predicted.pose.rotation.renormalize();
        predicted.covariance = (Matrix3::identity() - gain) * predicted.covariance;
        predicted
    }
}
