//! A localizer with a guide: another source knows about where the robot is.

use super::Localizer;
use crate::changing_map::ChangingMap;
use crate::estimate::{Localized, PoseState};
use crate::hypotheses::Hypotheses;
use crate::matcher::difference;
use crate::motion::Predicted;
use interfaces::LaserReading;
use nalgebra::{Isometry2, Matrix3};

/// A pose is elsewhere if it is farther from the guide than this, m and rad, and than this many standard deviations.
const ELSEWHERE_M: f64 = 0.3;
const ELSEWHERE_RAD: f64 = 0.3;
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
        let off = difference(pose, &self.pose);
        off.xy().norm() <= ELSEWHERE_M + ELSEWHERE_STDS * std_m && off.z.abs() <= ELSEWHERE_RAD
    }
}

impl Localizer {
    /// Estimates the pose of a reading with a guide. The guide helps where the scans fit, but do not fix the pose well enough;
    /// and a robot with a guide is not lost: in a map that is not finished, a search would always find something that looks
    /// like the place.
    pub(crate) fn localize_near(
        &mut self,
        reading: &LaserReading,
        map: &impl ChangingMap,
        guide: Guide,
    ) -> Localized {
        if self.is_misled {
            return self.localize(reading, map);
        }
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
    pub(super) fn guided(&self, predicted: Predicted) -> Predicted {
        let Some(guide) = &self.guide else { return predicted };
        match guide.allows(&predicted.pose) {
            true => predicted.and(&guide.pose, &guide.covariance),
            false => Predicted::rigid(guide.pose, guide.covariance),
        }
    }
}
