//! Something that comes and goes as a whole, and what looks at it say.

use crate::Growth;
use crate::change::{CellMap, Evidence};
use crate::look_counts::LookCounts;
use interfaces::CellState;

/// A cell counts as blocked in this share of a number of looks before the first one: while its thing is away, and while it is there.
const PRIOR: [f64; 2] = [0.03, 0.9];
const PRIOR_LOOKS: f64 = 4.0;
/// The probability of a cell says no more than this, however often it was seen: maps err.
const SURE: f64 = 0.03;
/// Cells near each other err together: all of those in view say at most as much as this number of them.
const INDEPENDENT: f64 = 4.0;
/// A look says whether the thing is there if this is more than so many times as probable as the contrary, in the logarithm.
const MIN_LOG_ODDS: f64 = 4.0;
/// A thing has come or gone when looks have said so for this time, s.
const LASTING_S: f64 = 1.0;
/// In a look at this number of cells, some are blocked if more than the first share is, and most if more than the second share is.
const PART_CELLS: f64 = 5.0;
const PART: [f64; 2] = [0.15, 0.6];
/// What stays for a shorter time on average is traffic, s.
const MIN_STAY_S: f64 = 6.0;
/// What came and went this number of times, or stayed for this time, s, is no person who stands still for a while.
const SURE_CHANGES: u64 = 3;
const STANDS_S: f64 = 60.0;
/// It stays in view between two looks that are at most this far apart, s.
const MAX_GAP_S: f64 = 2.5;

/// Looks that say that the thing has come or gone.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
struct Doubt {
    since_s: f64,
    last_s: f64,
}

/// Something that comes and goes as a whole: a toy, a chair, a box.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(crate) struct Object {
    /// Its cells, by their index, with the looks at them while it was away, and while it was there.
    cells: Vec<(u32, [LookCounts; 2])>,
    pub(super) is_there: bool,
    /// The time of the last look, s.
    pub(super) last_s: f64,
    doubt: Option<Doubt>,
    /// The number of looks in which some of its cells were blocked, and in which most of them were.
    parts: [u32; 2],
    pub(super) evidence: Evidence,
}

impl Object {
    /// An object that has just come or gone: by its cells that changed, with the looks at the one that is known best.
    pub(super) fn new(cells: &[u32], is_there: bool, map: &CellMap) -> Self {
        let known_s = |cell: &&u32| map.evidence(**cell as usize).known_s();
        let best = cells.iter().max_by(|a, b| known_s(a).total_cmp(&known_s(b)).then(b.cmp(a)));
        let best = best.map_or(0, |cell| *cell as usize);
        let mut object = Self {
            cells: Vec::new(),
            is_there,
            last_s: map.last_seen(best),
            doubt: None,
            parts: [0; 2],
            evidence: map.evidence(best),
        };
        object.add(cells);
        object
    }

    /// Adds cells that have turned out to belong to it.
    pub(super) fn add(&mut self, cells: &[u32]) {
        for &cell in cells {
            if let Err(at) = self.position(cell) {
                self.cells.insert(at, (cell, Default::default()));
            }
        }
    }

    /// Takes over another object that is the same one, and keeps the longer record.
    pub(super) fn join(&mut self, other: Self) {
        for (cell, counts) in other.cells {
            if let Err(at) = self.position(cell) {
                self.cells.insert(at, (cell, counts));
            }
        }
        if other.evidence.known_s() > self.evidence.known_s() {
            (self.evidence, self.is_there, self.last_s) = (other.evidence, other.is_there, other.last_s);
        }
    }

    /// Its cells, in ascending order.
    pub(super) fn cells(&self) -> impl ExactSizeIterator<Item = u32> {
        self.cells.iter().map(|(cell, _)| *cell)
    }

    fn position(&self, cell: u32) -> Result<usize, usize> {
        self.cells.binary_search_by_key(&cell, |(cell, _)| *cell)
    }

    /// The probability that one of its cells is blocked, while the object is away, and while it is there.
    pub(super) fn shares(&self, cell: u32) -> Option<[f64; 2]> {
        Some(shares(self.cells[self.position(cell).ok()?].1))
    }

    /// Learns from the open reading. `is_doubted`: whether it speaks against the state of a cell in the map. Returns whether it
    /// shows anything of the object.
    pub(super) fn observe(&mut self, map: &CellMap, is_doubted: impl Fn(usize) -> bool) -> bool {
        let now_s = map.time();
        let (mut seen, mut blocked, mut log_odds) = (0.0, 0.0, 0.0);
        for (cell, counts) in &self.cells {
            let index = *cell as usize;
            if !map.is_seen_now(index) {
                continue;
            }
            let is_blocked = (map.state(index) == CellState::Blocked) != is_doubted(index);
            let [away, there] =
                shares(*counts).map(|share| if is_blocked { share } else { 1.0 - share }.max(SURE));
            seen += 1.0;
            blocked += f64::from(u8::from(is_blocked));
            log_odds += libm::log(there / away);
        }
        if seen >= PART_CELLS && blocked > PART[0] * seen {
            self.parts[usize::from(blocked > PART[1] * seen)] += 1;
        }
        let log_odds = log_odds * f64::min(1.0, INDEPENDENT / seen);
        if seen == 0.0 || log_odds.abs() < MIN_LOG_ODDS {
            return false;
        }
        if self.doubt.is_some_and(|doubt| now_s - doubt.last_s > MAX_GAP_S) {
            self.settle();
        }
        let is_there = log_odds > 0.0;
        if is_there == self.is_there {
            self.doubt = None;
            self.look(now_s, is_there);
            self.learn_shares(map, is_doubted);
            return true;
        }
        let doubt = self.doubt.get_or_insert(Doubt { since_s: now_s, last_s: now_s });
        doubt.last_s = now_s;
        if now_s - doubt.since_s < LASTING_S {
            return true;
        }
        self.settle();
        self.learn_shares(map, is_doubted);
        true
    }

    /// Takes looks that say that the object has come or gone as true: they have lasted, or the view ended with them.
    fn settle(&mut self) {
        if let Some(Doubt { since_s, last_s }) = self.doubt.take() {
            let is_there = !self.is_there;
            self.look(since_s, is_there);
            self.look(last_s, is_there);
        }
    }

    /// Whether it was there at the last look, and the time of that, s.
    pub(super) fn last_look(&self) -> (bool, f64) {
        self.doubt.map_or((self.is_there, self.last_s), |doubt| (!self.is_there, doubt.last_s))
    }

    /// A look that shows whether the object is there.
    fn look(&mut self, time_s: f64, is_there: bool) {
        let (before, length_s) = (self.is_there, (time_s - self.last_s).max(0.0));
        (self.is_there, self.last_s) = (is_there, time_s);
        if length_s > MAX_GAP_S {
            return self.evidence.gap(before, is_there, length_s);
        }
        self.evidence.watch(before, length_s);
        if is_there != before {
            self.evidence.change(before);
        }
    }

    /// Counts the cells in view that are blocked.
    fn learn_shares(&mut self, map: &CellMap, is_doubted: impl Fn(usize) -> bool) {
        for (cell, counts) in &mut self.cells {
            let index = *cell as usize;
            if map.is_seen_now(index) && !is_doubted(index) {
                counts[usize::from(self.is_there)].add(map.state(index) == CellState::Blocked);
            }
        }
    }

    /// Whether this is a thing, and not people who pass: they stay for a moment, cover a part of the cells at a time, and change them
    /// more often than anything comes and goes. Somebody who stands still is told apart when he has gone and does not come back.
    pub(super) fn is_thing(&self, map: &CellMap) -> bool {
        let (stayed_s, went) = self.evidence.stays();
        let changes = u64::from(self.evidence.changes());
        let of_cells: u64 = self.cells().map(|cell| u64::from(map.statistics(cell as usize).events())).sum();
        let of_all = changes * self.cells.len() as u64;
        (changes >= SURE_CHANGES || stayed_s >= STANDS_S)
            && stayed_s >= MIN_STAY_S * f64::from(went)
            && self.parts[0] <= self.parts[1]
            && (of_all / 3..=of_all).contains(&of_cells)
    }

    pub(super) fn grow(&mut self, growth: &Growth) {
        self.cells.iter_mut().for_each(|(cell, _)| *cell = growth.index(*cell as usize) as u32);
    }
}

fn shares(counts: [LookCounts; 2]) -> [f64; 2] {
    [0, 1].map(|state| counts[state].share(PRIOR[state], PRIOR_LOOKS))
}
