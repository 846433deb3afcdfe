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
        if self.ignores_guide {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::localizer::{Localizer, Motion};
    use crate::settings::LocalizerSettings;
    use crate::support::Support;
    use crate::verification::Verification;
    use interfaces::{CellState, Grid, GridFrame, Scan, Twist, pose};
    use nalgebra::Point2;

    /// A room of 6 m by 4 m with a corner cut out, as a laser at a pose sees it.
    fn reading(time_s: f64, at: &Isometry2<f64>, odometry: Isometry2<f64>) -> LaserReading {
        let walls = [
            (0.0, 0.0, 6.0, 0.0),
            (6.0, 0.0, 6.0, 2.5),
            (6.0, 2.5, 4.5, 2.5),
            (4.5, 2.5, 4.5, 4.0),
            (4.5, 4.0, 0.0, 4.0),
            (0.0, 4.0, 0.0, 0.0),
        ];
        let range = |beam: usize| {
            let angle = interfaces::heading_rad(at) + (beam as f64).to_radians();
            let (along, from) = (interfaces::rotation(angle) * nalgebra::Vector2::x(), at.translation.vector);
            let hit = walls.iter().filter_map(|&(x0, y0, x1, y1)| {
                let (start, side) =
                    (nalgebra::Vector2::new(x0, y0), nalgebra::Vector2::new(x1 - x0, y1 - y0));
                let across = along.perp(&side);
                let (range, share) =
                    ((start - from).perp(&side) / across, (start - from).perp(&along) / across);
                (range > 0.0 && (0.0..=1.0).contains(&share)).then_some(range)
            });
            hit.fold(f64::INFINITY, f64::min) as f32
        };
        LaserReading {
            time_s,
            pose: odometry,
            twist: Twist::STOP,
            velocities: Vec::new(),
            mount: Isometry2::identity(),
            scan: Scan {
                angle_min_rad: 0.0,
                angle_increment_rad: 1.0_f64.to_radians(),
                range_min_m: 0.05,
                range_max_m: 20.0,
                sweep_s: 0.0,
                ranges_m: (0..360).map(range).collect(),
            },
        }
    }

    #[test]
    fn a_guide_that_was_wrong_is_not_followed() {
        let frame = GridFrame::covering(Point2::new(-1.0, -1.0), 8.0, 6.0, 0.05).unwrap();
        let settings = LocalizerSettings::default();
        let start = pose(2.0, 2.0, 0.0);
        let mut localizer = Localizer::from_nothing(&settings, &frame, start).unwrap();
        let map = Grid::filled(frame, CellState::Free);
        for scan in 0..40 {
            localizer.localize(&reading(0.1 * f64::from(scan), &start, start), &map);
        }
        assert_eq!(localizer.state, PoseState::Tracking);
        // A pose near the guide turns out to be wrong.
        let wrong = Guide { pose: pose(3.2, 1.0, 1.0), covariance: Matrix3::identity() * 1e-6 };
        (localizer.guide, localizer.verification) = (Some(wrong), Some(Verification::default()));
        let contradicted = Support { contradicted: 100.0, ..Support::default() };
        let motion = Motion::new(Isometry2::identity(), &settings.odometry);
        localizer.verify(&contradicted, &motion, &reading(4.0, &start, start).scan);
        assert_eq!(localizer.state, PoseState::Lost);
        localizer.guide = None;
        // The robot has been carried, but not to where the guide says.
        let at = pose(1.3, 2.6, 0.4);
        let mut states = (40..60).map(|scan| {
            let reading = reading(0.1 * f64::from(scan), &at, start);
            localizer.localize_near(&reading, &map, wrong).estimate.state
        });
        assert!(states.any(|state| state == PoseState::Tracking));
        assert!(
            (localizer.pose.translation.vector - at.translation.vector).norm() < 0.02,
            "{}",
            localizer.pose
        );
        assert!(!localizer.ignores_guide);
    }
}
