//! What is believed and what was seen of every cell. The occupancy models write here; everything
//! that is read of the map is read from here.

mod figures;
mod recency;
mod record;
mod sight;
mod survival;
mod turn;

use crate::Estimator;
use crate::gaps::{Gaps, Regularity};
use interfaces::{Cell, CellState, Grid, GridFrame, Transition};
use recency::Recency;
use record::Record;
use survival::Survival;

/// A reading by its number. Number 0 stands for "never", and its time, 0, is when a cell that was
/// never seen counts as last seen. Number 1 stands for the prior map, also at time 0; no cell counts
/// as last seen in it, so that no first reading follows without a gap.
pub(crate) type ReadingIndex = u32;
const NEVER: ReadingIndex = 0;
const PRIOR: ReadingIndex = 1;

/// The belief of every cell, its change statistics, and the running features over them.
#[derive(Clone, Debug)]
pub(crate) struct Ledger {
    estimator: Estimator,
    /// A time without a sighting up to this does not interrupt the view of a cell.
    max_gap: f64,
    states: Grid<CellState>,
    times: Vec<f64>,
    /// The last sighting of every cell, with the mark [`sight::UNSETTLED`].
    sightings: Vec<ReadingIndex>,
    records: Vec<Record>,
    /// The gaps of every cell; empty if the estimator does not weigh them.
    gaps: Vec<Gaps>,
    regularity: Regularity,
    survival: Survival,
    transitions: Vec<Transition>,
    /// Cells that can be a goal, or are a surface that can be seen again.
    candidates: Vec<bool>,
    recency: Recency,
}

impl Ledger {
    pub(crate) fn new(prior: Grid<CellState>, estimator: Estimator, max_gap: f64) -> Self {
        let cells = prior.frame().len();
        let mut ledger = Self {
            estimator,
            max_gap,
            states: prior,
            times: vec![0.0, 0.0],
            sightings: vec![NEVER | sight::UNSETTLED; cells],
            records: vec![Record::default(); cells],
            gaps: if estimator.weighs_gaps() { vec![Gaps::default(); cells] } else { Vec::new() },
            regularity: Regularity::default(),
            survival: Survival::default(),
            transitions: Vec::new(),
            candidates: vec![false; cells],
            recency: Recency::default(),
        };
        for index in 0..cells {
            if ledger.state(index) != CellState::Unknown {
                ledger.records[index] = Record::since(PRIOR);
            }
            ledger.judge_candidate(index);
        }
        ledger
    }

    /// Opens the next reading and gives its number.
    pub(crate) fn open(&mut self, time: f64) -> ReadingIndex {
        self.transitions.clear();
        self.times.push(time);
        self.recency.open();
        self.now_index()
    }

    #[inline]
    pub(crate) fn now_index(&self) -> ReadingIndex {
        (self.times.len() - 1) as ReadingIndex
    }

    #[inline]
    pub(crate) fn now(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    pub(crate) fn readings(&self) -> usize {
        (self.now_index() - PRIOR) as usize
    }

    pub(crate) fn frame(&self) -> &GridFrame {
        self.states.frame()
    }

    pub(crate) fn states(&self) -> &Grid<CellState> {
        &self.states
    }

    #[inline]
    pub(crate) fn state(&self, index: usize) -> CellState {
        self.states.cells()[index]
    }

    pub(crate) fn transitions(&self) -> &[Transition] {
        &self.transitions
    }

    pub(crate) fn estimator(&self) -> Estimator {
        self.estimator
    }

    #[inline]
    pub(crate) fn is_candidate(&self, index: usize) -> bool {
        self.candidates[index]
    }

    /// A cell is a candidate when it is free, or touches a free cell by a side: a frontier cell or
    /// a surface. The inside of a wall never is.
    fn judge_candidate(&mut self, index: usize) {
        let frame = self.states.frame();
        let is_free = |cell: Cell| self.states.get(cell) == Some(&CellState::Free);
        let cell = frame.cell(index);
        let is = is_free(cell) || cell.neighbours4().into_iter().any(is_free);
        if is != self.candidates[index] {
            self.candidates[index] = is;
            self.recency.count(self.last(index), is);
        }
    }
}
