use interfaces::APPROXIMATE_ATAN2_ERROR_RAD;
use nalgebra::Point2;

/// A round body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::physics) struct Disc {
    /// The center, m.
    pub(in crate::physics) center: Point2<f64>,
    /// The radius, m.
    pub(in crate::physics) radius_m: f64,
}

impl Disc {
    /// A margin for what is computed in single steps: far above rounding.
    pub(super) const SAFE: f64 = 1.0 + 1e-5;

    /// Half of the angle under which the disc is seen from a distance of its center (m), and a margin for the approximate
    /// angle of the center, rad. At least the true value: asin(s) ≤ s + (π/2 − 1)·s³.
    #[inline]
    pub(super) fn half_rad(&self, distance_m: f64) -> f64 {
        let s = (self.radius_m / distance_m * Self::SAFE).min(1.0);
        s + 0.571 * s * s * s + 3.0 * APPROXIMATE_ATAN2_ERROR_RAD
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn approximate_angles_are_on_the_safe_side() {
        for i in 0..5000 {
            let (y, x) = libm::sincos(f64::from(i) * 0.37);
            let radius_m = 0.02 + f64::from(i % 50) * 0.01;
            let distance_m = radius_m * (1.0 + 1e-6 + f64::from(i * i % 977) * 0.1);
            let center = Point2::new(x, y) * distance_m;
            let off = interfaces::approximate_atan2(center.y, center.x) - libm::atan2(y, x);
            let half = libm::asin(radius_m / distance_m);
            let disc = Disc { center, radius_m };
            assert!(interfaces::wrap_rad(off).abs() + half <= disc.half_rad(distance_m), "{i}");
        }
    }
}
