//! From the predicted pose to the pose of the scan, and the question whether the robot or the things moved.

use crate::coherent_motion::{Stayed, stayed};
use crate::constants::{MAJORITY, MIN_SUPPORT, MINOR, MOVED_SHARE, WIDE_GATE_M};
use crate::match_scene::MatchScene;
use crate::matcher::{Match, difference};
use crate::motion::Predicted;
use crate::placement::Placement;
use crate::support::Support;
use interfaces::Spread;
use nalgebra::{Isometry2, Matrix3};

/// Innovation over its covariance above which the odometry is an outlier: 1 in 10⁵ by chance.
const OUTLIER: f64 = 26.0;
/// A match without odometry slides at most this far from its start, m.
const MAX_SLIDE_M: f64 = 0.5;
/// Minimum gain of support with which another pose replaces the predicted one.
const BETTER: f64 = 0.05;
/// Errors of the map where other surfaces come into view.
const MAP_STD: Spread = Spread { m: 0.002, rad: 7e-4 };
/// Errors of a match that do not average out, per scan: surfaces that are not straight.
const MODEL_STD: Spread = Spread { m: 5e-4, rad: 1.5e-4 };

/// The pose of a scan by tracking.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tracked {
    pub(crate) placement: Placement,
    pub(crate) covariance: Matrix3<f64>,
    /// The covariance of the pose of a beam, in the mean over the scan.
    pub(crate) beam_covariance: Matrix3<f64>,
    pub(crate) support: Support,
    /// What lies in place fixes the pose, though much of the view does not.
    pub(crate) stayed: bool,
    /// If much of the view has moved, and the robot as its odometry says: the pose of a robot that follows the view.
    pub(crate) follower: Option<Isometry2<f64>>,
    /// The robot did not move as its odometry says.
    pub(crate) is_other: bool,
}

impl Tracked {
    /// The pose by the odometry or a match. `covariances`: of the pose, and of the pose of a beam.
    pub(crate) fn new(placement: Placement, covariances: [Matrix3<f64>; 2], support: Support) -> Self {
        let [covariance, beam_covariance] = covariances;
        Self {
            placement,
            covariance,
            beam_covariance,
            support,
            stayed: false,
            follower: None,
            is_other: false,
        }
    }
}

/// Finds the pose of a scan near the predicted pose. `others` are other guesses: the pose at rest, the pose at constant
/// velocity. If no guess gives a supported pose, the result is the match from the predicted pose.
pub(crate) fn track(scene: &MatchScene, predicted: &Predicted, others: &[Isometry2<f64>]) -> Tracked {
    let (by_odometry, is_surprise) = with_prior(scene, predicted);
    let is_good = |tracked: &Tracked| tracked.support.share() >= MIN_SUPPORT;
    let is_plain = is_good(&by_odometry) && !is_surprise;
    if is_plain && by_odometry.support.displaced_share() < MOVED_SHARE {
        return by_odometry;
    }
    let mut best = by_odometry;
    for start in std::iter::once(&predicted.pose).chain(others) {
        let Some(found) = scene.align(start, None, WIDE_GATE_M, false) else { continue };
        if difference(&found.placement.pose, start).xy().norm() > MAX_SLIDE_M {
            continue;
        }
        let candidate = tracked(scene, &found);
        let min_confirmed = best.support.confirmed + BETTER * by_odometry.support.weight();
        if candidate.support.score() >= MAJORITY && candidate.support.confirmed > min_confirmed {
            best = candidate;
        }
    }
    if let Some(Stayed { found, follower }) = stayed(scene, predicted, &best.placement)
        && (follower.is_some() || !is_plain)
    {
        return Tracked { stayed: true, follower, ..tracked(scene, &found) };
    }
    if is_plain {
        return by_odometry;
    }
    if is_good(&best) {
        return Tracked { is_other: true, ..best };
    }
    let in_place = scene.tight().judge(&by_odometry.placement);
    let stayed = by_odometry.support.share() >= MAJORITY && in_place.fixes_pose(MINOR * in_place.weight());
    Tracked { stayed: stayed && !is_surprise, ..by_odometry }
}

/// The match with the prior of odometry, and whether the motion by odometry was not true.
fn with_prior(scene: &MatchScene, predicted: &Predicted) -> (Tracked, bool) {
    let Predicted { pose, covariance, .. } = predicted;
    let stay = || {
        let placement = Placement::rigid(pose);
        let support = scene.judge(&placement);
        (Tracked::new(placement, [*covariance; 2], support), false)
    };
    let Some(prior) = predicted.prior() else { return stay() };
    // What has moved a little is out of reach from the start.
    let first_m = if scene.is_tight { scene.gate_m() } else { scene.gate_m() + 2.0 * predicted.spread_m() };
    let Some(found) = scene.align(pose, Some(&prior), first_m.min(WIDE_GATE_M), false) else {
        return stay();
    };
    (tracked(scene, &found), surprise(&found, pose, covariance) > OUTLIER)
}

/// How far the pose of the scan alone lies from the predicted pose: squared, over the covariance of both.
fn surprise(found: &Match, predicted: &Isometry2<f64>, covariance: &Matrix3<f64>) -> f64 {
    let Some(scan) = found.scan_information.try_inverse() else { return 0.0 };
    // The match with the prior went only a part of the way that the scan alone would have gone.
    let whole_way = scan * found.information * difference(&found.placement.pose, predicted);
    let spread = covariance + scan + MAP_STD.covariance();
    spread.try_inverse().map_or(0.0, |inverse| (whole_way.transpose() * inverse * whole_way)[0])
}

/// The result of a match, with an honest covariance: inflated where the residuals are larger than the noise, and by the
/// errors that all points share.
fn tracked(scene: &MatchScene, found: &Match) -> Tracked {
    let inverse = found.information.try_inverse().unwrap_or_else(|| Matrix3::identity() * 1e3);
    let honest =
        |covariance: Matrix3<f64>| covariance * found.residual_ratio.max(1.0) + MODEL_STD.covariance();
    let covariances = [inverse, found.beam_covariance].map(honest);
    Tracked::new(found.placement, covariances, scene.judge(&found.placement))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constants::USABLE_SCANS;
    use crate::scan_points::ScanPoint;
    use crate::settings::LocalizerSettings;
    use crate::support::ClearBeams;
    use crate::surfel_map::SurfelMap;
    use interfaces::{CellState, Grid, GridFrame, pose, rotation};
    use nalgebra::{Point2, Vector2};

    fn line(from: Point2<f64>, angle_rad: f64, normal_y: f64, count: usize) -> Vec<ScanPoint> {
        let along = rotation(angle_rad) * Vector2::x();
        let normal = rotation(angle_rad) * Vector2::new(0.0, normal_y);
        let point =
            |beam: usize| ScanPoint { beam, ..ScanPoint::new(from + along * (0.1 * beam as f64), normal) };
        (0..count).map(point).collect()
    }

    #[test]
    fn walls_along_which_a_match_slides_are_no_other_pose() {
        let frame = GridFrame::covering(Point2::new(-10.0, -2.0), 20.0, 10.0, 0.05).unwrap();
        let mut surfels = SurfelMap::new(&frame);
        // Two walls of a corridor that is a little wider at one end: their distance fixes the place along it.
        let mut walls = line(Point2::new(-9.0, 0.0), 0.0, 1.0, 180);
        walls.extend(line(Point2::new(-9.0, 2.0), 0.02, -1.0, 180));
        surfels.learn(&walls, &Isometry2::identity(), 0.01, USABLE_SCANS, false);
        // The scan of another place, 6 cm wider, and much that the map does not know.
        let mut points = line(Point2::new(-1.0, -1.0), 0.0, 1.0, 15);
        points.extend(line(Point2::new(-1.0, 1.2 + 0.06), 0.02, -1.0, 15));
        points.extend(line(Point2::new(-2.0, 4.0), 0.0, -1.0, 60));
        // The map knows the corridor as free, and nothing beyond it.
        let mut map = Grid::filled(frame, CellState::Unknown);
        let known = map.frame().len() / 2;
        (0..known).for_each(|index| map.cells_mut()[index] = CellState::Free);
        let (settings, clear) = (LocalizerSettings::default(), ClearBeams::default());
        let scene = MatchScene {
            surfels: &surfels,
            states: &map,
            points: &points,
            clear: &clear,
            mount: Isometry2::identity(),
            settings: &settings,
            is_tight: false,
        };
        let start = pose(0.0, 1.2, 0.0);
        let slid = scene.align(&start, None, WIDE_GATE_M, false).unwrap();
        assert!(slid.placement.pose.translation.x > 1.0, "the walls do not slide: {}", slid.placement.pose);
        let covariance = Matrix3::from_diagonal(&nalgebra::Vector3::new(1e-6, 1e-6, 1e-6));
        let tracked = track(&scene, &Predicted::rigid(start, covariance), &[]);
        assert!(!tracked.is_other, "{}", tracked.placement.pose);
        assert!((tracked.placement.pose.translation.vector - start.translation.vector).norm() < 0.3);
    }
}
