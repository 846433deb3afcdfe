//! Whether the beams of one submap pass the surfaces of another: then they are not the same place.

use super::submap::{FinishedSubmap, Keyframe};
use crate::beams::ranges_around;
use crate::constants::{CLEARANCE_M, MIN_SURE_INCIDENCE, NEAR_RANGE_M, REFINE};
use crate::scan_points::ScanPoint;
use nalgebra::{Isometry2, Point2};

/// A beam passes a surface that it ends behind by this share of the range more.
const PASSED_SHARE: f64 = 0.02;

/// The share of beams that pass surfaces of the other submap, of all that reach them. `pose` is the pose of `to` in
/// `from`.
pub(super) fn passing_share(
    from: &FinishedSubmap,
    to: &FinishedSubmap,
    pose: &Isometry2<f64>,
    keyframes: &[Keyframe],
) -> f64 {
    // For each beam of one submap that reaches a surface of the other, whether it passes.
    let passed = |seeing: &FinishedSubmap, seen: &FinishedSubmap, pose: &Isometry2<f64>| {
        let back = keyframes[seeing.anchor].local.inverse();
        let of_keyframe = |keyframe: &Keyframe| {
            let to_laser = (back * keyframe.local * keyframe.mount).inv_mul(pose);
            let points = seen.points.iter().step_by(2);
            points.filter_map(|point| is_passed(keyframe, point, &to_laser)).collect::<Vec<bool>>()
        };
        let keyframes = keyframes[seeing.first..=seeing.last].iter().step_by(REFINE[1].0);
        keyframes.flat_map(of_keyframe).collect::<Vec<bool>>()
    };
    let beams = [passed(from, to, pose), passed(to, from, &pose.inverse())].concat();
    beams.iter().filter(|is_passed| **is_passed).count() as f64 / beams.len().max(1) as f64
}

/// Whether the beams of a keyframe pass a surface; `None` if they do not reach it.
fn is_passed(keyframe: &Keyframe, point: &ScanPoint, to_laser: &Isometry2<f64>) -> Option<bool> {
    let scan = &keyframe.scan;
    let at: Point2<f64> = to_laser * point.at;
    let distance_m = at.coords.norm();
    let incidence = -(to_laser.rotation * point.normal).dot(&at.coords);
    if distance_m > NEAR_RANGE_M.min(scan.range_max_m) || incidence < MIN_SURE_INCIDENCE * distance_m {
        return None;
    }
    let ranges = ranges_around(scan, &at.coords)?;
    let margin_m = CLEARANCE_M + PASSED_SHARE * distance_m;
    // A missing range says nothing; no return means that the beam passed.
    if ranges.iter().all(|range_m| *range_m > distance_m + margin_m) {
        return Some(true);
    }
    ranges.iter().any(|range_m| (range_m - distance_m).abs() <= margin_m).then_some(false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Scan;
    use nalgebra::Vector2;

    #[test]
    fn a_beam_that_ends_behind_a_surface_passes_it() {
        // All beams end 3 m ahead, but two of them, that see nothing.
        let mut ranges_m = vec![3.0; 181];
        ranges_m[20] = f32::NAN;
        ranges_m[60] = f32::INFINITY;
        let scan = Scan {
            angle_min_rad: -std::f64::consts::FRAC_PI_2,
            angle_increment_rad: 1_f64.to_radians(),
            range_max_m: 80.0,
            ranges_m,
            ..Scan::default()
        };
        let (local, mount) = (Isometry2::identity(), Isometry2::identity());
        let keyframe = Keyframe {
            local,
            from_last: (local, nalgebra::Matrix3::zeros()),
            points: Vec::new(),
            mount,
            scan,
        };
        let passed = |beam: f64, distance_m: f64, facing: f64| {
            let along = interfaces::rotation((beam - 90.0).to_radians()) * Vector2::x();
            let point = ScanPoint::new((along * distance_m).into(), -along * facing);
            is_passed(&keyframe, &point, &Isometry2::identity())
        };
        assert_eq!(passed(90.0, 2.0, 1.0), Some(true));
        assert_eq!(passed(90.0, 3.1, 1.0), Some(false));
        assert_eq!(passed(90.0, 5.0, 1.0), None, "hidden");
        assert_eq!(passed(90.0, 2.0, -1.0), None, "seen from behind");
        assert_eq!(passed(20.0, 2.0, 1.0), None, "a missing beam");
        assert_eq!(passed(60.0, 2.0, 1.0), Some(true), "no return");
        assert_eq!(passed(250.0, 2.0, 1.0), None, "behind the laser");
    }
}
