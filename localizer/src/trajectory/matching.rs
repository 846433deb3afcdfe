//! What matches of scans and of submaps share: gates, covariances, and what a match says.

use super::submap::{Agreement, agreement};
use crate::matcher::{Gates, Match, Prior, SURFEL_STD_M, align};
use crate::scan_points::ScanPoint;
use crate::surfel_map::SurfelMap;
use nalgebra::{Isometry2, Matrix3, Vector3};

/// Points match a surfel within this many standard deviations of the range noise and of the surfel.
const GATE_STDS: f64 = 3.0;
/// The farthest that a match starts from the prediction, m.
pub(super) const WIDEST_M: f64 = 0.4;
/// The least noise that is assumed, m: surfaces are not perfectly straight.
const LEAST_NOISE_M: f64 = 0.005;
/// The share of the information about a position that may come from normals that are a little off.
const SPURIOUS_SHARE: f64 = 0.03;
/// The uncertainty of a direction that no surface fixes, m and rad.
const LOOSE_M: f64 = 10.0;
const LOOSE_RAD: f64 = 1.0;

/// The gates of a match of scans with this noise.
pub(super) fn gates(noise_m: f64, first_m: f64) -> Gates {
    let noise_m = noise_m.max(LEAST_NOISE_M);
    let last_m = GATE_STDS * (noise_m * noise_m + SURFEL_STD_M * SURFEL_STD_M).sqrt();
    Gates { noise_m, first_m: first_m.min(WIDEST_M).max(last_m), last_m, by_rates: false }
}

/// The covariance of standard deviations of x and y, and of the heading.
pub(super) fn covariance(std_m: f64, std_rad: f64) -> Matrix3<f64> {
    Matrix3::from_diagonal(&Vector3::new(std_m * std_m, std_m * std_m, std_rad * std_rad))
}

/// An information matrix of shifts along the axes of a map, as one along the axes of a frame with this pose.
pub(super) fn in_frame(information: &Matrix3<f64>, frame: &Isometry2<f64>) -> Matrix3<f64> {
    let (cos, sin) = (frame.rotation.re, frame.rotation.im);
    let turn = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
    turn.transpose() * information * turn
}

/// At most a number of points, evenly taken.
pub(super) fn thinned(points: &[ScanPoint], most: usize) -> Vec<ScanPoint> {
    points.iter().step_by(points.len().div_ceil(most).max(1)).copied().collect()
}

/// Matches points with a map, from a pose that is uncertain by this much (m, rad).
pub(super) fn fit(
    map: &SurfelMap,
    points: &[ScanPoint],
    pose: &Isometry2<f64>,
    (std_m, std_rad): (f64, f64),
    noise_m: f64,
) -> Option<(Match, Agreement)> {
    let prior = Prior { pose: *pose, information: covariance(std_m, std_rad).try_inverse()? };
    let gates = gates(noise_m, std_m);
    let found = align(map, points, pose, Some(&prior), &gates)?;
    let agreement = agreement(map, points, &found.pose, gates.last_m);
    Some((found, agreement))
}

/// The information of a match, with the errors of the model (m, rad). Directions that the scan does not fix stay free:
/// of all that a scan says, a small share comes from normals that are a little off.
pub(super) fn information_of(found: &Match, std_m: f64, std_rad: f64) -> Option<Matrix3<f64>> {
    let scan = &found.scan_information;
    let off = SPURIOUS_SHARE * (scan[(0, 0)] + scan[(1, 1)]);
    let eigen = (scan - Matrix3::from_diagonal(&Vector3::new(off, off, 0.0))).symmetric_eigen();
    let values = eigen.eigenvalues.map(|value| value.max(0.0));
    let fixed = eigen.eigenvectors * Matrix3::from_diagonal(&values) * eigen.eigenvectors.transpose();
    let free = covariance(LOOSE_M, LOOSE_RAD).try_inverse()?;
    let spread = (fixed + free).try_inverse()? * found.residual_ratio.max(1.0);
    (spread + covariance(std_m, std_rad)).try_inverse()
}
