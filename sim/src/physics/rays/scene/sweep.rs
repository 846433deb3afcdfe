//! Casting the rays of a scan that sweeps.

use super::{SCRATCH, Scene, Walls, is_in_wall};
use crate::physics::rays::passing::{Passing, Ray};

/// What is farther away than the nearest hit by this factor is left out: far above rounding.
const SAFE: f64 = 1.0 + 1e-9;

impl Scene {
    /// Computes what the rays of a laser on the robot `own` hit within `range_max_m`: walls, and in each interval of
    /// time the bodies `moving` of this interval. `read` receives one over the range for each ray, 1/m; 0 where there is
    /// no hit.
    pub(in crate::physics) fn sweep<T>(
        &self,
        rays: &[Ray],
        moving: &[Vec<Passing>],
        range_max_m: f64,
        own: usize,
        read: impl FnOnce(&[f64]) -> T,
    ) -> T {
        SCRATCH.with_borrow_mut(|scratch| {
            let inverse = &mut scratch.inverse;
            inverse.clear();
            inverse.extend(rays.iter().map(|ray| {
                let bodies = moving[ray.interval].iter().filter(|body| body.is_seen_by(own));
                let hits = bodies.map(|body| body.hit(ray, range_max_m));
                hits.fold(self.wall_hit(ray, range_max_m), nearer)
            }));
            read(inverse)
        })
    }

    /// One over the range at which a ray hits a wall, 1/m; 0: it does not hit any, ∞: it begins in one.
    fn wall_hit(&self, ray: &Ray, range_max_m: f64) -> f64 {
        let Walls { solids, edges, visible } = &*self.moving.walls;
        let cell = visible.cell_at(&ray.from);
        if is_in_wall(solids, visible, cell, &ray.from) {
            return f64::INFINITY;
        }
        let Some(cell) = cell else {
            return edges.iter().map(|edge| ray.edge_hit(edge, range_max_m)).fold(0.0, nearer);
        };
        let mut nearest = 0.0;
        for seen in visible.edges.get(cell) {
            // The nearest edges come first.
            if f64::from(seen.nearest_m) > SAFE * range_max_m.min(1.0 / nearest) {
                break;
            }
            nearest = nearer(nearest, ray.edge_hit(&edges[seen.edge as usize], range_max_m));
        }
        nearest
    }
}

/// The larger one of two inverse ranges.
fn nearer(one: f64, other: f64) -> f64 {
    if other > one { other } else { one }
}
