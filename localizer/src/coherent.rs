//! Most of the view shifts at once: the things moved, or the robot.
//!
//! Where the robot moved otherwise than its odometry says, all surfaces that stand lie in place again at another pose. Where
//! the things moved together, some surfaces are left over that lie in place at the pose of the odometry, and nowhere else.

use crate::changing_map::ChangingMap;
use crate::matcher::{Prior, difference};
use crate::motion::Predicted;
use crate::placement::Placement;
use crate::scan_points::ScanPoint;
use crate::scene::Scene;
use crate::tracked::Tracked;
use interfaces::heading_rad;
use nalgebra::{Isometry2, Matrix2, Vector2};

/// Shifts below this are no coherent motion of things, m.
const COHERENT_M: f64 = 0.03;
/// A point is left over if it is farther than this from every surface of the map, m: more than the noise explains.
const LEFT_STDS: f64 = 2.5;
/// Things that shift together shift by up to this, m: points that are farther from every surface are new things.
const SHIFT_M: f64 = 0.12;
/// The least weight of the points left over that lie in place, and that stand against the shift: 24 cm of wall.
const LEAST_WEIGHT: f64 = 6.0;
/// The same as a share of the weight of the scan.
const LEAST_SHARE: f64 = 0.03;
/// The least share of the points left over that lie in place.
const IN_PLACE_SHARE: f64 = 0.5;
/// How much nearer (squared, over the covariance) to the odometry the pose must be at which they lie in place.
const NEARER: f64 = 4.0;
/// Distances from a surface that differ by less are the same, m.
const SAME_M: f64 = 0.002;
/// Of a shift, the part across the surface that a point must show, m.
const SHOWN_M: f64 = 0.02;

/// Whether two poses are as far apart as things that move together.
pub(crate) fn are_apart(a: &Isometry2<f64>, b: &Isometry2<f64>) -> bool {
    let shift = a.inv_mul(b);
    shift.translation.vector.norm() + heading_rad(&shift).abs() >= COHERENT_M
}

/// The pose of a robot that moved as its odometry says, though most of the view lies at the pose `moved`; `None` if the
/// robot was where most of the view says.
pub(crate) fn in_place<M: ChangingMap>(
    scene: &Scene<M>,
    predicted: &Predicted,
    moved: &Tracked,
) -> Option<Tracked> {
    let shift = moved.placement.pose;
    if !are_apart(&predicted.pose, &shift) {
        return None;
    }
    let left = left_over(scene, &moved.placement);
    let weight = |points: &[ScanPoint]| points.iter().map(|point| point.weight).sum::<f64>();
    let least = LEAST_WEIGHT.max(LEAST_SHARE * moved.support.weight()).max(IN_PLACE_SHARE * weight(&left));
    if weight(&left) < least {
        return None;
    }
    let tight = scene.tight();
    let prior = Prior { begin: None, ..predicted.prior()? };
    let first_m = (tight.gate_m() + 2.5 * predicted.spread_m()).min(SHIFT_M);
    let stayed = Scene { points: &left, ..tight }.align(&predicted.pose, Some(&prior), first_m, false)?;
    let confirmed: Vec<ScanPoint> =
        left.iter().filter(|point| off_m(&tight, point, &stayed.placement).is_finite()).copied().collect();
    let distance = |pose: &Isometry2<f64>| {
        let off = difference(pose, &predicted.pose);
        off.dot(&(prior.information * off))
    };
    let by = shift.translation.vector - stayed.placement.pose.translation.vector;
    let is_in_place = weight(&confirmed) >= least
        && shows(&confirmed, &stayed.placement, &by)
        && are_apart(&stayed.placement.pose, &shift)
        && distance(&stayed.placement.pose) + NEARER < distance(&shift);
    if !is_in_place {
        return None;
    }
    let unmoved: Vec<ScanPoint> = scene
        .points
        .iter()
        .filter(|point| {
            let here_m = off_m(&tight, point, &stayed.placement);
            here_m.is_finite() && here_m < off_m(&tight, point, &moved.placement) + SAME_M
        })
        .copied()
        .collect();
    let found = Scene { points: &unmoved, ..tight }.align(&stayed.placement.pose, Some(&prior), 0.0, false)?;
    Some(Tracked { stayed: true, shifted: Some(moved.placement), ..Tracked::matched(&tight, &found) })
}

/// The points near surfaces of the map that lie on none.
fn left_over<M: ChangingMap>(scene: &Scene<M>, placement: &Placement) -> Vec<ScanPoint> {
    let least_m = LEFT_STDS * scene.noise_m();
    let is_left = |point: &&ScanPoint| {
        nearest_m(scene, point, placement, SHIFT_M).is_some()
            && nearest_m(scene, point, placement, least_m).is_none()
    };
    scene.points.iter().filter(is_left).copied().collect()
}

/// Whether points at a placement stand against a shift.
fn shows(points: &[ScanPoint], placement: &Placement, shift: &Vector2<f64>) -> bool {
    let against = |point: &ScanPoint| {
        let normal = placement.pose.rotation * point.normal;
        (normal * normal.transpose()) * point.weight
    };
    let information = points.iter().map(against).sum::<Matrix2<f64>>();
    let length_m = shift.norm();
    let along = shift / length_m.max(1e-9);
    length_m < SHOWN_M || along.dot(&(information * along)) >= LEAST_WEIGHT / 2.0
}

/// The distance of a point from its surface at a placement, m; infinite if it lies on none.
fn off_m<M: ChangingMap>(scene: &Scene<M>, point: &ScanPoint, placement: &Placement) -> f64 {
    nearest_m(scene, point, placement, scene.gate_m()).unwrap_or(f64::INFINITY)
}

fn nearest_m<M: ChangingMap>(
    scene: &Scene<M>,
    point: &ScanPoint,
    placement: &Placement,
    gate_m: f64,
) -> Option<f64> {
    let normal = placement.pose.rotation * point.normal;
    let nearest = scene.surfels.nearest(&placement.place(point), &normal, gate_m);
    nearest.filter(|(index, _)| scene.surfels.surfel(*index).weight() > 0.0).map(|(_, off_m)| off_m.abs())
}
