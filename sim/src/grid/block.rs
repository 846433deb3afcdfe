use super::luck::{Luck, Whose};
use super::spec::{BlockSpec, Course};
use interfaces::Cell;

/// A block on its way.
#[derive(Clone, Debug)]
pub(super) struct Block {
    path: Vec<Cell>,
    course: Course,
    dwell: u32,
    /// The place of its cell in `path`.
    at: usize,
    /// Whether it goes on by counting down. Never on a loop.
    is_returning: bool,
    /// Steps on this cell, up to `dwell`.
    stood: u32,
    luck: Luck,
}

impl Block {
    pub(super) fn new(spec: &BlockSpec, index: usize, chance: f64, seed: u64) -> Self {
        Self {
            path: spec.path.clone(),
            course: spec.course,
            dwell: spec.dwell,
            at: 0,
            is_returning: false,
            stood: spec.stood,
            luck: Luck::new(seed, Whose::Block(index), chance),
        }
    }

    /// Where it is now.
    pub(super) fn cell(&self) -> Cell {
        self.path[self.at]
    }

    /// A step passes. Moves on if it is due and lucky and the way is free; returns whence and
    /// where to.
    #[inline]
    pub(super) fn step(&mut self, is_free: impl FnOnce(Cell) -> bool) -> Option<(Cell, Cell)> {
        self.stood = (self.stood + 1).min(self.dwell);
        if self.stood < self.dwell || !self.luck.happens() {
            return None;
        }
        let (next, is_returning) = self.next();
        let (from, to) = (self.cell(), self.path[next]);
        is_free(to).then(|| {
            (self.at, self.is_returning, self.stood) = (next, is_returning, 0);
            (from, to)
        })
    }

    /// The place of the next cell, and whether it counts down from then on.
    fn next(&self) -> (usize, bool) {
        let last = self.path.len() - 1;
        match self.course {
            Course::Loop if self.at == last => (0, false),
            Course::Loop => (self.at + 1, false),
            Course::BackAndForth if self.at == 0 => (1, false),
            Course::BackAndForth if self.at == last => (last - 1, true),
            Course::BackAndForth if self.is_returning => (self.at - 1, true),
            Course::BackAndForth => (self.at + 1, false),
        }
    }
}
