//! Angles and poses through `libm`, so that the same seed gives the same bits on every machine.

use nalgebra::{Isometry2, Translation2, UnitComplex};
use std::f64::consts::{PI, TAU};

/// The rotation by `angle_rad`.
pub fn rotation(angle_rad: f64) -> UnitComplex<f64> {
    let (sin, cos) = libm::sincos(angle_rad);
    UnitComplex::from_cos_sin_unchecked(cos, sin)
}

/// The pose at `(x_m, y_m)` that looks along `heading_rad`.
pub fn pose(x_m: f64, y_m: f64, heading_rad: f64) -> Isometry2<f64> {
    Isometry2::from_parts(Translation2::new(x_m, y_m), rotation(heading_rad))
}

/// The direction a pose looks along, in (−π, π].
pub fn heading_rad(pose: &Isometry2<f64>) -> f64 {
    libm::atan2(pose.rotation.im, pose.rotation.re)
}

/// The same angle in [−π, π).
pub fn wrap_rad(angle_rad: f64) -> f64 {
    angle_rad - TAU * libm::floor((angle_rad + PI) / TAU)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_keeps_its_heading() {
        for step in -31..=31 {
            let angle = f64::from(step) * 0.1;
            assert!((heading_rad(&pose(1.0, 2.0, angle)) - angle).abs() < 1e-12);
        }
    }

    #[test]
    fn wrapping_changes_whole_turns_only() {
        for step in -100..100 {
            let angle = f64::from(step) * 0.37;
            let wrapped = wrap_rad(angle);
            assert!((-PI..PI).contains(&wrapped));
            let turns = (angle - wrapped) / TAU;
            assert!((turns - turns.round()).abs() < 1e-9);
        }
    }
}
