use crate::{Cell, GridFrame};
use std::borrow::Cow;

/// The true state of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Deserialize, serde::Serialize)]
pub enum TrueState {
    /// No solid body overlaps the cell. A body that only touches the border of the cell does not overlap the cell.
    #[default]
    Free,
    /// Solid bodies cover a part of the cell. Metrics leave out such a cell.
    PartlyCovered,
    /// Solid bodies cover the whole cell.
    Blocked,
}

/// A change of the true state of a cell.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct TrueChange {
    /// The time of the change: seconds, or steps in a grid world.
    pub time: f64,
    /// The cell that changed.
    pub cell: Cell,
    /// The state before the change.
    pub before: TrueState,
    /// The state after the change.
    pub after: TrueState,
}

/// The true state of a simulated world, cell by cell: the reference of every metric. No localizer, mapper, agent or
/// controller may read it.
///
/// Cells are addressed by their index in row-major order of [`GroundTruth::frame`]. The body of the robot that
/// explores is not part of the ground truth and covers no cell.
pub trait GroundTruth {
    /// The position and the size of the grid of cells.
    fn frame(&self) -> &GridFrame;

    /// The time since the start of the world: seconds, or steps in a grid world.
    fn elapsed(&self) -> f64;

    /// The state of a cell now.
    fn state(&self, index: usize) -> TrueState;

    /// Whether the robot could see a cell now: the cell is free, or is blocked and shares a side with a cell that
    /// is not blocked; and no wall separates the cell from the start of the robot.
    fn can_be_seen(&self, index: usize) -> bool;

    /// The number of times that a cell has become blocked so far.
    fn block_events(&self, index: usize) -> u32;

    /// The true cycle rate of a cell so far: block events per unit of time; 0 at time 0.
    fn cycle_rate(&self, index: usize) -> f64 {
        per_time(self.block_events(index), self.elapsed())
    }

    /// The number of times that a free cell was covered so far, completely or partly: the block events, and the
    /// passes that covered only a part of the cell. A sensor may count such a pass or not.
    fn pass_events(&self, index: usize) -> u32 {
        self.block_events(index)
    }

    /// The cycle rate of a cell so far if every pass counts, see [`GroundTruth::pass_events`]: not below
    /// [`GroundTruth::cycle_rate`].
    fn pass_rate(&self, index: usize) -> f64 {
        per_time(self.pass_events(index), self.elapsed())
    }

    /// The number of events so far that a rate map predicts: the block events; where an obstacle such as the leaf of a door
    /// first touched the cell, all passes. A leaf is thinner than the diagonal of a cell, and covers most cells only in part.
    fn predicted_events(&self, index: usize) -> u32 {
        self.block_events(index)
    }

    /// Whether any moving thing has touched a cell (physics world) or can enter it (grid world).
    fn is_swept(&self, index: usize) -> bool;

    /// The swept cells, sorted by index.
    fn swept(&self) -> Cow<'_, [usize]> {
        (0..self.frame().len()).filter(|&index| self.is_swept(index)).collect()
    }

    /// For every moving thing, the cells that the thing has swept, sorted by index. In a physics world a cell
    /// belongs to the first thing that touched the cell; in a grid world, to every block whose path contains the
    /// cell.
    fn moving_things(&self) -> Cow<'_, [Vec<usize>]>;

    /// The changes since the last command, in order of time.
    fn changes(&self) -> &[TrueChange];
}

/// Events per unit of time; 0 at time 0.
fn per_time(events: u32, elapsed: f64) -> f64 {
    if elapsed > 0.0 { f64::from(events) / elapsed } else { 0.0 }
}
