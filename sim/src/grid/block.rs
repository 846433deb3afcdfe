use super::spec::{BlockSpec, Course};
use interfaces::{Cell, Purpose, RandomStream};

/// A block and its state.
#[derive(Clone, Debug)]
pub(super) struct Block {
    path: Vec<Cell>,
    course: Course,
    dwell: u32,
    /// The index of its cell in `path`.
    at: usize,
    /// Whether the index counts down. Never on a loop.
    is_returning: bool,
    /// Steps on this cell, up to `dwell`.
    stood: u32,
    /// The probability that a due move happens in a step.
    probability: f64,
    random: RandomStream,
}

impl Block {
    pub(super) fn new(spec: &BlockSpec, index: usize, probability: f64, seed: u64) -> Self {
        Self {
            path: spec.path.clone(),
            course: spec.course,
            dwell: spec.dwell,
            at: 0,
            is_returning: false,
            stood: spec.stood,
            probability,
            random: RandomStream::new(seed, Purpose::BlockTransition(index)),
        }
    }

    /// The cell of the block now.
    pub(super) fn cell(&self) -> Cell {
        self.path[self.at]
    }

    /// Does one step. The block moves on if the move is due, happens and leads to a free cell. Returns the cells
    /// before and after a move.
    #[inline]
    pub(super) fn step(&mut self, is_free: impl FnOnce(Cell) -> bool) -> Option<(Cell, Cell)> {
        self.stood = (self.stood + 1).min(self.dwell);
        if self.stood < self.dwell || !self.random.bernoulli(self.probability) {
            return None;
        }
        let (next, is_returning) = self.next();
        let (from, to) = (self.cell(), self.path[next]);
        is_free(to).then(|| {
            (self.at, self.is_returning, self.stood) = (next, is_returning, 0);
            (from, to)
        })
    }

    /// The index of the next cell, and whether the index counts down from then on.
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
