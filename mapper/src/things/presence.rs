//! What looks say of a thing that is in one of two states: there or away, open or closed.

use crate::Growth;
use crate::change::{CellMap, Evidence, Population, Posterior};
use crate::look_counts::LookCounts;
use interfaces::CellState;
use std::sync::OnceLock;

/// The thing has changed when looks have said so for this time, s.
const LASTING_S: f64 = 1.0;
/// It stays in view between two looks that are at most this far apart, s: people pass between robot and thing.
const MAX_GAP_S: f64 = 2.5;

/// Looks that say that the state has changed.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
struct Doubt {
    since_s: f64,
    last_s: f64,
}

/// What follows from the evidence, computed when it is asked for.
#[derive(Clone, Debug, Default)]
struct Computed(OnceLock<Posterior>);

impl PartialEq for Computed {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// The state of a thing, and the evidence about how long it stays in both.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(crate) struct Presence {
    /// The state that is certain.
    pub(super) is_there: bool,
    last_s: f64,
    doubt: Option<Doubt>,
    pub(super) evidence: Evidence,
    /// By the shipped population, and by that of the map.
    #[serde(skip)]
    alone: Computed,
    #[serde(skip)]
    posterior: Computed,
}

impl Presence {
    pub(super) fn new(is_there: bool, last_s: f64, evidence: Evidence) -> Self {
        let [alone, posterior] = Default::default();
        Self { is_there, last_s, doubt: None, evidence, alone, posterior }
    }

    /// Learns from a look. Returns whether the state is certain: a new one needs some time.
    pub(super) fn see(&mut self, now_s: f64, is_there: bool) -> bool {
        self.alone = Computed::default();
        self.renew();
        if self.doubt.is_some_and(|doubt| now_s - doubt.last_s > MAX_GAP_S) {
            self.settle();
        }
        if is_there == self.is_there {
            self.doubt = None;
            self.look(now_s, is_there);
            return true;
        }
        let doubt = self.doubt.get_or_insert(Doubt { since_s: now_s, last_s: now_s });
        doubt.last_s = now_s;
        let is_certain = now_s - doubt.since_s >= LASTING_S;
        if is_certain {
            self.settle();
        }
        is_certain
    }

    /// Takes looks that say that the state has changed as true: they have lasted, or the view ended with them.
    fn settle(&mut self) {
        if let Some(Doubt { since_s, last_s }) = self.doubt.take() {
            let is_there = !self.is_there;
            self.look(since_s, is_there);
            self.look(last_s, is_there);
        }
    }

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

    /// The state at the last look, and the time of that, s.
    pub(super) fn last_look(&self) -> (bool, f64) {
        self.doubt.map_or((self.is_there, self.last_s), |doubt| (!self.is_there, doubt.last_s))
    }

    /// The population of the map has changed.
    pub(super) fn renew(&mut self) {
        self.posterior = Computed::default();
    }

    /// What the evidence says beside the shipped population alone.
    pub(super) fn alone(&self) -> &Posterior {
        self.alone.0.get_or_init(|| Posterior::new(&self.evidence, Population::shipped()))
    }

    pub(super) fn posterior(&self, population: &Population) -> &Posterior {
        self.posterior.0.get_or_init(|| Posterior::new(&self.evidence, population))
    }
}

/// The cells of a thing, by their index, with the looks at them in both of its states.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Parts(Vec<(u32, [LookCounts; 2])>);

impl Parts {
    /// Adds those cells of others that are not there yet.
    pub(super) fn join(&mut self, others: Self) {
        for (cell, counts) in others.0 {
            if let Err(at) = self.0.binary_search_by_key(&cell, |(cell, _)| *cell) {
                self.0.insert(at, (cell, counts));
            }
        }
    }

    /// Replaces the cells by these, and keeps the looks at those that are still among them.
    pub(super) fn set(&mut self, cells: &[u32]) {
        let counts = |cell: &u32| (*cell, self.counts(*cell).unwrap_or_default());
        self.0 = cells.iter().map(counts).collect();
    }

    pub(super) fn iter(&self) -> std::slice::Iter<'_, (u32, [LookCounts; 2])> {
        self.0.iter()
    }

    pub(super) fn counts(&self, cell: u32) -> Option<[LookCounts; 2]> {
        // Most cells are far from most things: their index is out of the range.
        let is_within = self.0.first()?.0 <= cell && cell <= self.0.last()?.0;
        let at = is_within.then(|| self.0.binary_search_by_key(&cell, |(cell, _)| *cell).ok()).flatten()?;
        Some(self.0[at].1)
    }

    /// Counts the cells in view that are blocked, where the open reading does not doubt it.
    pub(super) fn learn(&mut self, is_there: bool, map: &CellMap, is_doubted: impl Fn(usize) -> bool) {
        for (cell, counts) in &mut self.0 {
            let index = *cell as usize;
            if map.is_seen_now(index) && !is_doubted(index) {
                counts[usize::from(is_there)].add(map.state(index) == CellState::Blocked);
            }
        }
    }

    pub(super) fn grow(&mut self, growth: &Growth) {
        self.0.iter_mut().for_each(|(cell, _)| *cell = growth.index(*cell as usize) as u32);
    }
}
