//! Submaps: line maps of some consecutive keyframes.

use crate::constants::{JUDGED_M, MIN_NOISE_M, SAME_SURFACE, STDS, SUBMAP_REACH_M, SURFEL_M, USABLE_SCANS};
use crate::match_scene::hit_std_m;
use crate::matcher::{Gates, Match, Prior, align, difference};
use crate::placement::Placement;
use crate::scan_points::ScanPoint;
use crate::surfel_map::SurfelMap;
use interfaces::{GridFrame, Scan, Spread};
use nalgebra::{Isometry2, Matrix3, Point2, Vector2, Vector3};

/// A submap to which keyframes are added, in the frame of the matches with local submaps.
#[derive(Clone, Debug)]
pub(super) struct GrowingSubmap {
    pub(super) map: SurfelMap,
    /// The numbers of the keyframes.
    pub(super) keyframes: Vec<usize>,
}

/// A submap with all of its keyframes.
#[derive(Clone, Debug)]
pub(super) struct FinishedSubmap {
    /// The keyframe in whose frame the points are: the middle one.
    pub(super) anchor: usize,
    /// The first and the last keyframe.
    pub(super) first: usize,
    pub(super) last: usize,
    /// The surfaces.
    pub(super) points: Vec<ScanPoint>,
}

impl GrowingSubmap {
    /// An empty submap around a pose.
    pub(super) fn new(around: &Isometry2<f64>) -> Option<Self> {
        let low = Point2::from(around.translation.vector - Vector2::repeat(SUBMAP_REACH_M));
        let frame = GridFrame::covering(low, 2.0 * SUBMAP_REACH_M, 2.0 * SUBMAP_REACH_M, SURFEL_M)?;
        Some(Self { map: SurfelMap::new(&frame), keyframes: Vec::new() })
    }

    pub(super) fn add(&mut self, number: usize, keyframe: &Keyframe, noise_m: f64) {
        self.keyframes.push(number);
        self.map.learn(&keyframe.points, &keyframe.local, noise_m, USABLE_SCANS, false);
    }

    /// The submap with all of its keyframes.
    pub(super) fn finish(self, keyframes: &[Keyframe]) -> FinishedSubmap {
        let anchor = self.keyframes[self.keyframes.len() / 2];
        FinishedSubmap {
            anchor,
            first: self.keyframes[0],
            last: anchor.max(*self.keyframes.last().unwrap_or(&anchor)),
            points: self.map.points(&keyframes[anchor].local),
        }
    }
}

/// How well points at a pose agree with a submap.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Agreement {
    /// The weight of the points on surfaces of the submap.
    pub(super) confirmed: f64,
    /// The weight of the points beside surfaces with the same direction.
    pub(super) beside: f64,
    /// The weight of all points.
    pub(super) all: f64,
    pub(super) confirmed_points: usize,
}

impl Agreement {
    /// The agreement of a scan whose end points fit by this share.
    pub(super) fn of_response(response: f64) -> Self {
        Self { confirmed: response, beside: 1.0 - response, all: 1.0, confirmed_points: 0 }
    }

    /// The share of what is confirmed, of all that the submap can judge.
    pub(super) fn share(&self) -> f64 {
        let judged = self.confirmed + self.beside;
        if judged > 0.0 { self.confirmed / judged } else { 0.0 }
    }

    /// The share of the points that the submap can judge.
    pub(super) fn overlap(&self) -> f64 {
        if self.all > 0.0 { (self.confirmed + self.beside) / self.all } else { 0.0 }
    }
}

/// Compares a scan with a submap: a point within `gate_m` of a surface is confirmed.
pub(super) fn agreement(
    map: &SurfelMap,
    points: &[ScanPoint],
    placement: &Placement,
    gate_m: f64,
) -> Agreement {
    let mut agreement = Agreement::default();
    for point in points {
        let (at, normal) = (placement.place(point), placement.pose.rotation * point.normal);
        agreement.all += point.weight;
        if map.nearest(&at, &normal, gate_m).is_some() {
            agreement.confirmed += point.weight;
            agreement.confirmed_points += 1;
        } else if map.nearest(&at, &normal, JUDGED_M).is_some() {
            agreement.beside += point.weight;
        }
    }
    agreement
}

// What matches of scans and of submaps share: gates, covariances, and what a match says.

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

/// Points farther away are left out of keyframes and of parts of a map, m: neighboring beams are on different surfaces.
const KEYFRAME_RANGE_M: f64 = 25.0;
/// Neighboring points are on one line up to this share of their distance.
const OFF_LINE: f64 = 0.15;
/// Points of a keyframe that are kept for the end: ten thousand keyframes of 1000 points are too many.
pub(super) const KEPT_POINTS: usize = 120;

/// A scan that represents all scans around it.
#[derive(Clone, Debug)]
pub(super) struct Keyframe {
    /// The pose by matching with local submaps alone, m and rad.
    pub(super) local: Isometry2<f64>,
    /// The motion from the keyframe before by matching with local submaps alone, and the inverse of its covariance.
    pub(super) from_last: (Isometry2<f64>, Matrix3<f64>),
    /// The points, in the frame of the robot; a part of them once it is in its submaps.
    pub(super) points: Vec<ScanPoint>,
    /// The pose of the laser in the frame of the robot.
    pub(super) mount: Isometry2<f64>,
    /// The scan.
    pub(super) scan: Scan,
}

/// At most a number of points, evenly taken.
pub(super) fn thinned(points: &[ScanPoint], max_points: usize) -> Vec<ScanPoint> {
    points.iter().step_by(points.len().div_ceil(max_points).max(1)).copied().collect()
}

/// The near points of a scan, and between neighbors on one surface as many more as a line map needs: far surfaces are
/// hit by few beams.
pub(super) fn filled(points: &[ScanPoint]) -> Vec<ScanPoint> {
    let near = |point: &&ScanPoint| point.at.coords.norm_squared() < KEYFRAME_RANGE_M * KEYFRAME_RANGE_M;
    let mut filled: Vec<ScanPoint> = Vec::with_capacity(points.len());
    for point in points.iter().filter(near) {
        if let Some(before) = filled.last().copied().filter(|before| are_joined(before, point)) {
            let way = point.at - before.at;
            let steps = (way.norm() / SURFEL_M) as usize;
            for step in 1..steps {
                let at = before.at + way * (step as f64 / steps as f64);
                filled.push(ScanPoint { at, ..before });
            }
        }
        filled.push(*point);
    }
    filled
}

fn are_joined(before: &ScanPoint, point: &ScanPoint) -> bool {
    let way = point.at - before.at;
    let distance_m = way.norm();
    point.beam == before.beam + 1
        && distance_m < 2.0 * JUDGED_M
        && before.normal.dot(&point.normal) > SAME_SURFACE
        && before.normal.dot(&way).abs() < OFF_LINE * distance_m
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

#[cfg(test)]
mod keyframe_tests {
    use super::*;
    use nalgebra::{Point2, Vector2};

    #[test]
    fn only_neighbors_on_one_surface_are_joined() {
        let point = |x: f64, y: f64, beam: usize| ScanPoint {
            beam,
            ..ScanPoint::new(Point2::new(x, y), -Vector2::y())
        };
        // 0.5 m along a wall; then a step, a missing beam, and a point that is too far away.
        let points = [
            point(0.0, 5.0, 0),
            point(0.5, 5.0, 1),
            point(1.0, 5.4, 2),
            point(1.3, 5.4, 4),
            point(30.0, 5.4, 5),
        ];
        let filled = filled(&points);
        assert_eq!(filled.len(), 4 + 4);
        assert!(filled[..6].windows(2).all(|pair| (pair[1].at.x - pair[0].at.x - 0.1).abs() < 1e-9));
    }
}
