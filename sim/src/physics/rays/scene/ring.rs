//! The shortest range of a sensor, by a list of what is around its robot.

use super::{Scene, Sorted, Walls};
use crate::physics::rays::beams::Beams;
use crate::physics::rays::edges::Edge;
use crate::physics::rays::nearest::Nearest;
use crate::physics::rays::vicinity::{Ring, Thing, Vicinity};
use nalgebra::{Isometry2, Point2, Vector2};

impl Scene {
    /// What the sensors of the robot `own` may detect, whose center is at `center`.
    pub(in crate::physics) fn vicinity(&self, center: Point2<f64>, ring: &Ring, own: usize) -> Vicinity {
        let mut found = Vicinity::new(center, ring);
        let (Walls { solids, edges, visible }, sorted) = (&*self.walls, self.sorted());
        let reach = Vector2::repeat(found.sensors.radius_m);
        let (low, high) = (center - reach, center + reach);
        if visible.reaches_out(&low, &high) {
            (0..edges.len()).for_each(|edge| found.add_edge(edge, &edges[edge]));
            (0..=visible.len()).for_each(|cell| sorted.add_to(&mut found, cell, own));
            found.solids.extend(0..solids.len() as u32);
        } else {
            for cell in visible.around(&low, &high) {
                for seen in visible.edges(cell) {
                    found.add_edge(seen.edge as usize, &edges[seen.edge as usize]);
                }
                let cells = visible.cells(cell).iter().map(|&other| other as usize);
                cells
                    .take_while(|&other| visible.apart_m(cell, other) <= ring.range_m)
                    .chain([visible.len()])
                    .for_each(|other| sorted.add_to(&mut found, other, own));
                found.solids.extend(visible.boxes(cell));
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
        let Walls { solids, edges, .. } = &*self.walls;
        let Sorted { polygons, .. } = self.sorted();
        let at = Point2::from(sensor.translation.vector);
        let mut containing = vicinity.solids.iter().map(|&solid| &solids[solid as usize]);
        if containing.any(|sides| sides.iter().all(|side| side.gap_m(&at) <= 0.0)) {
            return f64::INFINITY;
        }
        let offset_m = vicinity.sensors.radius_m;
        let mut nearest = Nearest::new(beams, sensor);
        for (distance_m, thing) in vicinity.things() {
            if distance_m - offset_m > nearest.reach_m() {
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
        for (robot, disc) in self.robots.get(cell).iter().filter(|(robot, _)| *robot as usize != own) {
            found.add_disc(disc, Thing::Robot(*robot as usize));
        }
        for &index in self.polygons.in_cell(cell) {
            let polygon = self.polygons.get(index);
            if polygon.is_seen_by(own) {
                found.add_disc(&polygon.around, Thing::Polygon(index));
            }
        }
    }
}
