//! Sizes of errors and of motions.

use crate::heading_rad;
use nalgebra::{Isometry2, Matrix3, Vector3};

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
