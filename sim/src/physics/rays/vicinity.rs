//! The walls and bodies around a robot, for all sensors of the robot that only need the nearest of them.

use super::disc::Disc;
use super::edges::Edge;
use crate::physics::shape::point_segment_m;
use nalgebra::Point2;

/// The positions and ranges of the sensors of a robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::physics) struct Ring {
    /// The greatest distance of a sensor from the center of the robot, m.
    pub(in crate::physics) offset_m: f64,
    /// The longest range of a sensor, m.
    pub(in crate::physics) range_m: f64,
}

/// A wall or a body, by its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Thing {
    /// A visible edge of the walls.
    Edge(usize),
    /// A round robot.
    Robot(usize),
    /// A convex body.
    Polygon(u32),
}

/// The walls and bodies that the sensors of a robot may detect, the nearest first.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Vicinity {
    /// The center of the robot and the distance of its sensors from the center, m.
    pub(super) sensors: Disc,
    /// What is farther away from the center is out of range of all sensors, m.
    reach_m: f64,
    /// The solid walls in which a sensor may be.
    pub(super) solids: Vec<u32>,
    /// For each thing its distance from the center of the robot, at least 0, m.
    things: Vec<(f64, Thing)>,
}

impl Vicinity {
    /// Nothing yet.
    pub(super) fn new(center: Point2<f64>, ring: &Ring) -> Self {
        // A little larger, because of rounding.
        let sensors = Disc { center, radius_m: ring.offset_m * (1.0 + 1e-9) + 1e-9 };
        let reach_m = ring.range_m + sensors.radius_m;
        Self { sensors, reach_m, solids: Vec::new(), things: Vec::with_capacity(64) }
    }

    /// Adds an edge of the walls, if the edge faces a sensor and is in range.
    pub(super) fn add_edge(&mut self, index: usize, edge: &Edge) {
        let gap_m = edge.gap_m(&self.sensors.center);
        if gap_m >= -self.sensors.radius_m && gap_m <= self.reach_m {
            let distance_m = point_segment_m(&self.sensors.center, &edge.from, &edge.to);
            self.add(distance_m, Thing::Edge(index));
        }
    }

    /// Adds a body with a disc around it, if the body is in range.
    pub(super) fn add_disc(&mut self, around: &Disc, thing: Thing) {
        let (most_m, distance2) =
            (self.reach_m + around.radius_m, (around.center - self.sensors.center).norm_squared());
        if distance2 <= most_m * most_m {
            self.add(distance2.sqrt() - around.radius_m, thing);
        }
    }

    /// Adds a thing at a distance from the center of the robot, m.
    fn add(&mut self, distance_m: f64, thing: Thing) {
        if distance_m <= self.reach_m {
            self.things.push((distance_m.max(0.0), thing));
        }
    }

    /// Sorts the things by their distance, and removes those that were added twice.
    pub(super) fn sort(&mut self) {
        self.things.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        self.things.dedup();
    }

    /// The things, each with its distance from the center of the robot (m), the nearest first.
    pub(super) fn things(&self) -> impl Iterator<Item = (f64, Thing)> {
        self.things.iter().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn things_come_in_the_order_of_their_distance_and_once() {
        let mut vicinity = Vicinity::new(Point2::origin(), &Ring { offset_m: 0.0, range_m: 1e4 });
        let things = [
            (3.5, Thing::Polygon(7)),
            (-0.2, Thing::Polygon(1)),
            (1e-3, Thing::Edge((1 << 30) - 1)),
            (3.5, Thing::Polygon(7)),
            (0.7, Thing::Robot(12)),
            (1e3, Thing::Edge(0)),
        ];
        things.iter().for_each(|(distance_m, thing)| vicinity.add(*distance_m, *thing));
        vicinity.sort();
        let found: Vec<_> = vicinity.things().collect();
        assert_eq!(
            found.iter().map(|found| found.1).collect::<Vec<_>>(),
            [1, 2, 4, 0, 5].map(|i| things[i].1)
        );
        let distances_m = [0.0, 1e-3, 0.7, 3.5, 1e3];
        assert!(found.iter().map(|found| found.0).eq(distances_m));
    }
}
