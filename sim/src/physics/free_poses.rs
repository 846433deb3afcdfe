//! Where a robot fits.

use super::free_space::FreeSpace;
use super::spec::FleetSpec;
use interfaces::{GridFrame, RandomStream};
use nalgebra::Point2;

/// The free space that is connected with a place; [`Fleet::draw_pose`](super::Fleet::draw_pose) draws poses in it.
#[derive(Clone, Debug)]
pub struct FreePoses {
    frame: GridFrame,
    /// The cells around whose center the robot fits, in row-major order: runs of cells that follow each other.
    runs: Vec<Run>,
    len: usize,
}

/// Some cells that follow each other.
#[derive(Clone, Copy, Debug)]
struct Run {
    first: u32,
    /// The number of cells in the runs before.
    before: u32,
}

impl FreePoses {
    /// The poses that a robot (by index) of a world can reach from its start while doors are open; `None` if there is no
    /// such robot, or if there is none. A robot with corners counts as the circle around it.
    pub fn reachable(spec: &FleetSpec, robot: usize) -> Option<Self> {
        let robot = spec.robots.get(robot)?;
        let space = FreeSpace::new(spec, robot.radius_m);
        let region = space.region_near(&robot.pose.translation.vector.into(), robot.radius_m)?;
        let (mut runs, mut len, mut is_before) = (Vec::new(), 0, false);
        for (index, of) in space.regions().iter().enumerate() {
            let is_in = *of == Some(region);
            if is_in && !is_before {
                runs.push(Run { first: index as u32, before: len as u32 });
            }
            len += usize::from(is_in);
            is_before = is_in;
        }
        Some(Self { frame: spec.frame, runs, len })
    }

    /// The number of cells around whose center the robot fits; at least one.
    #[allow(clippy::len_without_is_empty)] // there is always one
    pub fn len(&self) -> usize {
        self.len
    }

    /// One of these cells, by index in row-major order; they are in this order.
    pub fn cell(&self, number: usize) -> usize {
        let run = self.runs.partition_point(|run| run.before as usize <= number) - 1;
        let Run { first, before } = self.runs[run];
        first as usize + number - before as usize
    }

    /// All of these cells.
    pub fn cells(&self) -> impl Iterator<Item = usize> {
        let ends = self.runs.iter().skip(1).map(|run| run.before as usize).chain([self.len]);
        let runs = self.runs.iter().zip(ends);
        runs.flat_map(|(run, end)| {
            let first = run.first as usize;
            first..first + end - run.before as usize
        })
    }

    /// Whether a point (m) lies in one of these cells.
    pub(super) fn contain(&self, at: &Point2<f64>) -> bool {
        let Some(cell) = self.frame.index(self.frame.cell_at(at)) else { return false };
        let after = self.runs.partition_point(|run| run.first as usize <= cell);
        let end = self.runs.get(after).map_or(self.len, |next| next.before as usize);
        after.checked_sub(1).is_some_and(|run| {
            let Run { first, before } = self.runs[run];
            cell - (first as usize) < end - before as usize
        })
    }

    /// A point, m: the center of a cell, each with the same probability. Moving things may be there.
    pub fn draw_point(&self, random: &mut RandomStream) -> Point2<f64> {
        let number = random.uniform(0.0..self.len as f64) as usize;
        self.frame.center(self.frame.cell(self.cell(number.min(self.len - 1))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::WorldSpec;

    #[test]
    fn runs_are_the_cells() {
        let spec = WorldSpec::generate_house(3);
        let (fleet, robot) = (spec.fleet(), spec.driven_index());
        let free = FreePoses::reachable(fleet, robot).unwrap();
        let space = FreeSpace::new(fleet, fleet.robots[robot].radius_m);
        let cells: Vec<usize> = free.cells().collect();
        let region = space.regions()[cells[0]];
        let expected = (0..fleet.frame.len()).filter(|&index| space.regions()[index] == region);
        assert_eq!(cells, expected.collect::<Vec<_>>());
        assert_eq!(cells, (0..free.len()).map(|number| free.cell(number)).collect::<Vec<_>>());
        let contained = |index: &usize| free.contain(&fleet.frame.center(fleet.frame.cell(*index)));
        assert_eq!((0..fleet.frame.len()).filter(contained).collect::<Vec<_>>(), cells);
        assert!(free.runs.len() < cells.len() / 10, "{} runs of {} cells", free.runs.len(), cells.len());
    }
}
