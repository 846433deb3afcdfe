//! Where a robot can drive.

use super::form::Form;
use super::ground_truth::cover;
use super::shape::Rectangle;
use super::spec::{FleetSpec, Motion, ObstacleSpec};
use crate::flood::flood;
use interfaces::{GridFrame, RandomStream};
use nalgebra::Point2;

/// The cells around whose center the disc of a robot fits, divided into connected regions. Doors are open, obstacles
/// that stand at the start are at their start, and robots, things with a schedule and other moving things are away.
#[derive(Clone, Debug)]
pub struct FreeSpace {
    frame: GridFrame,
    /// The region of each cell; `None` where the disc does not fit.
    regions: Vec<Option<usize>>,
    /// The area of each region, m².
    areas_m2: Vec<f64>,
}

impl FreeSpace {
    /// The free space of a disc of `radius_m` in a world.
    pub fn new(spec: &FleetSpec, radius_m: f64) -> Self {
        let frame = spec.frame;
        let cell_m2 = frame.resolution_m() * frame.resolution_m();
        let mut regions = vec![None; frame.len()];
        let counts = divide(&frame, &fits(&frame, &solids(spec), radius_m), &mut regions, 0);
        Self { frame, regions, areas_m2: counts.into_iter().map(|count| count as f64 * cell_m2).collect() }
    }

    /// The region of each cell of the frame; `None` where the disc does not fit.
    pub fn regions(&self) -> &[Option<usize>] {
        &self.regions
    }

    /// The area of each region, m².
    pub fn areas_m2(&self) -> &[f64] {
        &self.areas_m2
    }

    /// The largest region with a cell that overlaps the disc of `radius_m` around `at` (m); `None` without such a cell.
    /// With the radius of a robot this is the region of a robot that stands there: the center of the robot need not be
    /// the center of a cell.
    pub fn region_near(&self, at: &Point2<f64>, radius_m: f64) -> Option<usize> {
        let mut found: Option<usize> = None;
        cover::form_cells(&self.frame, &Form::Disc { center: *at, radius_m }, |index, _| {
            let is_larger =
                |region: &usize| found.is_none_or(|found| self.areas_m2[*region] > self.areas_m2[found]);
            found = self.regions[index].filter(is_larger).or(found);
        });
        found
    }
}

/// Whether a disc of `radius_m` around the center of each cell keeps clear of all rectangles.
pub(super) fn fits(frame: &GridFrame, solids: &[Rectangle], radius_m: f64) -> Vec<bool> {
    let mut is_free = vec![true; frame.len()];
    for solid in solids {
        let near = Rectangle { half_m: solid.half_m.add_scalar(radius_m), ..*solid };
        cover::box_cells(frame, &near, |index, _| {
            is_free[index] &= solid.distance_m(&frame.center(frame.cell(index))) >= radius_m;
        });
    }
    is_free
}

/// Divides the free cells that have no region yet into connected regions, numbered from `first` on. Returns the number of cells
/// of each.
pub(super) fn divide(
    frame: &GridFrame,
    is_free: &[bool],
    regions: &mut [Option<usize>],
    first: usize,
) -> Vec<usize> {
    let mut counts = Vec::new();
    for index in 0..frame.len() {
        let region = Some(first + counts.len());
        let enter = |index: usize| {
            let is_new = is_free[index] && regions[index].is_none();
            if is_new {
                regions[index] = region;
            }
            is_new
        };
        let count = flood(frame, frame.cell(index), enter);
        if count > 0 {
            counts.push(count);
        }
    }
    counts
}

/// The walls, and the obstacles that stand there when the robots start, unless they move away by themselves.
pub(super) fn solids(spec: &FleetSpec) -> Vec<Rectangle> {
    let stays = |obstacle: &&ObstacleSpec| {
        obstacle.appears_s.is_none() && !matches!(obstacle.motion, Motion::Path(_) | Motion::Scheduled(_))
    };
    let standing = spec.obstacles.iter().filter(stays).map(ObstacleSpec::opened);
    spec.walls.iter().copied().chain(standing).collect()
}

// Where a robot fits.

/// The free space that is connected with a place; [`Fleet::draw_pose`](crate::physics::Fleet::draw_pose) draws poses in it.
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
