//! The shortest range of a sensor, by a list of what is around its robot.

use super::{Scene, Sorted, Walls};
use crate::physics::rays::beams::Beams;
use crate::physics::rays::disc::Disc;
use crate::physics::rays::edges::Edge;
use crate::physics::rays::nearest::Nearest;
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
    /// one of those for which the vicinity was computed. The value is the largest one of [`Scene::cast`].
    pub(in crate::physics) fn nearest(
        &self,
        beams: &Beams,
        sensor: &Isometry2<f64>,
        vicinity: &Vicinity,
    ) -> f64 {
        let Walls { solids, edges, .. } = &*self.moving.walls;
        let Sorted { polygons, .. } = self.sorted();
        let at = Point2::from(sensor.translation.vector);
        let mut containing = vicinity.solids.iter().map(|&solid| &solids[solid as usize]);
        if containing.any(|sides| sides.iter().all(|side| side.gap_m(&at) <= 0.0)) {
            return f64::INFINITY;
        }
        let offset_m = vicinity.sensors.radius_m;
        let mut inverse = Vec::new();
        let mut nearest = Nearest::new(beams, sensor, &mut inverse);
        for (distance_m, thing) in vicinity.things() {
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

    fn add(
        &self,
        found: &mut Vicinity,
        robots: &[(u32, Disc)],
        polygons: impl Iterator<Item = u32>,
        own: usize,
    ) {
        for (robot, disc) in robots.iter().filter(|(robot, _)| *robot as usize != own) {
            found.add_disc(disc, Thing::Robot(*robot as usize));
        }
        for index in polygons {
            let polygon = self.polygons.get(index);
            if polygon.is_seen_by(own) {
                found.add_disc(&polygon.around, Thing::Polygon(index));
            }
        }
    }
}
