//! What is believed and what was seen of every cell. The occupancy models write here; everything
//! that is read of the map is read from here.

mod recency;
mod record;
mod survival;

use crate::chain::Chain;
use crate::gaps::{GapTable, Regularity, Watch};
use crate::{CellStatistics, Estimator, GapWorth};
use geometry::{Cell, CellState, Grid, GridFrame, Transition};
use recency::Recency;
use record::{Record, place};
use std::num::NonZeroU32;
use survival::Survival;

/// A reading by its number. Number 0 stands for "never", and its time, 0, is when a cell that was
/// never seen counts as last seen. Number 1 stands for the prior map, also at time 0; no cell counts
/// as last seen in it, so that no first reading follows without a gap.
pub(crate) type ReadingIndex = u32;
const NEVER: ReadingIndex = 0;
const PRIOR: ReadingIndex = 1;
/// Set in the number of a cell's last sighting while the cell needs a closer look at every
/// sighting; see [`Ledger::see_run`].
const UNSETTLED: ReadingIndex = 1 << 31;
/// Cells that [`Ledger::see_run`] takes at once.
const BLOCK: usize = 16;

/// The belief of every cell, its change statistics, and the running features over them.
#[derive(Clone, Debug)]
pub(crate) struct Ledger {
    estimator: Estimator,
    /// A time without a sighting up to this does not interrupt the view of a cell.
    max_gap: f64,
    states: Grid<CellState>,
    times: Vec<f64>,
    /// The last sighting of every cell, with the mark [`UNSETTLED`].
    sightings: Vec<ReadingIndex>,
    records: Vec<Record>,
    /// The gaps of every cell; empty if the estimator does not weigh them.
    gaps: Vec<GapTable>,
    regularity: Regularity,
    /// in view moves of the open reading
    moves: Vec<(u32, Option<ReadingIndex>)>,
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
            sightings: vec![NEVER | UNSETTLED; cells],
            records: vec![Record::default(); cells],
            gaps: if estimator.weighs_gaps() { vec![GapTable::default(); cells] } else { Vec::new() },
            regularity: Regularity::default(),
            moves: Vec::new(),
            survival: Survival::default(),
            transitions: Vec::new(),
            candidates: vec![false; cells],
            recency: Recency::new(),
        };
        for index in 0..cells {
            if ledger.state(index) != CellState::Unknown {
                ledger.records[index] = Record { first: PRIOR, since: PRIOR, ..Record::default() };
            }
            ledger.judge_candidate(index);
        }
        ledger
    }

    /// Opens the next reading and gives its number.
    pub(crate) fn open(&mut self, time: f64) -> ReadingIndex {
        self.transitions.clear();
        self.moves.clear();
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

    #[inline]
    pub(crate) fn is_candidate(&self, index: usize) -> bool {
        self.candidates[index]
    }

    /// Whether the cell was in view when the open reading came: it was seen in the one before, or not
    /// longer ago than the gap that does not count as one.
    #[inline]
    pub(crate) fn is_in_view(&self, index: usize) -> bool {
        let (now, last) = (self.now_index(), self.last(index));
        if last == now {
            return self.records[index].since < now; // its watch did not begin just now
        }
        last + 1 == now
            || self.max_gap > 0.0 && last > PRIOR && self.now() - self.times[last as usize] <= self.max_gap
    }

    #[inline]
    pub(crate) fn was_seen_now(&self, index: usize) -> bool {
        self.last(index) == self.now_index()
    }

    /// The cell was observed in the open reading. Writes one number where the cell was in view
    /// before; only at a gap is the time up to the gap booked.
    #[inline]
    pub(crate) fn see(&mut self, index: usize) {
        let (now, last) = (self.now_index(), self.last(index));
        if last == now {
            return;
        }
        if !self.is_in_view(index) {
            let state = self.state(index);
            self.end_gap(index, state);
            self.fit_gaps(index);
        }
        self.mark(index, last, now);
    }

    /// Notes that the open reading saw the cell.
    #[inline]
    fn mark(&mut self, index: usize, last: ReadingIndex, now: ReadingIndex) {
        self.sightings[index] = now | self.sightings[index] & UNSETTLED;
        if self.candidates[index] {
            self.recency.moved(last, now);
        }
        if last + 1 < now
            && let Some(slot) = self.records[index].slot()
        {
            self.survival.came_back(slot);
        }
    }

    /// The reading that last saw the cell.
    #[inline]
    fn last(&self, index: usize) -> ReadingIndex {
        self.sightings[index] & !UNSETTLED
    }

    /// Marks a cell as simply free, or as one to look at closer.
    #[inline]
    pub(crate) fn set_settled(&mut self, index: usize, is_settled: bool) {
        let last = self.last(index);
        self.sightings[index] = if is_settled { last } else { last | UNSETTLED };
    }

    /// The cells of one row from `start` to `end` (places in row-major order) were seen through in
    /// the open reading. Where they are settled, and were in view before, one number per cell
    /// changes; the others are listed in `closer`. Most of a scan is of the first kind, so it goes
    /// block by block, without a branch per cell.
    #[inline]
    pub(crate) fn see_run(&mut self, start: usize, end: usize, closer: &mut Vec<u32>) {
        let now = self.now_index();
        let mut again = 0;
        let mut block_start = start;
        for block in self.sightings[start..end].chunks_mut(BLOCK) {
            // No early exit: the comparison of a whole block vectorises.
            if block.len() == BLOCK && block.iter().fold(true, |all, &last| all & (last == now - 1)) {
                block.fill(now);
                again += BLOCK as u32;
            } else {
                for (offset, last) in block.iter_mut().enumerate() {
                    if *last == now - 1 {
                        *last = now;
                        again += 1;
                    } else if *last != now {
                        closer.push((block_start + offset) as u32);
                    }
                }
            }
            block_start += BLOCK;
        }
        // A settled cell is free, and a free cell is a candidate.
        self.recency.seen_again(again);
    }

    /// The cell takes another state. `since` is the reading in which the new state was first
    /// seen, and `in_view` says whether the old one was still seen in the reading before that:
    /// then the change happened in view, else it was found after a gap.
    pub(crate) fn turn(&mut self, index: usize, after: CellState, since: ReadingIndex, in_view: bool) {
        let (before, now) = (self.state(index), self.now_index());
        let is_event = before != CellState::Unknown && self.records[index].is_known();
        if self.last(index) < now && !self.is_in_view(index) {
            self.end_gap(index, after);
            self.mark(index, self.last(index), now);
        } else if is_event && let Some(table) = self.gaps.get_mut(index) {
            table.correct_last(since, after == CellState::Blocked);
        }
        let last = self.last(index);
        let period = self.period(last);
        let record = &mut self.records[index];
        if is_event {
            if !record.has_changed() {
                record.slot = NonZeroU32::new(self.survival.add(index) + 1);
            }
            // The time since the new state was first seen belongs to the new state.
            let until = since.clamp(record.since, last.max(record.since));
            let stayed = self.times[until as usize] - self.times[record.since as usize];
            let event = place(before); // free → blocked is a block event, blocked → free a free event
            record.watched[event] += stayed;
            if let Some(table) = self.gaps.get_mut(index)
                && in_view
                && record.is_whole
                && period > 0.0
            {
                table.add_stay(event, stayed / period, &mut self.regularity);
            }
            if in_view && (after == CellState::Blocked || record.is_whole) {
                let stood_from = (after != CellState::Blocked).then_some(record.since + 1);
                self.moves.push((index as u32, stood_from));
            }
            record.is_whole = in_view;
            record.since = until;
            if in_view { record.in_view[event] += 1 } else { record.after_gap[event] += 1 }
        }
        let cell = self.frame().cell(index);
        self.transitions.push(Transition { cell, before, after });
        self.states.cells_mut()[index] = after;
        if after == CellState::Blocked {
            self.set_settled(index, false);
        }
        self.see(index);
        self.fit_gaps(index);
        self.judge_candidate(index);
        for neighbour in cell.neighbours4() {
            if let Some(neighbour) = self.frame().index(neighbour) {
                self.judge_candidate(neighbour);
            }
        }
    }

    /// hidden moves
    pub(crate) fn infer_moves(&mut self) {
        if self.gaps.is_empty() { return; }
        if *crate::gaps::tune::INFER == 0.0 { return; }
        let now = self.now_index();
        let period = self.period(now);
        for position in 0..self.moves.len() {
            let (index, stood_from) = self.moves[position];
            let cell = self.frame().cell(index as usize);
            match stood_from {
                None => for near in cell.neighbours4() {
                    let Some(near) = self.frame().index(near) else { continue };
                    if self.state(near) == CellState::Blocked && self.last(near) + 1 == now && self.records[near].is_known() {
                        self.gaps[near].left(now);
                    }
                },
                Some(from) => for near in cell.neighbours8() {
                    let Some(near) = self.frame().index(near) else { continue };
                    if self.last(near) == now && period > 0.0 && *crate::gaps::tune::INFER > 1.0 {
                        self.gaps[near].unhide(from, now, period);
                    }
                },
            }
        }
    }

    /// Whether the cell is still in the state of its first sighting, which was not that of a prior map,
    /// and was watched in it for less than `confirm` (in the unit of the readings' times).
    pub(crate) fn is_unconfirmed(&self, index: usize, confirm: f64) -> bool {
        let seen = self.statistics(index);
        self.records[index].first > PRIOR && seen.events() == 0 && seen.observed() < confirm
    }

    /// The first sighting of the cell was wrong: nothing changed, it was `after` all along.
    pub(crate) fn correct(&mut self, index: usize, after: CellState) {
        let now = self.now_index();
        self.see(index);
        self.records[index] = Record { first: now, since: now, ..Record::default() };
        if let Some(table) = self.gaps.get_mut(index) {
            *table = GapTable::default();
        }
        let (cell, before) = (self.frame().cell(index), self.state(index));
        self.transitions.push(Transition { cell, before, after: CellState::Unknown });
        self.states.cells_mut()[index] = CellState::Unknown;
        self.turn(index, after, now, false);
    }

    /// The cell is seen again after a gap, or for the first time: books what was seen before.
    fn end_gap(&mut self, index: usize, after: CellState) {
        let (before, last, now) = (self.state(index), self.last(index), self.now_index());
        let record = &mut self.records[index];
        if record.is_known() {
            let times = &self.times;
            record.watched[place(before)] += times[last as usize] - times[record.since as usize];
            record.gaps[place(before)] += 1;
            let period = if now > PRIOR + 1 { (times[now as usize] - times[PRIOR as usize + 1]) / f64::from(now - PRIOR - 1) } else { 0.0 };
            if let Some(table) = self.gaps.get_mut(index) {
                let length = times[now as usize] - times[last as usize];
                table.add([last, now], length, [before, after].map(|state| state == CellState::Blocked), times[now as usize] - times[last as usize + 1], period);
            }
        } else {
            record.first = now;
        }
        record.since = now;
        record.is_whole = false;
    }

    /// Lets the estimator weigh the gaps of a cell that changes, when enough has been seen since it
    /// last did.
    fn fit_gaps(&mut self, index: usize) {
        if self.gaps.is_empty() || !self.records[index].has_changed() {
            return;
        }
        let seen = self.statistics(index);
        if !self.gaps[index].is_due(&seen) {
            return;
        }
        let radius = *crate::gaps::tune::RADIUS as i32;
        let cell = self.frame().cell(index);
        let mut near = Watch::default();
        for y in -radius..=radius { for x in -radius..=radius {
            if x == 0 && y == 0 { continue; }
            if let Some(k) = self.frame().index(Cell::new(cell.x + x, cell.y + y)) { near = near + self.gaps[k].own(); }
        }}
        self.gaps[index].weigh(self.estimator, &seen, near, &self.regularity);
    }

    /// A cell is a candidate when it is free, or touches a free cell by a side: a frontier cell or
    /// a surface. The inside of a wall never is.
    fn judge_candidate(&mut self, index: usize) {
        let frame = self.states.frame();
        let is_free = |cell: Cell| self.states.get(cell) == Some(&CellState::Free);
        let cell = frame.cell(index);
        let is = is_free(cell) || cell.neighbours4().into_iter().any(is_free);
        if is == self.candidates[index] {
            return;
        }
        self.candidates[index] = is;
        self.recency.count(self.last(index), is);
    }

    /// The feature r of section 4: the longest time since a candidate was seen.
    pub(crate) fn max_recency(&mut self) -> f64 {
        self.recency.longest().map_or(0.0, |reading| self.now() - self.times[reading as usize])
    }

    /// The feature p of section 4: the expected number of cells that changed since they were
    /// seen. Costs time in proportion to the cells that ever changed.
    pub(crate) fn sum_change_probability(&mut self) -> f64 {
        let mut survival = std::mem::take(&mut self.survival);
        let sum = survival.sum_changed(self.now(), |index| {
            let is_out_of_view = !self.was_seen_now(index);
            is_out_of_view.then(|| (self.last_seen(index), self.estimator.rate(&self.statistics(index))))
        });
        self.survival = survival;
        sum
    }

    /// The places of the cells that ever changed, in the order of their first change.
    pub(crate) fn changed(&self) -> impl Iterator<Item = usize> {
        self.survival.cells().iter().map(|&index| index as usize)
    }

    pub(crate) fn estimator(&self) -> Estimator {
        self.estimator
    }

    #[inline]
    pub(crate) fn last_seen(&self, index: usize) -> f64 {
        self.times[self.last(index) as usize]
    }

    /// The mean time from one reading to the next up to one of them; 0 before the second.
    fn period(&self, until: ReadingIndex) -> f64 {
        let first = PRIOR + 1;
        if until <= first {
            return 0.0;
        }
        (self.times[until as usize] - self.times[first as usize]) / f64::from(until - first)
    }

    /// The two-state chain of the cell, if it has a rate.
    pub(crate) fn chain(&self, index: usize) -> Option<Chain> {
        self.estimator.chain(&self.statistics(index))
    }

    /// The probability that the cell is blocked now.
    pub(crate) fn blocked_probability(&self, index: usize) -> f64 {
        let state = self.state(index);
        let is_certain = self.was_seen_now(index) && state != CellState::Unknown;
        match self.chain(index).filter(|_| !is_certain) {
            Some(chain) => chain.blocked_probability(state, self.now() - self.last_seen(index)),
            None => match state {
                CellState::Unknown => 0.5,
                CellState::Free => 0.0,
                CellState::Blocked => 1.0,
            },
        }
    }

    pub(crate) fn ever_seen(&self, index: usize) -> bool {
        self.last(index) != NEVER
    }

    pub(crate) fn statistics(&self, index: usize) -> CellStatistics {
        let record = &self.records[index];
        if !record.is_known() {
            return CellStatistics::default();
        }
        let last = self.last(index);
        let (first_seen, last_seen) = (self.times[record.first as usize], self.times[last as usize]);
        let mut watched = record.watched;
        watched[place(self.state(index))] += last_seen - self.times[record.since as usize];
        let [watched_free, watched_blocked] = watched;
        let period = self.period(last);
        CellStatistics {
            first_seen,
            last_seen,
            period,
            unobserved: (last_seen - first_seen - watched_free - watched_blocked).max(0.0),
            watched_free,
            watched_blocked,
            block_events: record.in_view[0],
            free_events: record.in_view[1],
            block_events_after_gap: record.after_gap[0],
            free_events_after_gap: record.after_gap[1],
            gaps_from_free: record.gaps[0],
            gaps_from_blocked: record.gaps[1],
            gap_worth: self.gaps.get(index).map_or(GapWorth::default(), |table| table.worth(period)),
        }
    }
}
