//! From the predicted pose to the pose of the scan, and the question whether the robot or the things moved.

use crate::changing_map::ChangingMap;
use crate::coherent::{are_apart, in_place};
use crate::matcher::{Match, difference};
use crate::motion::Predicted;
use crate::placement::Placement;
use crate::scene::Scene;
use crate::tracked::Tracked;
use nalgebra::{Isometry2, Matrix3, Vector3};

/// The innovation (squared, over its covariance) above which odometry did not tell the truth: 1 in 10⁵ by chance.
const SURPRISE: f64 = 26.0;
/// The farthest that a match may start from the pose, m: robots that slip or stand still against their odometry.
const WIDE_GATE_M: f64 = 0.3;
/// The least gain of support with which another pose replaces the predicted one.
const BETTER: f64 = 0.05;
/// Where this share of the points lies exactly in place and stands against every motion of the robot, the pose is that
/// of the odometry, though the rest moved as if the robot had moved.
const STAYED_SHARE: f64 = 0.012;
/// With a larger standard deviation of the predicted position (m), the odometry cannot say that the robot stayed: in a
/// narrow place, some points always lie in place by chance.
const VAGUE_M: f64 = 0.05;
/// The same where the rest does not fit any other pose, and the least support.
const ONLY_SHARE: f64 = 0.1;
const ONLY_SUPPORT: f64 = 0.5;
/// Errors of the map, which change where other surfaces come into view.
const MAP_STD_M: f64 = 0.002;
const MAP_STD_RAD: f64 = 7e-4;
/// The least weight of unchanged surfaces against every motion with which changing surfaces may be weighed down.
const UNCHANGED_WEIGHT: f64 = 15.0;

/// Finds the pose of a scan near the predicted pose. `others` are other guesses: the pose at rest, the pose at constant
/// velocity. If no guess gives a supported pose, the result is the match from the predicted pose.
pub(crate) fn track<M: ChangingMap>(
    scene: &Scene<M>,
    predicted: &Predicted,
    others: &[Isometry2<f64>],
) -> Tracked {
    let (by_odometry, is_surprise) = with_prior(scene, predicted);
    let is_good = |tracked: &Tracked| tracked.support.share() >= scene.settings.min_support;
    if is_good(&by_odometry) && !is_surprise {
        return in_place(scene, predicted, &by_odometry).unwrap_or(by_odometry);
    }
    let mut best = by_odometry;
    for start in std::iter::once(&predicted.pose).chain(others) {
        let Some(found) = scene.align(start, None, WIDE_GATE_M, false) else { continue };
        let candidate = Tracked::matched(scene, &found);
        if candidate.support.confirmed > best.support.confirmed + BETTER * by_odometry.support.weight() {
            best = candidate;
        }
    }
    if let Some(stayed) = in_place(scene, predicted, &best) {
        return stayed;
    }
    let unmoved = scene.tight().judge(&by_odometry.placement);
    let fixes_pose = |share: f64| unmoved.fixes_pose(share * unmoved.weight());
    let is_coherent = are_apart(&by_odometry.placement.pose, &best.placement.pose);
    if predicted.spread_m() <= VAGUE_M && is_coherent && fixes_pose(STAYED_SHARE) {
        let (unmoved, _) = with_prior(&scene.tight(), predicted);
        return Tracked { stayed: true, ..unmoved };
    }
    if is_good(&best) {
        return Tracked { is_other: true, ..best };
    }
    let is_enough = by_odometry.support.share() >= ONLY_SUPPORT && fixes_pose(ONLY_SHARE);
    Tracked { stayed: is_enough && !is_surprise, ..by_odometry }
}

/// The match with the prior of odometry, and whether the motion by odometry was not true.
fn with_prior<M: ChangingMap>(scene: &Scene<M>, predicted: &Predicted) -> (Tracked, bool) {
    let Predicted { pose, covariance, .. } = predicted;
    let stay = || {
        let placement = Placement::rigid(pose);
        let support = scene.judge(&placement);
        (Tracked::new(placement, [*covariance; 2], support), false)
    };
    let Some(prior) = predicted.prior() else { return stay() };
    // What has moved a little is out of reach from the start.
    let first_m = if scene.is_tight { scene.gate_m() } else { scene.gate_m() + 2.0 * predicted.spread_m() };
    let by_rates = unchanged_fix_pose(scene, pose);
    let Some(found) = scene.align(pose, Some(&prior), first_m.min(WIDE_GATE_M), by_rates) else {
        return stay();
    };
    (Tracked::matched(scene, &found), surprise(&found, pose, covariance) > SURPRISE)
}

/// How far the pose of the scan alone lies from the predicted pose: squared, over the covariance of both.
fn surprise(found: &Match, predicted: &Isometry2<f64>, covariance: &Matrix3<f64>) -> f64 {
    let Some(scan) = found.scan_information.try_inverse() else { return 0.0 };
    // The match with the prior went only a part of the way that the scan alone would have gone.
    let whole_way = scan * found.information * difference(&found.placement.pose, predicted);
    let map = Vector3::new(MAP_STD_M, MAP_STD_M, MAP_STD_RAD);
    let spread = covariance + scan + Matrix3::from_diagonal(&map.component_mul(&map));
    spread.try_inverse().map_or(0.0, |inverse| (whole_way.transpose() * inverse * whole_way)[0])
}

/// Whether changing surfaces may be weighed down: the others alone fix the pose. Otherwise a wrong pose could declare
/// all that contradicts it as changing.
fn unchanged_fix_pose<M: ChangingMap>(scene: &Scene<M>, pose: &Isometry2<f64>) -> bool {
    scene.surfels.knows_rates()
        && scene.judge(&Placement::rigid(pose)).steady.symmetric_eigenvalues().min() >= UNCHANGED_WEIGHT
}
