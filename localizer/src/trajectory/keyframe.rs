use crate::constants::{JUDGED_M, SAME_SURFACE, SURFEL_M};
use crate::scan_points::ScanPoint;
use interfaces::Scan;
use nalgebra::{Isometry2, Matrix3};

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
