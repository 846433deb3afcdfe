//! A localizer with a guide: another source knows about where the robot is.

use super::Localizer;
use crate::changing_map::ChangingMap;
use crate::estimate::{Localized, PoseState};
use crate::hypotheses::Hypotheses;
use crate::matcher::difference;
use crate::motion::Predicted;
use interfaces::LaserReading;
use nalgebra::{Isometry2, Matrix3};

/// A pose is elsewhere if it is farther from the guide than this, m, and than this many standard deviations.
const ELSEWHERE_M: f64 = 0.5;
const ELSEWHERE_STDS: f64 = 4.0;

/// Where the robot is by another source, in the frame of the map: a pose with its covariance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guide {
    pub(crate) pose: Isometry2<f64>,
    pub(crate) covariance: Matrix3<f64>,
}

impl Guide {
    /// Whether the robot may be at a pose.
    fn allows(&self, pose: &Isometry2<f64>) -> bool {
        let std_m = (self.covariance[(0, 0)] + self.covariance[(1, 1)]).sqrt();
        (pose.translation.vector - self.pose.translation.vector).norm() <= ELSEWHERE_M + ELSEWHERE_STDS * std_m
    }
}

impl Localizer {
    /// Estimates the pose of a reading after a pose that was not certain. The guide helps where the scans fit, but do not fix
    /// the pose well enough. A pose that a search has found elsewhere is not believed: in a map that is not finished,
    /// something always looks like the place.
    pub(crate) fn localize_near(
        &mut self,
        reading: &LaserReading,
        map: &impl ChangingMap,
        guide: Guide,
    ) -> Localized {
        if !self.hypotheses.is_empty() && !guide.allows(&self.pose) {
            self.hypotheses = Hypotheses::default();
            (self.pose, self.covariance, self.state) = (guide.pose, guide.covariance, PoseState::Uncertain);
        }
        self.guide = Some(guide).filter(|_| self.hypotheses.is_empty());
        let localized = self.localize(reading, map);
        self.guide = None;
        localized
    }

    /// Estimates the pose of a reading with a guide that knows all that comes later: the robot is not lost.
    pub(crate) fn localize_again(
        &mut self,
        reading: &LaserReading,
        map: &impl ChangingMap,
        guide: Guide,
    ) -> Localized {
        self.hypotheses = Hypotheses::default();
        if self.state == PoseState::Lost {
            self.state = PoseState::Uncertain;
        }
        self.guide = Some(guide);
        let localized = self.localize(reading, map);
        self.guide = None;
        localized
    }

    /// The predicted pose, and what the guide says.
    pub(super) fn guided(&self, mut predicted: Predicted) -> Predicted {
        let Some(guide) = &self.guide else { return predicted };
        // The gain of a Kalman filter.
        let Some(both) = (predicted.covariance + guide.covariance).try_inverse() else { return predicted };
        let gain = predicted.covariance * both;
        let step = gain * difference(&guide.pose, &predicted.pose);
        predicted.pose.translation.vector += step.xy();
        predicted.pose.rotation = interfaces::rotation(step.z) * predicted.pose.rotation;
        predicted.pose.rotation.renormalize();
        predicted.covariance = gain * guide.covariance;
        predicted
    }
}
