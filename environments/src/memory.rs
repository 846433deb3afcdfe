//! What a driving robot remembers of an episode: where it was, and what it saw.
//!
//! A robot that only sees its scan and the direction of its goal stays in the first dead end. To know the places where it was is
//! enough to come out of it (Balch and Arkin, "Avoiding the past", 1993).

use draw::scene::extent;
use interfaces::{GridFrame, LaserReading, heading_rad};
use nalgebra::{Isometry2, Point2, Vector2};
use std::f64::consts::{PI, TAU};

/// The side of a cell, m.
const CELL_M: f64 = 0.25;
/// The distances from the robot at which the observation shows the memory, m, each with the number of cells around the point
/// over which it is averaged.
const RINGS: [(f64, i32); 4] = [(0.5, 0), (1.0, 1), (1.75, 1), (3.0, 2)];
/// The directions in which it is shown, counter-clockwise from behind: the middle one is ahead.
const DIRECTIONS: usize = 16;
/// A cell in which the robot was for this number of decisions counts one half.
const HALF: f32 = 20.0;
/// The distance up to which cells count as seen, m.
const SEEN_M: f64 = 4.0;

/// The numbers of each layer of the observation.
pub(crate) const LAYER: usize = RINGS.len() * DIRECTIONS;

/// The memory of one robot.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(crate) struct Memory {
    frame: GridFrame,
    /// For each cell, the number of decisions at which the robot was there.
    visits: Vec<u16>,
    /// Whether a beam passed the cell.
    seen: Vec<bool>,
}

impl Memory {
    /// An empty memory of a world with this frame.
    pub(crate) fn new(world: &GridFrame) -> Self {
        let (origin, size_m) = extent(world);
        let frame = GridFrame::covering(origin, size_m.x, size_m.y, CELL_M.max(world.resolution_m()));
        let frame = frame.unwrap_or(*world);
        Self { frame, visits: vec![0; frame.len()], seen: vec![false; frame.len()] }
    }

    /// Whether it is of a world of the same size, for snapshots.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        let cells = [&self.visits.len(), &self.seen.len()];
        self.frame == other.frame && cells == [&other.visits.len(), &other.seen.len()]
    }

    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        self.visits.fill(0);
        self.seen.fill(false);
    }

    /// Notes where the robot is, and what it sees.
    pub(crate) fn note(&mut self, at: &Point2<f64>, reading: Option<&LaserReading>, pose: &Isometry2<f64>) {
        if let Some(index) = self.frame.index(self.frame.cell_at(at)) {
            self.visits[index] = self.visits[index].saturating_add(1);
        }
        let Some(LaserReading { mount, scan, .. }) = reading else { return };
        let laser = pose * mount;
        let (from, heading_rad) = (Point2::from(laser.translation.vector), heading_rad(&laser));
        for (beam, range_m) in scan.ranges_m.iter().enumerate() {
            // Nothing is known of an invalid beam, and a beam without a return is free.
            let free_m = if range_m.is_nan() { 0.0 } else { f64::from(range_m.max(0.0)).min(SEEN_M) };
            let (sin, cos) = libm::sincos(heading_rad + scan.angle_rad(beam));
            for step in 0..=(free_m / CELL_M) as usize {
                let point = from + Vector2::new(cos, sin) * (step as f64 * CELL_M);
                if let Some(index) = self.frame.index(self.frame.cell_at(&point)) {
                    self.seen[index] = true;
                }
            }
        }
    }

    /// Writes what is around the robot: how long it was there, and which share it saw. Beyond the world both are 1: there is
    /// nothing to be found.
    pub(crate) fn write(&self, visited: &mut [f32], seen: &mut [f32], pose: &Isometry2<f64>) {
        let (at, heading_rad) = (Point2::from(pose.translation.vector), heading_rad(pose));
        let points = RINGS.iter().flat_map(|ring| (0..DIRECTIONS).map(move |direction| (ring, direction)));
        for (((ring, direction), visited), seen) in points.zip(visited).zip(seen) {
            let (sin, cos) = libm::sincos(heading_rad - PI + TAU * direction as f64 / DIRECTIONS as f64);
            [*visited, *seen] = self.around(&(at + Vector2::new(cos, sin) * ring.0), ring.1);
        }
    }

    /// The means over the cells around a point.
    fn around(&self, point: &Point2<f64>, reach: i32) -> [f32; 2] {
        let (middle, mut sums) = (self.frame.cell_at(point), [0.0; 2]);
        for cell in middle.square(reach) {
            let [visited, seen] = match self.frame.index(cell) {
                Some(index) => {
                    let visits = f32::from(self.visits[index]);
                    [visits / (visits + HALF), f32::from(u8::from(self.seen[index]))]
                }
                None => [1.0, 1.0],
            };
            sums = [sums[0] + visited, sums[1] + seen];
        }
        sums.map(|sum| sum / (2 * reach + 1).pow(2) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_memory_turns_with_the_robot() {
        let mut memory = Memory::new(&GridFrame::new(Point2::origin(), 0.1, 80, 80).unwrap());
        (0..20).for_each(|_| memory.note(&Point2::new(4.1, 4.1), None, &Isometry2::identity()));
        let layers = |heading_rad: f64| {
            let (mut visited, mut seen) = ([0.0; LAYER], [0.0; LAYER]);
            // The visited cell is 0.5 m above the robot.
            memory.write(&mut visited, &mut seen, &interfaces::pose(4.1, 3.6, heading_rad));
            (visited, seen)
        };
        // To the left of a robot that looks to the right, ahead of one that looks up.
        for (heading_rad, direction) in [(0.0, 12), (PI / 2.0, 8), (PI, 4), (-PI / 2.0, 0)] {
            let (visited, seen) = layers(heading_rad);
            assert_eq!(visited[direction], 0.5, "{heading_rad}");
            assert_eq!(visited[..DIRECTIONS].iter().sum::<f32>(), 0.5);
            assert!(seen.iter().all(|seen| *seen == 0.0));
        }
    }
}
