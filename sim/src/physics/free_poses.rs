//! Where a robot fits.

use super::free_space::FreeSpace;
use super::spec::FleetSpec;
use interfaces::{GridFrame, RandomStream};
use nalgebra::Point2;

/// The free space that is connected with a place; [`Fleet::draw_pose`](super::Fleet::draw_pose) draws poses in it.
#[derive(Clone, Debug)]
pub struct FreePoses {
    frame: GridFrame,
    /// The cells around whose center the robot fits, in row-major order.
    cells: Vec<u32>,
}

impl FreePoses {
    /// The poses that a robot (by index) of a world can reach from its start while doors are open; `None` if there is no
    /// such robot, or if there is none. A robot with corners counts as the circle around it.
    pub fn reachable(spec: &FleetSpec, robot: usize) -> Option<Self> {
        let robot = spec.robots.get(robot)?;
        let space = FreeSpace::new(spec, robot.radius_m);
        let region = space.region_near(&robot.pose.translation.vector.into(), robot.radius_m)?;
        let all = (0..).zip(space.regions());
        let cells = all.filter(|(_, of)| **of == Some(region)).map(|(index, _)| index).collect();
        Some(Self { frame: spec.frame, cells })
    }

    /// The number of cells around whose center the robot fits; at least one.
    #[allow(clippy::len_without_is_empty)] // there is always one
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// One of these cells, by index in row-major order; they are in this order.
    pub fn cell(&self, number: usize) -> usize {
        self.cells[number] as usize
    }

    /// All of these cells.
    pub fn cells(&self) -> impl Iterator<Item = usize> {
        self.cells.iter().map(|cell| *cell as usize)
    }

    /// Whether a point (m) lies in one of these cells.
    pub(super) fn contain(&self, at: &Point2<f64>) -> bool {
        let cell = self.frame.index(self.frame.cell_at(at));
        cell.is_some_and(|cell| self.cells.binary_search(&(cell as u32)).is_ok())
    }

    /// A point, m: the center of a cell, each with the same probability. Moving things may be there.
    pub fn draw_point(&self, random: &mut RandomStream) -> Point2<f64> {
        let number = random.uniform(0.0..self.len() as f64) as usize;
        self.frame.center(self.frame.cell(self.cell(number.min(self.len() - 1))))
    }
}
