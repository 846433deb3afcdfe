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
    cells: Vec<usize>,
}

impl FreePoses {
    /// The poses that a robot (by index) of a world can reach from its start while doors are open; `None` if there is no
    /// such robot, or if there is none. A robot with corners counts as the circle around it.
    pub fn reachable(spec: &FleetSpec, robot: usize) -> Option<Self> {
        let robot = spec.robots.get(robot)?;
        let space = FreeSpace::new(spec, robot.radius_m);
        let region = space.region_near(&robot.pose.translation.vector.into(), robot.radius_m)?;
        let cells = space.regions().iter().enumerate();
        let cells = cells.filter(|(_, of)| **of == Some(region)).map(|(index, _)| index).collect();
        Some(Self { frame: spec.frame, cells })
    }

    /// The cells around whose center the robot fits, by index in row-major order; at least one.
    pub fn cells(&self) -> &[usize] {
        &self.cells
    }

    /// Whether a point (m) lies in one of these cells.
    pub(super) fn contain(&self, at: &Point2<f64>) -> bool {
        self.frame.index(self.frame.cell_at(at)).is_some_and(|cell| self.cells.binary_search(&cell).is_ok())
    }

    /// A point, m: the center of a cell, each with the same probability. Moving things may be there.
    pub fn draw_point(&self, random: &mut RandomStream) -> Point2<f64> {
        let index = random.uniform(0.0..self.cells.len() as f64) as usize;
        self.frame.center(self.frame.cell(self.cells[index.min(self.cells.len() - 1)]))
    }
}
