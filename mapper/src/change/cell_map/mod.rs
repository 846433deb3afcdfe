//! The state and the change statistics of every cell. Occupancy models write here.

mod last_seen;
mod observing;
mod queries;
mod record;
mod saved;
mod shared;
mod state_change;

use super::EstimatorChoice;
use super::gaps::{CellGaps, GapHistogram, Regularity};
use super::reading_times::{NEVER, PRIOR, ReadingIndex, ReadingTimes};
use crate::change::shared_cells::SharedCells;
use interfaces::{CellState, Grid, Transition};
use last_seen::LastSeenCounts;
use record::{Flags, Record};
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
    observed: Vec<ReadingIndex>,
    records: Vec<Record>,
    /// The gaps of every cell; empty if the estimator has no model of gaps.
    gaps: SharedCells<CellGaps>,
    regularity: Regularity,
    /// The prior that all traversable cells share; `None` if the estimator has none.
    shared: Option<SharedPrior>,
    /// The cells that ever changed, in the order of their first change.
    pub(crate) changed: Vec<u32>,
    /// The cells of `changed` that came back into view with the open reading.
    pub(crate) returned: Vec<Slot>,
    pub(crate) transitions: Vec<Transition>,
    flags: Vec<Flags>,
    last_seen_counts: LastSeenCounts,
}

impl CellMap {
    /// The memory of a cell that was seen, bytes; a cell that changed takes some hundred bytes more.
    pub(crate) const BYTES_PER_CELL: usize = size_of::<CellState>()
        + size_of::<ReadingIndex>()
        + size_of::<Record>()
        + size_of::<CellGaps>()
        + GapHistogram::FIRST_BYTES
        + size_of::<f32>() // the mean of its prior
        + size_of::<Flags>();

    pub(crate) fn new(prior: Grid<CellState>, estimator: EstimatorChoice, max_gap: f64) -> Self {
        let cells = prior.frame().len();
        let gaps = SharedCells::new(if estimator.gap_model().is_some() { cells } else { 0 });
        let shared = estimator.shares_prior().then(|| SharedPrior::new(cells));
        let mut map = Self {
            estimator,
            max_gap,
            interrupted: NEVER,
            states: prior,
            times: ReadingTimes::default(),
            observed: vec![NEVER | observing::UNSETTLED; cells],
            records: vec![Record::default(); cells],
            gaps,
            regularity: Regularity::default(),
            shared,
            changed: Vec::new(),
            returned: Vec::new(),
            transitions: Vec::new(),
            flags: vec![Flags::default(); cells],
            last_seen_counts: LastSeenCounts::default(),
        };
        for index in 0..cells {
            if map.state(index) != CellState::Unknown {
                map.records[index] = Record::since(PRIOR);
            }
            map.update_candidate(index);
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
        let seen = self.observed.iter().map(|last| last & !observing::UNSETTLED);
        let known = self.records.iter().flat_map(|record| [record.first, record.since]);
        self.times.forget(seen.chain(known));
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
}
