//! Round bodies, and discs around convex bodies, that a laser may see, many at a time.
//!
//! Most of them are hidden. Whether they are is first computed approximately, for all of them in one loop
//! without branches; only bodies that may be visible are then computed exactly.

use super::beams::Hits;
use super::disc::Disc;
use super::polygons::SortedPolygons;
use interfaces::APPROXIMATE_ATAN2_ERROR_RAD;
use nalgebra::Vector2;
use std::f32::consts::{FRAC_PI_2, PI};

/// The margins of approximate values: for single precision, and for the approximate angle.
const SAFE_RAD: f32 = 3.0 * APPROXIMATE_ATAN2_ERROR_RAD as f32;
const SAFE: f32 = 1.0 + 1e-5;

/// A disc within the range of a laser, in the frame of the laser.
#[derive(Clone, Copy, Debug, Default)]
struct Near {
    /// The center, m.
    center: Vector2<f64>,
    radius_m: f64,
    /// The power of the laser position: distance squared less radius squared, m²; positive.
    power: f64,
    /// The convex body in the disc; `None` if the disc is a body.
    polygon: Option<u32>,
}

/// Discs within the range of a laser.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct Discs {
    near: Vec<Near>,
    /// The following lists are approximate and of the same length. Center and radius, m:
    x: Vec<f32>,
    y: Vec<f32>,
    radius: Vec<f32>,
    /// The direction of the center, rad; the half width, at least the true one, rad; and one over the shortest
    /// range, at least the true value, 1/m.
    angle: Vec<f32>,
    half: Vec<f32>,
    nearest: Vec<f32>,
}

impl Discs {
    /// Removes all discs, and makes room for `most`.
    pub(super) fn clear(&mut self, most: usize) {
        self.near.clear();
        self.near.reserve(most);
    }

    /// Adds a disc if the disc is within range. A laser inside of the disc sees nothing else.
    #[inline(always)]
    pub(super) fn push(&mut self, disc: &Disc, hits: &mut Hits<'_>) {
        if self.is_around(disc, None, hits) {
            hits.add_inside();
        }
    }

    /// Adds the convex body with an index if the body is within range and its lasers are not those of the robot `own`.
    pub(super) fn push_polygon(
        &mut self,
        index: u32,
        polygons: &SortedPolygons,
        own: usize,
        hits: &mut Hits<'_>,
    ) {
        let polygon = polygons.get(index);
        if polygon.is_seen_by(own) && self.is_around(&polygon.around, Some(index), hits) {
            hits.add_polygon(polygons.edges(polygon));
        }
    }

    /// Whether the laser is inside of a disc. If it is not, adds the disc if the disc is within range.
    #[inline(always)]
    fn is_around(&mut self, disc: &Disc, polygon: Option<u32>, hits: &Hits<'_>) -> bool {
        let to = disc.center - hits.laser.translation.vector;
        let power = to.coords.norm_squared() - disc.radius_m * disc.radius_m;
        let reach_m = hits.beams.range_max_m + disc.radius_m;
        if power > reach_m * reach_m {
            return false;
        }
        if power <= 0.0 {
            return true;
        }
        let center = hits.laser.rotation.inverse() * to.coords;
        self.near.push(Near { center, radius_m: disc.radius_m, power, polygon });
        false
    }

    /// Adds all bodies to the hits.
    pub(super) fn add_to(&mut self, polygons: &SortedPolygons, hits: &mut Hits<'_>) {
        self.approximate();
        let approximate = self.angle.iter().zip(&self.half).zip(&self.nearest);
        for (disc, ((&angle, &half), &nearest)) in self.near.iter().zip(approximate) {
            let (angle_rad, half_rad, nearest) = (f64::from(angle), f64::from(half), f64::from(nearest));
            match disc.polygon {
                None => hits.add_disc(&disc.center, disc.power, angle_rad, half_rad, nearest),
                Some(_) if hits.is_hidden(angle_rad, half_rad, nearest) => {}
                Some(index) => hits.add_polygon(polygons.edges(polygons.get(index))),
            }
        }
    }

    /// Computes the approximate lists.
    fn approximate(&mut self) {
        let count = self.near.len();
        let lists =
            [&mut self.x, &mut self.y, &mut self.radius, &mut self.angle, &mut self.half, &mut self.nearest];
        let [x, y, radius, angle, half, nearest] = lists.map(|list| {
            if list.len() < count {
                list.resize(count, 0.0);
            }
            &mut list[..count]
        });
        for (i, disc) in self.near.iter().enumerate() {
            (x[i], y[i], radius[i]) = (disc.center.x as f32, disc.center.y as f32, disc.radius_m as f32);
        }
        // No branches: several discs at once.
        for i in 0..count {
            angle[i] = approximate_atan2(y[i], x[i]);
            let distance = (x[i] * x[i] + y[i] * y[i]).sqrt();
            // asin(s) ≤ s + (π/2 − 1)·s³.
            let s = (radius[i] / distance * SAFE).min(1.0);
            half[i] = s + 0.571 * s * s * s + SAFE_RAD;
            let gap = distance - radius[i];
            // A gap as small as rounding errors counts as zero.
            nearest[i] = if gap > distance * 1e-4 { SAFE / (gap - distance * 1e-6) } else { f32::INFINITY };
        }
    }
}

/// The same as [`interfaces::approximate_atan2`] in single precision, without branches.
#[inline]
fn approximate_atan2(y: f32, x: f32) -> f32 {
    let (along, across) = (x.abs(), y.abs());
    let t = along.min(across) / along.max(across).max(f32::MIN_POSITIVE);
    let t2 = t * t;
    let series = 0.999_866 + t2 * (-0.330_299_5 + t2 * (0.180_141 + t2 * (-0.085_133 + t2 * 0.020_835_1)));
    let angle = t * series;
    let angle = if across > along { FRAC_PI_2 - angle } else { angle };
    let angle = if x < 0.0 { PI - angle } else { angle };
    if y < 0.0 { -angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn approximate_values_are_on_the_safe_side() {
        let mut discs = Discs::default();
        for i in 0..5000 {
            let (y, x) = libm::sincos(f64::from(i) * 0.37);
            let radius_m = 0.02 + f64::from(i % 50) * 0.01;
            let distance_m = radius_m * (1.0 + 1e-6 + f64::from(i * i % 977) * 0.1);
            let center = Vector2::new(x, y) * distance_m;
            discs.near = vec![Near { center, radius_m, power: 1.0, polygon: None }];
            discs.approximate();
            let off = interfaces::wrap_rad(f64::from(discs.angle[0]) - libm::atan2(y, x)).abs();
            let half = libm::asin(radius_m / distance_m);
            assert!(off + half <= f64::from(discs.half[0]), "{i}");
            assert!(1.0 / (distance_m - radius_m) <= f64::from(discs.nearest[0]), "{i}");
        }
    }
}
