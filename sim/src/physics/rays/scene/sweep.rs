//! Casting the rays of a scan that sweeps.

use super::{SCRATCH, Scene, Walls, is_in_wall};
use crate::physics::rays::passing::Passing;
use crate::physics::rays::sectors::{Ray, Sector};

/// The number of rays in a sector.
const SECTOR_RAYS: usize = 16;

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
            inverse.resize(rays.len(), 0.0);
            let visible = &self.moving.walls.visible;
            let place = |ray: &Ray| (ray.interval, visible.cell_at(&ray.from));
            let mut rest = &mut inverse[..];
            for rays in rays.chunk_by(|a, b| place(a) == place(b)).flat_map(|rays| rays.chunks(SECTOR_RAYS)) {
                let (own_inverse, others) = rest.split_at_mut(rays.len());
                rest = others;
                let mut sector = Sector::new(rays, own_inverse, range_max_m);
                let (interval, cell) = place(&rays[0]);
                self.add_walls(cell, &mut sector);
                for body in moving[interval].iter().filter(|body| body.is_seen_by(own)) {
                    sector.add_passing(body);
                }
            }
            read(inverse)
        })
    }

    /// Adds the walls to a sector whose rays begin in a cell (none: beyond the borders).
    fn add_walls(&self, cell: Option<usize>, sector: &mut Sector<'_>) {
        let Walls { solids, edges, visible } = &*self.moving.walls;
        sector.add_inside(|at| is_in_wall(solids, visible, cell, at));
        let Some(cell) = cell else { return edges.iter().for_each(|edge| sector.add_edge(edge)) };
        for seen in visible.edges.get(cell) {
            // The nearest edges come first.
            if f64::from(seen.nearest_m) > sector.reach_m {
                return;
            }
            sector.add_edge(&edges[seen.edge as usize]);
        }
    }
}
