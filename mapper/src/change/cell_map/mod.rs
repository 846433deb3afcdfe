//! The state and the change statistics of every cell. Occupancy models write here.

mod last_seen;
mod observing;
mod queries;
mod record;
mod records;
mod saved;
mod shared;
mod state_change;

use super::EstimatorChoice;
use super::gaps::{CellGaps, Regularity};
use super::reading_times::{NEVER, PRIOR, ReadingIndex, ReadingTimes};
use crate::change::shared_cells::SharedCells;
use interfaces::{CellState, Grid, SparseCells, Transition};
use last_seen::LastSeenCounts;
use record::{Flags, Record};
use records::Records;
use shared::SharedPrior;

/// The index of a cell among the cells that ever changed.
pub(crate) type Slot = u32;

/// The state and the change statistics of every cell.
///
/// An [occupancy model](crate::OccupancyModel) decides which cells a reading observed and which cells changed their
/// state, and writes both with [`observe`](Self::observe) and [`set_state`](Self::set_state). All statistics follow
/// from these calls. Cells are addressed by their index in row-major order. An index outside of the map causes a
/// panic.
#[derive(Clone, Debug)]
pub struct CellMap {
    pub(crate) estimator: EstimatorChoice,
    /// A cell stays in view during a time without an observation if this time is at most `max_gap`.
    max_gap: f64,
    /// No cell was in view before this reading: the last one without an observation, because its pose was not certain.
    interrupted: ReadingIndex,
    states: Grid<CellState>,
    times: ReadingTimes,
    /// For each cell the last reading that observed it, with the mark [`observing::UNSETTLED`].
    observed: SparseCells<ReadingIndex>,
    records: Records,
    /// The gaps of every cell; none if the estimator has no model of gaps.
    gaps: SharedCells<CellGaps>,
    /// The memory that gaps own elsewhere, bytes.
    gap_bytes: usize,
    regularity: Regularity,
    /// The prior that all traversable cells share; `None` if the estimator has none.
    shared: Option<SharedPrior>,
    /// The cells that ever changed, in the order of their first change.
    pub(crate) changed: Vec<u32>,
    /// The cells of `changed` that came back into view with the open reading.
    pub(crate) returned: Vec<Slot>,
    pub(crate) transitions: Vec<Transition>,
    flags: SparseCells<Flags>,
    last_seen_counts: LastSeenCounts,
    /// Whether only cells near those that were seen can be seen: the memory is used up.
    pub(crate) is_full: bool,
}

impl CellMap {
    /// What a known cell of a prior map takes, bytes.
    pub(crate) const BYTES_PER_KNOWN_CELL: usize =
        records::BYTES_PER_CELL + size_of::<ReadingIndex>() + size_of::<Flags>() + size_of::<CellState>();

    pub(crate) fn new(prior: Grid<CellState>, estimator: EstimatorChoice, max_gap: f64) -> Self {
        let frame = *prior.frame();
        let shared = estimator.shares_prior().then(|| SharedPrior::new(&frame));
        let known: Vec<usize> =
            prior.cells().other_than(CellState::Unknown).map(|(index, _)| index).collect();
        let mut map = Self {
            estimator,
            max_gap,
            interrupted: NEVER,
            states: prior,
            times: ReadingTimes::default(),
            observed: SparseCells::new(frame.width(), frame.height(), NEVER | observing::UNSETTLED),
            records: Records::new(&frame),
            gaps: SharedCells::new(&frame),
            gap_bytes: 0,
            regularity: Regularity::default(),
            shared,
            changed: Vec::new(),
            returned: Vec::new(),
            transitions: Vec::new(),
            flags: SparseCells::new(frame.width(), frame.height(), Flags::default()),
            last_seen_counts: LastSeenCounts::default(),
            is_full: false,
        };
        for index in known {
            map.records.set(index, Record::since(PRIOR));
            map.update_candidates_around(index);
        }
        map
    }

    /// Opens the next reading.
    pub(crate) fn open(&mut self, time: f64) {
        self.prepare();
        self.times.push(time);
    }

    fn prepare(&mut self) {
        self.transitions.clear();
        self.returned.clear();
        if self.times.is_full() {
            self.forget_times();
        }
        self.renew_prior();
        self.last_seen_counts.open();
    }

    /// Opens a reading that observes no cell, and ends the view of all cells.
    pub(crate) fn interrupt(&mut self, time: f64) {
        self.open(time);
        self.interrupted = self.reading();
    }

    /// Opens a reading that observes no cell, a step before the first reading after a pause between two sessions.
    pub(crate) fn pause(&mut self, until: f64) {
        let (last, period) = (self.time(), self.times.period(self.reading()));
        self.prepare();
        self.times.push_after_pause((until - period).max(last));
        self.interrupted = self.reading();
    }

    /// Forgets the times of readings that no cell refers to any more.
    fn forget_times(&mut self) {
        let seen = self.observed.stored_values().map(|last| last & !observing::UNSETTLED);
        self.times.forget(seen.chain(self.records.readings()));
    }

    /// A cell is a candidate if it is free, or shares a side with a free cell (a frontier cell or a surface). The
    /// inside of a wall never is a candidate.
    fn update_candidate(&mut self, index: usize) {
        let is = self.is_free_or_beside(index);
        if is != self.flags[index].is_candidate {
            self.flags[index].is_candidate = is;
            self.last_seen_counts.count(self.last_reading(index), is);
        }
    }

    /// The same for a cell and those beside it.
    fn update_candidates_around(&mut self, index: usize) {
        self.update_candidate(index);
        for neighbor in self.frame().beside(index) {
            self.update_candidate(neighbor);
        }
    }
}
