//! Round bodies that a laser may see, many at a time.
//!
//! Most of them turn out to be hidden. What it takes to find that out is done roughly, for all of
//! them in one loop without branches, and only what may be in sight is looked at exactly.

use super::fan::{Hits, ROUGH_RAD};
use super::scene::Disc;
use nalgebra::Vector2;
use std::f32::consts::{FRAC_PI_2, PI};

/// Rough figures are on the safe side by this much: single precision, and the rough angle.
const SAFE_RAD: f32 = 3.0 * ROUGH_RAD as f32;
const SAFE: f32 = 1.0 + 1e-5;

/// A disc within the range of a laser, in its frame.
#[derive(Clone, Copy, Debug, Default)]
struct Near {
    /// Its middle, m.
    center: Vector2<f64>,
    radius_m: f64,
    /// The distance squared less the radius squared, m²: positive.
    power: f64,
}

/// Discs within the range of a laser.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct Discs {
    near: Vec<Near>,
    /// What follows is rough, and as long. Middle and radius, m:
    x: Vec<f32>,
    y: Vec<f32>,
    radius: Vec<f32>,
    /// Where it is seen, rad; how far to both sides, no less than true, rad; and one over the
    /// shortest range, no less than true, 1/m.
    angle: Vec<f32>,
    half: Vec<f32>,
    nearest: Vec<f32>,
}

impl Discs {
    /// No discs, but room for `most`.
    pub(super) fn clear(&mut self, most: usize) {
        self.near.clear();
        self.near.reserve(most);
    }

    /// Notes a disc, if it is within range. A laser inside of it sees nothing else.
    #[inline(always)]
    pub(super) fn push(&mut self, disc: &Disc, hits: &mut Hits<'_>) {
        let to = disc.center - hits.laser().translation.vector;
        let power = to.coords.norm_squared() - disc.radius_m * disc.radius_m;
        let reach_m = hits.range_max_m() + disc.radius_m;
        if power > reach_m * reach_m {
            return;
        }
        if power <= 0.0 {
            return hits.add_inside();
        }
        let center = hits.laser().rotation.inverse() * to.coords;
        self.near.push(Near { center, radius_m: disc.radius_m, power });
    }

    /// Adds all discs to the hits.
    pub(super) fn add_to(&mut self, hits: &mut Hits<'_>) {
        self.work_out();
        let rough = self.angle.iter().zip(&self.half).zip(&self.nearest);
        for (disc, ((&angle, &half), &nearest)) in self.near.iter().zip(rough) {
            hits.add_disc(&disc.center, disc.power, f64::from(angle), f64::from(half), f64::from(nearest));
        }
    }

    /// Works out what is rough.
    fn work_out(&mut self) {
        let count = self.near.len();
        let rough =
            [&mut self.x, &mut self.y, &mut self.radius, &mut self.angle, &mut self.half, &mut self.nearest];
        let [x, y, radius, angle, half, nearest] = rough.map(|list| {
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
            angle[i] = rough_atan2(y[i], x[i]);
            let distance = (x[i] * x[i] + y[i] * y[i]).sqrt();
            // asin(s) ≤ s + (π/2 − 1)·s³.
            let s = (radius[i] / distance * SAFE).min(1.0);
            half[i] = s + 0.571 * s * s * s + SAFE_RAD;
            let gap = distance - radius[i];
            // A gap as small as rounding: as near as can be.
            nearest[i] = if gap > distance * 1e-4 { SAFE / (gap - distance * 1e-6) } else { f32::INFINITY };
        }
    }
}

/// As that of the fan, in single precision and without branches.
fn rough_atan2(y: f32, x: f32) -> f32 {
    let (along, across) = (x.abs(), y.abs());
    let (low, high) = (along.min(across), along.max(across));
    let t = low / high;
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
    fn rough_figures_are_on_the_safe_side() {
        let mut discs = Discs::default();
        for i in 0..5000 {
            let (y, x) = libm::sincos(f64::from(i) * 0.37);
            let radius_m = 0.02 + f64::from(i % 50) * 0.01;
            let distance_m = radius_m * (1.0 + 1e-6 + f64::from(i * i % 977) * 0.1);
            let center = Vector2::new(x, y) * distance_m;
            discs.near = vec![Near { center, radius_m, power: 1.0 }];
            discs.work_out();
            let off = interfaces::wrap_rad(f64::from(discs.angle[0]) - libm::atan2(y, x)).abs();
            let half = libm::asin(radius_m / distance_m);
            assert!(off + half <= f64::from(discs.half[0]), "{i}");
            assert!(1.0 / (distance_m - radius_m) <= f64::from(discs.nearest[0]), "{i}");
        }
    }
}
