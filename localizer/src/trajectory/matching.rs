//! What matches of scans and of submaps share: gates, covariances, and what a match says.

use super::submap::{Agreement, agreement};
use crate::constants::{JUDGED_M, MIN_NOISE_M, STDS};
use crate::match_scene::hit_std_m;
use crate::matcher::{Gates, Match, Prior, align, difference};
use crate::scan_points::ScanPoint;
use crate::surfel_map::SurfelMap;
use interfaces::Spread;
use nalgebra::{Isometry2, Matrix3, Vector3};

/// Contradiction to the odometry over its covariance that means nothing.
const EXPECTED: f64 = 4.0;
/// Share of the information that may come from normals that are a little off.
const SPURIOUS: f64 = 0.03;
/// Errors of a direction that no surface fixes.
const LOOSE_STD: Spread = Spread { m: 10.0, rad: 1.0 };

/// The gates of a match of scans with this noise.
pub(super) fn gates(noise_m: f64, first_m: f64) -> Gates {
    let noise_m = noise_m.max(MIN_NOISE_M);
    let last_m = STDS * hit_std_m(noise_m);
    Gates { noise_m, first_m: first_m.min(JUDGED_M).max(last_m), last_m, by_rates: false }
}

/// An information matrix of shifts along the axes of a map, as one along the axes of a frame with this pose.
pub(crate) fn in_frame(information: &Matrix3<f64>, frame: &Isometry2<f64>) -> Matrix3<f64> {
    let turn = frame.rotation.to_homogeneous();
    turn.transpose() * information * turn
}

/// Matches points with a map, from a pose that is uncertain by this much.
pub(super) fn fit(
    map: &SurfelMap,
    points: &[ScanPoint],
    pose: &Isometry2<f64>,
    std: Spread,
    noise_m: f64,
) -> Option<(Match, Agreement)> {
    let prior = Prior { pose: *pose, information: std.covariance().try_inverse()?, begin: None };
    let gates = gates(noise_m, std.m);
    let found = align(map, points, pose, Some(&prior), &gates)?;
    let agreement = agreement(map, points, &found.placement, gates.last_m);
    Some((found, agreement))
}

/// The information of a match, with the errors of submaps. Directions that the scan does not fix stay free:
/// of all that a scan says, a small share comes from normals that are a little off.
pub(super) fn information_of(found: &Match, std: Spread) -> Option<Matrix3<f64>> {
    let scan = &found.scan_information;
    let off = SPURIOUS * (scan[(0, 0)] + scan[(1, 1)]);
    let eigen = (scan - Matrix3::from_diagonal(&Vector3::new(off, off, 0.0))).symmetric_eigen();
    let values = eigen.eigenvalues.map(|value| value.max(0.0));
    let fixed = eigen.eigenvectors * Matrix3::from_diagonal(&values) * eigen.eigenvectors.transpose();
    let free = LOOSE_STD.covariance().try_inverse()?;
    let spread = (fixed + free).try_inverse()? * found.residual_ratio.max(1.0);
    (spread + std.covariance()).try_inverse()
}

/// The covariance of a motion between keyframes, from the motion by odometry with its covariance, and the information of
/// the scan. A match that contradicts the odometry can be wrong by as much.
pub(super) fn motion_spread(
    motion: &Isometry2<f64>,
    (measured, by_odometry): (&Isometry2<f64>, &Matrix3<f64>),
    scan: Option<&Matrix3<f64>>,
) -> Matrix3<f64> {
    let Some(information) = by_odometry.try_inverse() else { return *by_odometry };
    let spread = (information + scan.copied().unwrap_or_else(Matrix3::zeros)).try_inverse();
    let off = difference(motion, measured);
    let square = (off.transpose() * information * off)[0];
    let share = (1.0 - EXPECTED / square.max(EXPECTED)).max(0.0);
    spread.unwrap_or(*by_odometry) + off * off.transpose() * share
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point2, Vector2};
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Points on straight walls along x, 2 m apart, and on some more surfaces.
    fn corridor(more: &[(f64, f64, f64)]) -> Vec<ScanPoint> {
        let point = |(x, y, normal_rad): (f64, f64, f64)| {
            ScanPoint::new(Point2::new(x, y), interfaces::rotation(normal_rad) * Vector2::x())
        };
        // The normals are a little off, to both sides.
        let walls = (-40_i32..40).flat_map(|step| {
            let (x, off) = (0.1 * f64::from(step), 0.05 * f64::from(step.rem_euclid(3) - 1));
            [(x, 1.0, off - FRAC_PI_2), (x, -1.0, off + FRAC_PI_2)]
        });
        walls.chain(more.iter().copied()).map(point).collect()
    }

    fn information(points: &[ScanPoint]) -> Matrix3<f64> {
        let map = SurfelMap::of_points(points).unwrap();
        let (found, agreement) =
            fit(&map, points, &Isometry2::identity(), Spread { m: 0.3, rad: 0.05 }, 0.02).unwrap();
        assert!(agreement.share() > 0.99 && agreement.overlap() > 0.99);
        information_of(&found, Spread { m: 0.02, rad: 0.004 }).unwrap()
    }

    #[test]
    fn a_bare_corridor_does_not_fix_the_position_along_it() {
        let std_m = |information: &Matrix3<f64>| {
            let spread = information.try_inverse().unwrap();
            [spread[(0, 0)].sqrt(), spread[(1, 1)].sqrt()]
        };
        let [along_m, across_m] = std_m(&information(&corridor(&[])));
        assert!(along_m > 1.0 && across_m < 0.03, "{along_m} {across_m}");
        let end: Vec<(f64, f64, f64)> = (-9..10).map(|step| (4.0, 0.1 * f64::from(step), PI)).collect();
        let [along_m, _] = std_m(&information(&corridor(&end)));
        assert!(along_m < 0.03, "{along_m}");
    }
}
