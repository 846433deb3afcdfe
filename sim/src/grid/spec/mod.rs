//! The specification of a grid world: plain values in cells and steps.
//!
//! [`super::GridWorld`] does not check the ranges of a spec. The crate `worldfile` makes specs from texts, and
//! checks them.

pub(super) mod parts;

use calendar::Schedule;
use interfaces::{Cell, Grid, GridFrame};

/// The specification of a grid world.
#[derive(Clone, Debug, PartialEq)]
pub struct GridSpec {
    /// The name of the world.
    pub name: String,
    /// What the world is for, in one or two sentences; can be empty.
    pub description: String,
    /// Which cells are walls; cells of 1 m, with `[0, 0]` at the origin.
    pub walls: Grid<bool>,
    /// The blocks, in the order in which they move. No two of them start on one cell.
    pub blocks: Vec<BlockSpec>,
    /// The cell where the robot starts: no wall, and no block's first cell.
    pub start: Cell,
    /// The range of the sensor between the centers of cells, in cells; 1 to
    /// [`GridSpec::MAX_SENSOR_RADIUS`].
    pub sensor_radius: u32,
    /// The probability per step that a block moves once its dwell is over; above 0, at most 1. A block with a schedule keeps to its
    /// calendar, whatever this probability is.
    pub block_probability: f64,
    /// The probability that an action of the robot happens; above 0, at most 1.
    pub robot_probability: f64,
    /// The calendar of the world; `None` without one. Blocks with a schedule need it.
    pub calendar: Option<GridCalendar>,
}

/// How the steps of a grid world relate to local civil time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridCalendar {
    /// The time of the week at the start, s since Monday 0:00.
    pub starts_s: f64,
    /// The time of a step, s.
    pub step_s: f64,
}

/// A block that moves from cell to cell along its path.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockSpec {
    /// The name of the block.
    pub name: String,
    /// The dwell: the time on every cell, steps; 1 to [`BlockSpec::MAX_DWELL`].
    pub dwell: u32,
    /// The time that has already been spent on the first cell at the start, steps; below `dwell`.
    pub stood: u32,
    /// How the block continues at the end of its path.
    pub course: Course,
    /// The cells of the path, at least two, none of them a wall; the block starts on the first. Consecutive cells
    /// share a side, and so do the last and the first of a loop.
    pub path: Vec<Cell>,
    /// When the block is on its first cell (blocked), or on the last one (free), in place of `dwell` and `course`: it moves
    /// there one cell per step.
    pub schedule: Option<Box<Schedule>>,
}

/// How a block continues at the end of its path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Course {
    /// The block continues with the first cell.
    Loop,
    /// The block goes back along the path.
    BackAndForth,
}

impl BlockSpec {
    /// The maximum dwell, steps: a block with a longer dwell would not move in any practical run.
    pub const MAX_DWELL: u32 = 1_000_000;

    /// The index of the cell of its path on which the block starts.
    pub fn start(&self) -> usize {
        match &self.schedule {
            Some(schedule) if !schedule.starts_blocked => self.path.len().saturating_sub(1),
            _ => 0,
        }
    }
}

impl GridSpec {
    /// The maximum range of a sensor, cells.
    pub const MAX_SENSOR_RADIUS: u32 = 100;

    /// The position and the size of the grid.
    pub fn frame(&self) -> &GridFrame {
        self.walls.frame()
    }

    /// Probable mistakes in a valid world: one sentence for every part of the map that the robot cannot reach. The
    /// part is identified by its lowest, leftmost cell and its size.
    pub fn warnings(&self) -> Vec<String> {
        parts::warnings(&self.walls, self.start)
    }

    /// The same world with another range of the sensor, limited to 1 to [`GridSpec::MAX_SENSOR_RADIUS`] cells.
    #[must_use]
    pub fn with_sensor_radius(self, sensor_radius: u32) -> Self {
        Self { sensor_radius: sensor_radius.clamp(1, Self::MAX_SENSOR_RADIUS), ..self }
    }

    /// The same world with other probabilities for blocks without a schedule and the robot, limited to above 0 and at most 1; NaN
    /// becomes the smallest valid value.
    #[must_use]
    pub fn with_probabilities(self, block: f64, robot: f64) -> Self {
        let clamp = |value: f64| if value > 0.0 { value.min(1.0) } else { f64::MIN_POSITIVE };
        Self { block_probability: clamp(block), robot_probability: clamp(robot), ..self }
    }

    /// The map as a drawing: `#` wall, `.` free, `R` where the robot starts; the top row first.
    pub fn drawing(&self) -> String {
        let frame = self.frame();
        let mut drawing = String::with_capacity((frame.width() + 1) * frame.height());
        for y in (0..frame.height() as i32).rev() {
            for x in 0..frame.width() as i32 {
                let cell = Cell::new(x, y);
                drawing.push(match self.walls.get(cell) {
                    _ if cell == self.start => 'R',
                    Some(true) => '#',
                    _ => '.',
                });
            }
            drawing.push('\n');
        }
        drawing
    }
}
