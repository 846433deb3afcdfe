//! The ground truth of every cell.

pub(super) mod cover;
mod open_share;
mod robots;
pub(super) mod start;
#[cfg(test)]
mod tests;

use super::report::Body;
use super::shape::Rectangle;
use interfaces::{
    Cell, GridFrame, GroundTruth, SparseCells, TrueChange, TrueState, Values, cell_runs, runs, value,
};
use nalgebra::Point2;
use open_share::Cover;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The ground truth of a physics world.
///
/// The body of the driven robot covers no cell: the robot never sees its own body, so that no map could represent
/// it. Walls and obstacles can cover a cell together. A robot covers a cell only alone, since solid bodies do not
/// overlap and leave a gap beside a round body.
///
/// The ground truth is updated in every physics step. The computing time is proportional to the number of cells
/// under the bodies that moved.
#[derive(Clone, Debug)]
pub struct PhysicsGroundTruth {
    frame: GridFrame,
    pub(super) elapsed_s: f64,
    states: Vec<TrueState>,
    /// The states that follow from walls and present obstacles alone.
    fixed: Vec<TrueState>,
    /// What moving things did to each cell: nothing to most of them.
    passages: SparseCells<Passages>,
    /// The cells under each robot, by index, and whether the robot covers all of the cell.
    under: Vec<Vec<(u32, bool)>>,
    /// Whether the cell has been free since it was last blocked, so that the next time is a new event.
    armed: Vec<bool>,
    /// The cells that have a mover, one bit each.
    swept: Vec<u64>,
    reach: Arc<Reach>,
    pub(super) changes: Vec<TrueChange>,
}

/// What moving things did to a cell so far, and do now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
struct Passages {
    /// The number of robots that overlap the cell, and the number of robots that cover all of the cell.
    overlapped: u16,
    covered: u16,
    block_events: u32,
    /// How often the cell was free and then overlapped.
    pass_events: u32,
    /// The first moving thing that touched the cell.
    mover: Option<Body>,
}

/// What the driven robot can reach and see: the same at all times, and shared by all copies.
#[derive(Debug)]
struct Reach {
    /// The cells that are connected with the start of the driven robot. Walls separate cells, obstacles do not.
    reachable: Vec<bool>,
    /// The cells that are reachable or share a side with a reachable cell. No other cell can be seen.
    may_be_seen: Vec<bool>,
}

impl PhysicsGroundTruth {
    /// The ground truth at the start: walls, and the region around `start` (m).
    pub(super) fn new(frame: GridFrame, walls: &[Rectangle], start: &Point2<f64>) -> Self {
        let fixed = start::walls_cover(&frame, walls);
        let reachable = start::reachable(&frame, &fixed, frame.cell_at(start));
        let may_be_seen = |index| reachable[index] || frame.beside(index).any(|side| reachable[side]);
        Self {
            frame,
            elapsed_s: 0.0,
            states: fixed.clone(),
            passages: SparseCells::in_blocks(frame.width(), frame.height(), Passages::default()),
            under: Vec::new(),
            armed: fixed.iter().map(|state| *state != TrueState::Blocked).collect(),
            swept: vec![0; frame.len().div_ceil(64)],
            reach: Arc::new(Reach { may_be_seen: (0..frame.len()).map(may_be_seen).collect(), reachable }),
            changes: Vec::new(),
            fixed,
        }
    }

    /// The first moving thing that touched a cell: another robot, or an obstacle that moves, appears or disappears.
    /// `None` for a static cell.
    pub fn mover(&self, index: usize) -> Option<Body> {
        self.passages[index].mover
    }

    /// The values that a snapshot holds; walls and the reachable cells follow from the spec.
    pub(super) fn values(&mut self) -> Values<'_> {
        vec![
            value(&mut self.elapsed_s),
            runs(&mut self.states),
            runs(&mut self.fixed),
            cell_runs(&mut self.passages, usize::MAX),
            value(&mut self.under),
            runs(&mut self.armed),
            runs(&mut self.swept),
            value(&mut self.changes),
        ]
    }

    /// Updates the cells of an obstacle that has appeared or disappeared. `boxes` are the walls and obstacles that
    /// are present now; `by` is the obstacle if it is a moving thing. Returns the cells that the obstacle
    /// covers, completely or partly.
    pub(super) fn change_box(&mut self, at: &Rectangle, boxes: &[Rectangle], by: Option<Body>) -> Vec<Cell> {
        let mut cells = Vec::new();
        let near = boxes.iter().filter(|other| may_meet(at, other)).copied();
        self.update_under(at, Cover::new(&self.frame, near), by, |cell| cells.push(cell), |_| false);
        cells
    }

    /// Updates the cells of an obstacle that moved from `from` to `to`. `boxes` are the walls and obstacles that
    /// are present now.
    pub(super) fn move_box(&mut self, from: &Rectangle, to: &Rectangle, boxes: &[Rectangle], mover: Body) {
        let near = |shape: &Rectangle| {
            let near = boxes.iter().enumerate().filter(|(_, other)| may_meet(shape, other));
            near.map(|(index, _)| index).collect::<Vec<_>>()
        };
        let [near_before, near_after] = [from, to].map(near);
        let is_same = near_before == near_after;
        let [was, is] = [near_before, near_after]
            .map(|near| Cover::new(&self.frame, near.into_iter().map(|index| boxes[index])));
        self.update_under(from, was, Some(mover), |_| (), |_| false);
        // Most cells were under the shape before as well, and are known already.
        let known = cover::BoxTest::new(&self.frame, from);
        self.update_under(to, is, Some(mover), |_| (), |center| is_same && known.covers(center).is_some());
    }

    /// Updates the cells under `shape` where `is_known` does not hold for the center.
    fn update_under(
        &mut self,
        shape: &Rectangle,
        mut cover: Cover,
        mover: Option<Body>,
        mut visit: impl FnMut(Cell),
        is_known: impl Fn(&Point2<f64>) -> bool,
    ) {
        let frame = self.frame;
        cover::box_cells(&frame, shape, |index, _| {
            let cell = frame.cell(index);
            visit(cell);
            if let Some(body) = mover {
                self.sweep(index, body);
            }
            if !is_known(&frame.center(cell)) {
                self.fixed[index] = cover.state(&frame, cell);
                self.settle(index);
            }
        });
    }

    /// A moving thing touches a cell.
    fn sweep(&mut self, index: usize, body: Body) {
        let (word, bit) = (&mut self.swept[index / 64], 1 << (index % 64));
        if *word & bit == 0 {
            *word |= bit;
            self.passages[index].mover = Some(body);
        }
    }

    /// Ends the setup: the states at the start are not events.
    pub(super) fn begin(&mut self) {
        self.changes = Vec::new();
        let (width, height) = (self.frame.width(), self.frame.height());
        let before =
            std::mem::replace(&mut self.passages, SparseCells::in_blocks(width, height, Passages::default()));
        // Without the blocks in which only the setup counted something.
        for (index, passages) in before.stored() {
            self.passages.set(index, Passages { block_events: 0, pass_events: 0, ..*passages });
        }
        for (armed, state) in self.armed.iter_mut().zip(&self.states) {
            *armed = *state != TrueState::Blocked;
        }
    }

    /// Updates the state of a cell, and counts the event if the state has changed.
    fn settle(&mut self, index: usize) {
        let before = self.states[index];
        let Passages { overlapped, covered, .. } = self.passages[index];
        let after = match self.fixed[index] {
            TrueState::Blocked => TrueState::Blocked,
            _ if covered > 0 => TrueState::Blocked,
            TrueState::Free if overlapped == 0 => TrueState::Free,
            _ => TrueState::PartlyCovered,
        };
        if before == after {
            return;
        }
        self.states[index] = after;
        if before == TrueState::Free {
            self.passages[index].pass_events += 1;
        }
        match after {
            TrueState::Free => self.armed[index] = true,
            TrueState::Blocked if self.armed[index] => {
                self.armed[index] = false;
                self.passages[index].block_events += 1;
            }
            TrueState::Blocked | TrueState::PartlyCovered => {}
        }
        let cell = self.frame.cell(index);
        self.changes.push(TrueChange { time: self.elapsed_s, cell, before, after });
    }
}

impl GroundTruth for PhysicsGroundTruth {
    fn frame(&self) -> &GridFrame {
        &self.frame
    }

    fn elapsed(&self) -> f64 {
        self.elapsed_s
    }

    fn state(&self, index: usize) -> TrueState {
        self.states[index]
    }

    fn can_be_seen(&self, index: usize) -> bool {
        match self.states[index] {
            _ if !self.reach.may_be_seen[index] => false,
            TrueState::Free => self.reach.reachable[index],
            TrueState::PartlyCovered => false,
            TrueState::Blocked => {
                let is_open =
                    |side: usize| self.states[side] != TrueState::Blocked && self.reach.reachable[side];
                self.frame.beside(index).any(is_open)
            }
        }
    }

    /// A cell that is blocked, becomes partly covered and is blocked again without being free in between counts as
    /// blocked once.
    fn block_events(&self, index: usize) -> u32 {
        self.passages[index].block_events
    }

    fn pass_events(&self, index: usize) -> u32 {
        // A cell that was partly covered at the start can be blocked without having been free.
        let Passages { pass_events, block_events, .. } = self.passages[index];
        pass_events.max(block_events)
    }

    fn predicted_events(&self, index: usize) -> u32 {
        match self.mover(index) {
            Some(Body::Obstacle(_)) => self.pass_events(index),
            _ => self.block_events(index),
        }
    }

    fn is_swept(&self, index: usize) -> bool {
        self.swept[index / 64] >> (index % 64) & 1 == 1
    }

    fn swept(&self) -> Cow<'_, [usize]> {
        let count: u32 = self.swept.iter().map(|word| word.count_ones()).sum();
        let mut cells = Vec::with_capacity(count as usize);
        for (at, word) in self.swept.iter().enumerate() {
            let mut rest = *word;
            while rest != 0 {
                cells.push(64 * at + rest.trailing_zeros() as usize);
                rest &= rest - 1; // without its lowest bit
            }
        }
        cells.into()
    }

    /// Obstacles first, then robots, each in the order of the world file.
    fn moving_things(&self) -> Cow<'_, [Vec<usize>]> {
        let mut things: BTreeMap<Body, Vec<usize>> = BTreeMap::new();
        for &index in &*self.swept() {
            if let Some(body) = self.mover(index) {
                things.entry(body).or_default().push(index);
            }
        }
        things.into_values().collect()
    }

    fn changes(&self) -> &[TrueChange] {
        &self.changes
    }
}

/// Whether the upright boxes around two rectangles overlap.
fn may_meet(a: &Rectangle, b: &Rectangle) -> bool {
    let ((a_low, a_high), (b_low, b_high)) = (a.bounds(), b.bounds());
    (a_high - b_low).min() > 0.0 && (b_high - a_low).min() > 0.0
}
