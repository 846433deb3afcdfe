//! The inverse sensor model: the evidence of a beam about the cells of the map.
//!
//! A log-odds grid adds constant evidence to the cell of the hit and to each cell that the beam crosses
//! ([`HIT_LOG_ODDS`], [`MISS_LOG_ODDS`]). A surface grid uses the position of the surface within the cell:
//! [`hit_point`] is the point inside the body to which a hit belongs, and [`passes`] states whether a scan
//! contradicts a surface.

use super::projection::ProjectedScan;
use super::segmentation::Segmentation;
use nalgebra::{Point2, Vector2};
use std::f64::consts::FRAC_1_SQRT_2;

/// Evidence of a hit for the cell of the hit, in log-odds: p = 0.7.
pub(super) const HIT_LOG_ODDS: f32 = 0.85;
/// Evidence of a beam for a cell that the beam crosses, in log-odds: p = 0.4.
pub(super) const MISS_LOG_ODDS: f32 = -0.4;

/// Range noise is assumed to be within this number of standard deviations. With three, one hit in 700 would be
/// outside, and a wall takes a hundred hits per scan.
pub(super) const NOISE_STDS: f64 = 4.0;

/// The point to which a hit belongs: `depth_m` behind the surface along its normal. At the edge of the visible
/// surface, the point is also equally far inward along the surface, since the body may end right behind the edge.
/// If a neighboring beam passes through that point (the normal led out of a corner), or if the surface has no normal
/// there, the point is half as deep along the beam.
pub(super) fn hit_point(
    beam: usize,
    end: &Point2<f64>,
    depth_m: f64,
    normal: Option<Vector2<f64>>,
    segmentation: &Segmentation,
    scan: &ProjectedScan,
) -> Point2<f64> {
    let along_beam = scan.directions[beam];
    let Some(normal) = normal else {
        return end + along_beam * (depth_m / 2.0);
    };
    let inward = segmentation.inward(beam, end, scan);
    let direction = inward.map_or(-normal, |inward| (inward - normal) * FRAC_1_SQRT_2);
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
/// beyond the point. Where the beams are farther apart than `max_gap_m`, a thin obstacle can be between them: then
/// one of the beams must pass the point within `reach_m`.
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
