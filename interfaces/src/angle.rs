//! Angles and poses through `libm`, so that the same seed gives the same bits on every machine.

use nalgebra::{Isometry2, Matrix3, Translation2, UnitComplex, Vector3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The rotation by `angle_rad`.
pub fn rotation(angle_rad: f64) -> UnitComplex<f64> {
    let (sin, cos) = libm::sincos(angle_rad);
    UnitComplex::from_cos_sin_unchecked(cos, sin)
}

/// The pose at `(x_m, y_m)` with the heading `heading_rad`.
pub fn pose(x_m: f64, y_m: f64, heading_rad: f64) -> Isometry2<f64> {
    Isometry2::from_parts(Translation2::new(x_m, y_m), rotation(heading_rad))
}

/// The heading of a pose, in (−π, π].
pub fn heading_rad(pose: &Isometry2<f64>) -> f64 {
    libm::atan2(pose.rotation.im, pose.rotation.re)
}

/// The limit of the coordinates of a place, m: beyond, they lose precision.
pub const FARTHEST_M: f64 = 1e6;

/// Whether every number of a pose is finite, its rotation valid, and its position within [`FARTHEST_M`].
pub fn is_valid_pose(pose: &Isometry2<f64>) -> bool {
    let is_near = [pose.translation.x, pose.translation.y].iter().all(|at| at.abs() <= FARTHEST_M);
    is_near && (pose.rotation.norm_sqr() - 1.0).abs() < 1e-3
}

/// The same angle in [−π, π).
pub fn wrap_rad(angle_rad: f64) -> f64 {
    angle_rad - TAU * libm::floor((angle_rad + PI) / TAU)
}

/// The largest error of [`approximate_atan2`], rad.
pub const APPROXIMATE_ATAN2_ERROR_RAD: f64 = 1.2e-5;

/// The direction of the vector (x, y) in [−π, π], rad, with an error of at most [`APPROXIMATE_ATAN2_ERROR_RAD`]; 0
/// for the zero vector. Abramowitz & Stegun (1964), 4.4.49. Use it as a first estimate where the exact function
/// takes too long.
#[inline]
pub fn approximate_atan2(y: f64, x: f64) -> f64 {
    let (along, across) = (x.abs(), y.abs());
    let (low, high) = if across > along { (along, across) } else { (across, along) };
    let t = low / high.max(f64::MIN_POSITIVE);
    let t2 = t * t;
    let series =
        0.999_866_0 + t2 * (-0.330_299_5 + t2 * (0.180_141_0 + t2 * (-0.085_133_0 + t2 * 0.020_835_1)));
    let eighth = t * series;
    let quarter = if across > along { FRAC_PI_2 - eighth } else { eighth };
    let half = if x < 0.0 { PI - quarter } else { quarter };
    if y < 0.0 { -half } else { half }
}

// Sizes of errors and of motions.

/// Distance of the surfaces that a robot typically sees, m: an error of the heading of 1 rad shifts them by this.
const SEEN_M: f64 = 3.0;

/// A size of errors or of motions: a distance, and an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The distance, m.
    pub m: f64,
    /// The angle, rad.
    pub rad: f64,
}

impl Spread {
    /// Errors of a pose which shift the surfaces that are seen by about the same.
    pub const fn of_error(m: f64) -> Self {
        Self { m, rad: m / SEEN_M }
    }

    /// Motions of a robot, which turns by about 1 rad where it drives 1 m.
    pub const fn of_motion(m: f64) -> Self {
        Self { m, rad: m }
    }

    /// The covariance of x, y and heading with these standard deviations.
    pub fn covariance(self) -> Matrix3<f64> {
        let std = Vector3::new(self.m, self.m, self.rad);
        Matrix3::from_diagonal(&std.component_mul(&std))
    }

    /// The inverse of the covariance.
    pub fn information(self) -> Matrix3<f64> {
        let std = Vector3::new(self.m, self.m, self.rad);
        Matrix3::from_diagonal(&std.map(|std| 1.0 / (std * std)))
    }

    /// Whether a motion is not larger.
    pub fn contains(self, motion: &Isometry2<f64>) -> bool {
        motion.translation.vector.norm() <= self.m && heading_rad(motion).abs() <= self.rad
    }
}

// The median.

/// The middle value, the upper one of two; `None` without a value.
pub fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_approximate_angle_is_close_to_the_exact_one() {
        for step in -10_000..10_000 {
            let angle = f64::from(step) * PI / 10_000.0;
            let (y, x) = libm::sincos(angle);
            let error = wrap_rad(approximate_atan2(7.0 * y, 7.0 * x) - angle);
            assert!(error.abs() < APPROXIMATE_ATAN2_ERROR_RAD, "{angle}: {error}");
        }
        assert_eq!(approximate_atan2(0.0, 0.0), 0.0);
    }

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
