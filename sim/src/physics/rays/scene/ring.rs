//! The shortest range of a sensor, by a list of what is around its robot.

use super::{Scene, Sorted, Walls};
use crate::physics::rays::beams::Beams;
use crate::physics::rays::nearest::Nearest;
use crate::physics::rays::vicinity::{Ring, Thing, Vicinity};
use crate::physics::shape::point_segment_m;
use nalgebra::{Isometry2, Point2, Vector2};

impl Scene {
    /// What the sensors of the robot `own` may detect, whose center is at `center`.
    pub(in crate::physics) fn vicinity(&self, center: Point2<f64>, ring: &Ring, own: usize) -> Vicinity {
        let mut found = Vicinity::new(center, ring);
        let visible = &self.walls.visible;
        let reach = Vector2::repeat(found.sensors.radius_m);
        let (low, high) = (center - reach, center + reach);
        if visible.reaches_out(&low, &high) {
            (0..self.walls.edges.len()).for_each(|edge| self.add_edge(edge, ring, &mut found));
            (0..=visible.len()).for_each(|cell| self.add_bodies(cell, ring, own, &mut found));
            found.solids.extend(0..self.walls.solids.len() as u32);
        } else {
            for cell in visible.around(&low, &high) {
                visible
                    .edges(cell)
                    .iter()
                    .for_each(|seen| self.add_edge(seen.edge as usize, ring, &mut found));
                let cells = visible.cells(cell).iter().map(|&other| other as usize);
                cells
                    .take_while(|&other| visible.apart_m(cell, other) <= ring.range_m)
                    .chain([visible.len()])
                    .for_each(|other| self.add_bodies(other, ring, own, &mut found));
                found.solids.extend(visible.boxes(cell));
            }
        }
        let solids = &self.walls.solids;
        let may_contain = |solid: &u32| {
            solids[*solid as usize].iter().all(|side| side.gap_m(&center) <= found.sensors.radius_m)
        };
        found.solids.retain(may_contain);
        found.sort();
        found
    }

    fn add_edge(&self, index: usize, ring: &Ring, found: &mut Vicinity) {
        let (edge, sensors) = (&self.walls.edges[index], found.sensors);
        let gap_m = edge.gap_m(&sensors.center);
        // Else the edge faces away from all sensors.
        if gap_m >= -sensors.radius_m && gap_m <= ring.range_m + sensors.radius_m {
            let distance_m = point_segment_m(&sensors.center, &edge.from, &edge.to);
            if distance_m <= ring.range_m + sensors.radius_m {
                found.add(distance_m, Thing::Edge(index));
            }
        }
    }

    fn add_bodies(&self, cell: usize, ring: &Ring, own: usize, found: &mut Vicinity) {
        let Sorted { robots, polygons } = self.sorted();
        let center = found.sensors.center;
        let most_m = ring.range_m + found.sensors.radius_m;
        for (robot, disc) in robots.get(cell).iter().filter(|(robot, _)| *robot as usize != own) {
            let distance_m = (disc.center - center).norm() - disc.radius_m;
            if distance_m <= most_m {
                found.add(distance_m, Thing::Robot(*robot as usize));
            }
        }
        for &index in polygons.in_cell(cell) {
            let polygon = polygons.get(index);
            let distance_m = (polygon.around.center - center).norm() - polygon.around.radius_m;
            if distance_m <= most_m && polygon.is_seen_by(own) {
                found.add(distance_m, Thing::Polygon(index));
            }
        }
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
