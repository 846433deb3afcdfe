//! The inverse sensor model: the evidence of a beam about the cells of the map.
//!
//! A grid of log-odds takes a constant of evidence for the cell of the hit, and another for each cell that the beam
//! crosses ([`HIT_LOG_ODDS`], [`MISS_LOG_ODDS`]). A grid of surfaces asks where in the cell the surface is:
//! [`hit_point`] is the point inside the body to which a hit belongs, and [`passes`] says whether a scan
//! contradicts a surface.

use super::projection::ProjectedScan;
use super::segmentation::Segmentation;
use nalgebra::Point2;
use std::f64::consts::FRAC_1_SQRT_2;

/// Evidence of a hit for the cell of the hit, in log-odds: p = 0.7.
pub(super) const HIT_LOG_ODDS: f32 = 0.85;
/// Evidence of a beam for a cell that the beam crosses, in log-odds: p = 0.4.
pub(super) const MISS_LOG_ODDS: f32 = -0.4;

/// Range noise stays within this number of standard deviations. At three, one hit in 700 would not, and a
/// wall takes a hundred hits per scan.
pub(super) const NOISE_STDS: f64 = 4.0;

/// The point to which a hit belongs: `depth_m` behind the surface along its normal; at the edge of
/// the visible surface, equally far inward along the surface too, since the body may end
/// right behind the edge. Where a neighboring beam sees that point (the normal led out of a
/// corner), half as deep along the beam.
pub(super) fn hit_point(
    beam: usize,
    end: &Point2<f64>,
    depth_m: f64,
    segmentation: &Segmentation,
    scan: &ProjectedScan,
) -> Point2<f64> {
    let normal = segmentation.normal(beam, end, scan);
    let inward = segmentation.inward(beam, end, scan);
    let direction = inward.map_or(-normal, |inward| (inward - normal) * FRAC_1_SQRT_2);
    let along_beam = scan.directions[beam];
    let distance_m = scan.returns[beam].clear_m() + direction.dot(&along_beam) * depth_m;
    // From the beam to the direction of the point, in beams; the angle is small.
    let turn = along_beam.perp(&direction) * depth_m / (distance_m * scan.increment_rad);
    let beams = scan.len() as i32;
    let sees = |step: i32| {
        let at = (beam as i32 + step).rem_euclid(beams);
        scan.returns[at as usize].clear_m() > distance_m + depth_m / 2.0
    };
    let is_seen = turn.abs() < f64::from(beams - 1) && {
        let step = turn as i32 - i32::from(turn < 0.0);
        sees(step) || sees(step + 1)
    };
    end + if is_seen { along_beam * (depth_m / 2.0) } else { direction * depth_m }
}

/// Whether a scan passes through a surface at `point`: both beams that enclose the point go at least `margin_m`
/// beyond. Where the beams are farther apart than `max_gap_m` at the point, a thin obstacle can stand between them:
/// then one of them must go through the point, within `reach_m`.
pub(super) fn passes(
    scan: &ProjectedScan,
    point: &Point2<f64>,
    margin_m: f64,
    max_gap_m: f64,
    reach_m: f64,
) -> bool {
    let distance_m = (point - scan.origin).norm();
    let goes_beyond = |beam: usize| scan.returns[beam].clear_m() > distance_m + margin_m;
    let Some((left, right)) = scan.enclosing(point) else { return false };
    if scan.spacing_rad * distance_m <= max_gap_m {
        return goes_beyond(left) && goes_beyond(right);
    }
    [left, right].into_iter().any(|beam| {
        let off_m = scan.directions[beam].perp(&(point - scan.origin)).abs();
        goes_beyond(beam) && off_m <= reach_m
    })
}
