//! How often something came into each spot, a square of half a meter.
//!
//! A body that passes changes many cells at about the same time, and one cell more than once. It counts once: a passage begins
//! when a cell becomes blocked in view in a spot where nothing was.

use crate::change_log::events;
use interfaces::{Cell, Event, GridFrame};
use mapper::Mapper;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// The side of a spot, m.
pub(super) const SIDE_M: f64 = 0.5;
/// What blocks a spot without a change for this time, s, is no longer the body that came.
const FORGOTTEN_S: f64 = 30.0;

/// A cell or a spot, counted from the origin of the map's coordinates: the same in a map that has grown.
pub(super) type Key = Cell;

/// The key of a cell.
pub(super) fn cell_key(frame: &GridFrame, index: usize) -> Key {
    let (at, cell_m) = (frame.center(frame.cell(index)), frame.resolution_m());
    // Centers are at multiples of half a cell: a quarter keeps them away from the edges, whatever their last bits are.
    let number = |length_m: f64| (length_m / cell_m + 0.25).floor() as i32;
    Cell::new(number(at.x), number(at.y))
}

/// The key of the spot of a cell.
pub(super) fn spot_key(frame: &GridFrame, index: usize) -> Key {
    let side = (SIDE_M / frame.resolution_m()).round().max(1.0) as i32;
    let Cell { x, y } = cell_key(frame, index);
    Cell::new(x.div_euclid(side), y.div_euclid(side))
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
struct Tally {
    /// The passages before the present session, and in it.
    passages: [u32; 2],
    /// The number of cells that are blocked by what came.
    blocked: u32,
    #[serde(with = "interfaces::serde_time")]
    last_s: f64,
}

/// What is known of a spot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Spot {
    pub(super) key: Key,
    /// The passages before the present session, and in it.
    pub(super) passages: [u32; 2],
    /// The passages before the present session in all spots.
    pub(super) before_in_all: u32,
    /// The time in view, mean over its cells that changed, s.
    pub(super) observed_s: f64,
}

impl Spot {
    /// The passages of all sessions.
    pub(super) fn all(&self) -> u32 {
        self.passages.iter().sum()
    }
}

/// The passages of every spot.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub(super) struct Passages {
    spots: BTreeMap<Key, Tally>,
    /// The number of changes of each cell that were found after a gap.
    after_gap: BTreeMap<Key, u32>,
}

impl Passages {
    /// The passages of a map whose passages were not counted: the changes in view of the cell with the most of them.
    pub(super) fn of_map(mapper: &Mapper) -> Self {
        let mut passages = Self::default();
        for index in mapper.changed() {
            let seen = mapper.statistics(index);
            let after_gap = seen.block_events_after_gap + seen.free_events_after_gap;
            passages.after_gap.insert(cell_key(mapper.frame(), index), after_gap);
            let tally = passages.spots.entry(spot_key(mapper.frame(), index)).or_default();
            tally.passages[0] = tally.passages[0].max(seen.block_events);
        }
        passages
    }

    /// Counts the changes of the last reading.
    pub(super) fn note(&mut self, mapper: &Mapper) {
        let (frame, now_s) = (mapper.frame(), mapper.time());
        for (index, event) in events(mapper) {
            let seen = mapper.statistics(index);
            let found = seen.block_events_after_gap + seen.free_events_after_gap;
            let known = self.after_gap.entry(cell_key(frame, index)).or_default();
            let is_after_gap = found > std::mem::replace(known, found);
            let tally = self.spots.entry(spot_key(frame, index)).or_default();
            let is_empty = tally.blocked == 0 || now_s - tally.last_s > FORGOTTEN_S;
            if !is_after_gap && event == Event::Block && is_empty {
                tally.passages[1] += 1;
            }
            let others = if is_empty { 0 } else { tally.blocked };
            tally.blocked = if event == Event::Block { others + 1 } else { others.saturating_sub(1) };
            tally.last_s = now_s;
        }
    }

    /// A new session begins.
    pub(super) fn begin_session(&mut self) {
        for tally in self.spots.values_mut() {
            tally.passages = [tally.passages.iter().sum(), 0];
            tally.blocked = 0;
        }
    }

    /// The spots of some cells, by their keys.
    pub(super) fn spots(&self, mapper: &Mapper, cells: &[usize]) -> Vec<Spot> {
        let mut spots: BTreeMap<Key, (f64, f64)> = BTreeMap::new();
        for index in cells {
            let (sum_s, count) = spots.entry(spot_key(mapper.frame(), *index)).or_default();
            *sum_s += mapper.statistics(*index).observed();
            *count += 1.0;
        }
        let spot = |(key, (sum_s, count)): (Key, (f64, f64))| {
            let Tally { passages, .. } = self.spots.get(&key).copied().unwrap_or_default();
            Spot { key, passages, before_in_all: passages[0], observed_s: sum_s / count }
        };
        spots.into_iter().map(spot).collect()
    }

    /// The spot of some cells where the most passages were counted; of equal ones, the one that was in view for longer.
    pub(super) fn busiest(&self, mapper: &Mapper, cells: &[usize]) -> Spot {
        let order = |a: &Spot, b: &Spot| a.all().cmp(&b.all()).then(a.observed_s.total_cmp(&b.observed_s));
        let spots = self.spots(mapper, cells);
        let before_in_all = spots.iter().map(|spot| spot.before_in_all).sum();
        let busiest = spots.into_iter().max_by(order);
        busiest.map(|spot| Spot { before_in_all, ..spot }).unwrap_or_default()
    }
}

/// What is known of the present session.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub(super) struct Session {
    /// Its first log.
    pub(super) log: usize,
    /// The largest number of a place before it.
    pub(super) last: u32,
    /// The doors before it.
    pub(super) doors: BTreeSet<u32>,
    /// For how long each spot was in view before it, s.
    pub(super) looked: BTreeMap<Key, f32>,
    /// The cells that changed in it: whether each was blocked before.
    pub(super) touched: BTreeMap<Key, bool>,
}

/// For how long each spot was in view: its cell that was in view for the longest time, s.
pub(super) fn looked(mapper: &Mapper) -> BTreeMap<Key, f32> {
    let mut looked: BTreeMap<Key, f32> = BTreeMap::new();
    for index in (0..mapper.frame().len()).filter(|index| mapper.was_ever_seen(*index)) {
        let longest_s = looked.entry(spot_key(mapper.frame(), index)).or_default();
        *longest_s = longest_s.max(mapper.statistics(index).observed() as f32);
    }
    looked
}

impl Session {
    pub(super) fn begin(mapper: &Mapper, log: usize, last: u32) -> Self {
        Self {
            log,
            last,
            doors: mapper.doors().iter().map(|door| door.id).collect(),
            looked: looked(mapper),
            touched: BTreeMap::new(),
        }
    }

    pub(super) fn note(&mut self, mapper: &Mapper) {
        if self.log == 0 {
            return; // there is nothing to compare with
        }
        for (index, event) in events(mapper) {
            let entry = self.touched.entry(cell_key(mapper.frame(), index));
            entry.or_insert(event == Event::Free);
        }
    }
}
