//! The shortest range of a sensor, by a list of what is around its robot.

use super::{SCRATCH, Scene, Sorted, Walls, is_in_wall};
use crate::physics::rays::beams::Beams;
use crate::physics::rays::disc::Disc;
use crate::physics::rays::edges::Edge;
use crate::physics::rays::nearest::Nearest;
use crate::physics::rays::sectors::{Passing, Ray, Sector};
use crate::physics::rays::vicinity::{Ring, Thing, Vicinity};
use nalgebra::{Isometry2, Point2, Vector2};

impl Scene {
    /// What the sensors of the robot `own` may detect, whose center is at `center`.
    pub(in crate::physics) fn vicinity(&self, center: Point2<f64>, ring: &Ring, own: usize) -> Vicinity {
        let mut found = Vicinity::new(center, ring);
        let (Walls { solids, edges, visible }, sorted) = (&*self.moving.walls, self.sorted());
        let reach = Vector2::repeat(found.sensors.radius_m);
        let (low, high) = (center - reach, center + reach);
        if visible.reaches_out(&low, &high) {
            (0..edges.len()).for_each(|edge| found.add_edge(edge, &edges[edge]));
            sorted.add_all_to(&mut found, own);
            found.solids.extend(0..solids.len() as u32);
        } else {
            if sorted.are_few {
                sorted.add_all_to(&mut found, own);
            }
            for cell in visible.around(&low, &high) {
                for seen in visible.edges.get(cell) {
                    found.add_edge(seen.edge as usize, &edges[seen.edge as usize]);
                }
                if !sorted.are_few {
                    let cells = visible.cells.get(cell).iter().map(|&other| other as usize);
                    cells
                        .take_while(|&other| visible.apart_m(cell, other) <= ring.range_m)
                        .chain([visible.len()])
                        .for_each(|other| sorted.add_to(&mut found, other, own));
                }
                found.solids.extend(visible.boxes.get(cell));
            }
        }
        let sensors = found.sensors;
        let may_contain = |side: &Edge| side.gap_m(&sensors.center) <= sensors.radius_m;
        found.solids.retain(|solid| solids[*solid as usize].iter().all(may_contain));
        found.sort();
        found
    }

    /// One over the shortest range of all `beams` of a sensor at the pose `sensor`, 1/m; 0 without a hit. The sensor is
    /// one of those for which the vicinity `near` was computed. The value is the largest one of [`Scene::cast`].
    pub(in crate::physics) fn nearest(&self, beams: &Beams, sensor: &Isometry2<f64>, near: &Vicinity) -> f64 {
        let Walls { solids, edges, .. } = &*self.moving.walls;
        let Sorted { polygons, .. } = self.sorted();
        let at = Point2::from(sensor.translation.vector);
        let mut containing = near.solids.iter().map(|&solid| &solids[solid as usize]);
        if containing.any(|sides| sides.iter().all(|side| side.gap_m(&at) <= 0.0)) {
            return f64::INFINITY;
        }
        let offset_m = near.sensors.radius_m;
        let mut inverse = Vec::new();
        let mut nearest = Nearest::new(beams, sensor, &mut inverse);
        for (distance_m, thing) in near.things() {
            if distance_m - offset_m > nearest.reach_m {
                break;
            }
            match thing {
                Thing::Edge(index) => nearest.add_edge(&edges[index]),
                Thing::Robot(index) => nearest.add_disc(&self.moving.discs[index]),
                Thing::Polygon(index) => {
                    let polygon = polygons.get(index);
                    let sides = polygons.edges(polygon);
                    // The disc around the body contains the body: only then can a sensor be inside.
                    if distance_m <= offset_m && sides.iter().all(|side| side.gap_m(&at) <= 0.0) {
                        return f64::INFINITY;
                    }
                    if nearest.may_meet(&polygon.around) {
                        nearest.add_polygon(sides);
                    }
                }
            }
        }
        nearest.inverse()
    }
}

impl Sorted {
    /// Adds the bodies of a cell to what the sensors of the robot `own` may detect.
    fn add_to(&self, found: &mut Vicinity, cell: usize, own: usize) {
        self.add(found, self.robots.get(cell), self.polygons.in_cell(cell).iter().copied(), own);
    }

    /// Adds all bodies.
    fn add_all_to(&self, found: &mut Vicinity, own: usize) {
        self.add(found, &self.robots.items, 0..self.polygons.len() as u32, own);
    }

    fn add(&self, to: &mut Vicinity, discs: &[(u32, Disc)], polygons: impl Iterator<Item = u32>, own: usize) {
        for (robot, disc) in discs.iter().filter(|(robot, _)| *robot as usize != own) {
            to.add_disc(disc, Thing::Robot(*robot as usize));
        }
        for index in polygons {
            let polygon = self.polygons.get(index);
            if polygon.is_seen_by(own) {
                to.add_disc(&polygon.around, Thing::Polygon(index));
            }
        }
    }
}

// Casting the rays of a scan that sweeps.

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
