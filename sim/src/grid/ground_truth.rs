use super::spec::{GridSpec, parts};
use interfaces::{Cell, GridFrame, GroundTruth, TrueChange, TrueState};
use std::borrow::Cow;

/// The ground truth of a grid world.
/// A step ends when the robot and all blocks have moved. A change is a difference between the ends of two steps: if
/// one block leaves a cell and another block enters it in the same step, the cell does not change. The robot does
/// not block any cell.
///
/// The computing time of a step is proportional to the number of blocks that move.
#[derive(Clone, Debug)]
pub struct GridGroundTruth {
    frame: GridFrame,
    time: u64,
    cells: Vec<CellTruth>,
    /// The cells that are connected with the start of the robot. Walls separate cells, blocks do not.
    reachable: Vec<bool>,
    swept: Vec<usize>,
    things: Vec<Vec<usize>>,
    /// The changes in the last step.
    changes: Vec<TrueChange>,
}

/// The state of a cell and its history.
#[derive(Clone, Copy, Debug, Default)]
struct CellTruth {
    is_blocked: bool,
    is_swept: bool,
    block_events: u32,
}

impl GridGroundTruth {
    /// The ground truth at the start.
    pub(super) fn new(spec: &GridSpec) -> Self {
        let frame = *spec.frame();
        let wall = |is_blocked: &bool| CellTruth { is_blocked: *is_blocked, ..CellTruth::default() };
        let mut cells: Vec<CellTruth> = spec.walls.cells().iter().map(wall).collect();
        let index = |cell: &Cell| frame.index(*cell);
        let mut things = Vec::new();
        for block in &spec.blocks {
            if let Some(start) = block.path.get(block.start()).and_then(index) {
                cells[start].is_blocked = true;
            }
            things.push(sorted(block.path.iter().filter_map(index).collect()));
        }
        let swept = sorted(things.concat());
        for &index in &swept {
            cells[index].is_swept = true;
        }
        let reachable = parts::connected(&spec.walls, spec.start);
        Self { frame, time: 0, cells, reachable, swept, things, changes: Vec::new() }
    }

    /// Whether a wall or a block is in a cell.
    #[inline]
    pub fn is_blocked(&self, index: usize) -> bool {
        self.cells[index].is_blocked
    }

    /// Applies a step in which blocks `moved` from cell to cell. `is_blocked` returns the present state of a cell.
    pub(super) fn update(&mut self, moved: &[(Cell, Cell)], is_blocked: impl Fn(Cell) -> bool) {
        self.time += 1;
        self.changes.clear();
        for cell in moved.iter().flat_map(|(from, to)| [*from, *to]) {
            let Some(index) = self.frame.index(cell) else { continue };
            let (is_blocked, truth) = (is_blocked(cell), &mut self.cells[index]);
            if truth.is_blocked == is_blocked {
                continue;
            }
            truth.is_blocked = is_blocked;
            truth.block_events += u32::from(is_blocked);
            let (before, after) = (state(!is_blocked), state(is_blocked));
            self.changes.push(TrueChange { time: self.time as f64, cell, before, after });
        }
    }
}

impl GroundTruth for GridGroundTruth {
    fn frame(&self) -> &GridFrame {
        &self.frame
    }

    fn elapsed(&self) -> f64 {
        self.time as f64
    }

    #[inline]
    fn state(&self, index: usize) -> TrueState {
        state(self.is_blocked(index))
    }

    fn can_be_seen(&self, index: usize) -> bool {
        if !self.is_blocked(index) {
            return self.reachable[index];
        }
        self.frame.beside(index).any(|side| !self.is_blocked(side) && self.reachable[side])
    }

    #[inline]
    fn block_events(&self, index: usize) -> u32 {
        self.cells[index].block_events
    }

    #[inline]
    fn is_swept(&self, index: usize) -> bool {
        self.cells[index].is_swept
    }

    fn swept(&self) -> Cow<'_, [usize]> {
        Cow::Borrowed(&self.swept)
    }

    /// The cells of the path of every block, in the order of the world file.
    fn moving_things(&self) -> Cow<'_, [Vec<usize>]> {
        Cow::Borrowed(&self.things)
    }

    fn changes(&self) -> &[TrueChange] {
        &self.changes
    }
}

fn state(is_blocked: bool) -> TrueState {
    if is_blocked { TrueState::Blocked } else { TrueState::Free }
}

fn sorted(mut indices: Vec<usize>) -> Vec<usize> {
    indices.sort_unstable();
    indices.dedup();
    indices
}
