//! What a grid world is made of: plain values in cells and steps.
//!
//! [`super::GridWorld`] takes a spec as it is: it checks no ranges. The crate `worldfile` makes specs from texts,
//! and checks them.

pub(super) mod parts;

use interfaces::{Cell, Grid, GridFrame};

/// A grid world.
#[derive(Clone, Debug, PartialEq)]
pub struct GridSpec {
    /// The name of the world.
    pub name: String,
    /// What the world shows, in a sentence or two; can be empty.
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
    /// The probability per step that a block moves once its dwell is over; above 0, at most 1.
    pub block_probability: f64,
    /// The probability that an action of the robot happens; above 0, at most 1.
    pub robot_probability: f64,
}

/// A block that moves from cell to cell along its path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockSpec {
    /// The name.
    pub name: String,
    /// The time on every cell, steps; 1 to [`BlockSpec::MAX_DWELL`].
    pub dwell: u32,
    /// The time already spent on the first cell at the start, steps; below `dwell`.
    pub stood: u32,
    /// The continuation at the end of the path.
    pub course: Course,
    /// The cells of the path, at least two, none of them a wall; the block starts on the first. Consecutive cells
    /// share a side, and so do the last and the first of a loop.
    pub path: Vec<Cell>,
}

/// The continuation at the end of the path of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Course {
    /// With the first cell.
    Loop,
    /// Back along the path.
    BackAndForth,
}

impl BlockSpec {
    /// The largest dwell, steps: a block with a longer one would not move in any practical run.
    pub const MAX_DWELL: u32 = 1_000_000;
}

impl GridSpec {
    /// The largest range of a sensor, in cells.
    pub const MAX_SENSOR_RADIUS: u32 = 100;

    /// The cells of the world.
    pub fn frame(&self) -> &GridFrame {
        self.walls.frame()
    }

    /// Probable mistakes in a valid world: a sentence for every part of the map that the robot cannot reach, named by
    /// its lowest, leftmost cell and its size.
    pub fn warnings(&self) -> Vec<String> {
        parts::warnings(&self.walls, self.start)
    }

    /// The same world with another sensor; the radius is clamped to 1 to [`GridSpec::MAX_SENSOR_RADIUS`] cells.
    #[must_use]
    pub fn with_sensor_radius(self, sensor_radius: u32) -> Self {
        Self { sensor_radius: sensor_radius.clamp(1, Self::MAX_SENSOR_RADIUS), ..self }
    }

    /// The same world with other probabilities for blocks and the robot, clamped to above 0 and at most 1; NaN
    /// becomes the least.
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
