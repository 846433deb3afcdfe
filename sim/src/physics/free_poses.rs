//! Random poses at which a robot fits.

use super::fleet::Fleet;
use super::free_space::FreeSpace;
use super::spec::FleetSpec;
use interfaces::{GridFrame, RandomStream};
use nalgebra::{Isometry2, Point2};
use std::f64::consts::PI;

/// The number of poses that are tried where others stand.
const ATTEMPTS: usize = 100;

/// Draws poses in the free space that is connected with a place.
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

    /// A pose at such a point with any heading, at which the robot (by index) fits in `fleet` as it is now; `None` if
    /// others stand at each of a hundred such poses, or if there is no such robot.
    pub fn draw(&self, fleet: &Fleet, robot: usize, random: &mut RandomStream) -> Option<Isometry2<f64>> {
        let mut poses = (0..ATTEMPTS).map(|_| {
            let at = self.draw_point(random);
            interfaces::pose(at.x, at.y, random.uniform(-PI..PI))
        });
        poses.find(|pose| fleet.check_fit(robot, pose).is_ok())
    }
}
