//! What looks say of a thing that is in one of two states: there or away, open or closed.

use crate::change::{CellMap, Evidence, Population, Posterior};
use crate::look_counts::LookCounts;
use interfaces::CellState;
use std::sync::OnceLock;

/// The thing has changed when looks have said so for this time, s.
const LASTING_S: f64 = 1.0;
/// What is found to have changed this soon after a time out of view changed in that time, s: the map needs some looks.
const BEGIN_S: f64 = 3.0;
/// Older looks are left out when the logarithm of the ratio of probabilities, “the rates have changed” to “they are the same”, reaches
/// this.
const DRIFTED: f64 = 4.0;
/// The recent looks begin anew when the ratio is below this, or after this number of changes.
const SAME: f64 = -1.0;
const MAX_RECENT_CHANGES: u32 = 8;

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
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(crate) struct Presence {
    /// The state that is certain.
    pub(super) is_there: bool,
    last_s: f64,
    /// When the present view of it began, s.
    view_s: f64,
    doubt: Option<Doubt>,
    /// The looks since its rates changed last.
    pub(crate) evidence: Evidence,
    /// The last of these looks, which are compared with those before; `None` of a door: people pass it in bursts.
    recent: Option<Evidence>,
    /// By the shipped population, and by that of the map.
    #[serde(skip)]
    alone: Computed,
    #[serde(skip)]
    posterior: Computed,
}

impl Presence {
    /// `can_drift`: whether its rates can change.
    pub(super) fn new(is_there: bool, last_s: f64, evidence: Evidence, can_drift: bool) -> Self {
        let recent = can_drift.then(Evidence::default);
        Self { is_there, last_s, view_s: f64::NEG_INFINITY, evidence, recent, ..Self::default() }
    }

    /// Learns from a look. Returns whether the state is certain: a new one needs some time.
    pub(super) fn see(&mut self, now_s: f64, is_there: bool) -> bool {
        if self.doubt.is_some_and(|doubt| now_s - doubt.last_s > Evidence::MAX_GAP_S) {
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

    /// A look in which the map has not decided yet: the thing stays in view, and in its last state.
    pub(super) fn hold(&mut self, now_s: f64) {
        if now_s - self.last_s <= Evidence::MAX_GAP_S && self.doubt.is_none() {
            self.look(now_s, self.is_there);
        }
    }

    /// Takes looks that say that the state has changed as true: they have lasted, or the view ended with them. One look alone can err.
    fn settle(&mut self) {
        let Some(Doubt { since_s, last_s }) = self.doubt.take() else { return };
        if last_s > since_s {
            let is_there = !self.is_there;
            self.look(since_s, is_there);
            self.look(last_s, is_there);
        }
    }

    fn look(&mut self, time_s: f64, is_there: bool) {
        (self.alone, self.posterior) = Default::default();
        let (before, length_s) = (self.is_there, (time_s - self.last_s).max(0.0));
        (self.is_there, self.last_s) = (is_there, time_s);
        let is_gap = length_s > Evidence::MAX_GAP_S;
        self.view_s = if is_gap { time_s } else { self.view_s };
        let is_at_begin = time_s - self.view_s <= BEGIN_S;
        if let Some(recent) = &mut self.recent
            && (is_gap || is_there != before && !is_at_begin)
        {
            match self.evidence.drift(recent) {
                DRIFTED.. => self.evidence.forget_before(std::mem::take(recent)),
                SAME.. if recent.changes() < MAX_RECENT_CHANGES => {}
                _ => *recent = Evidence::default(),
            }
        }
        for evidence in std::iter::once(&mut self.evidence).chain(&mut self.recent) {
            if is_gap || !is_at_begin || !evidence.correct_gap(is_there) {
                evidence.look(before, is_there, length_s);
            }
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

    pub(super) fn each_cell(&mut self, f: &mut dyn FnMut(&mut u32)) {
        self.0.iter_mut().for_each(|(cell, _)| f(cell));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Looks five times per second from one time to another, s.
    fn see(presence: &mut Presence, [from_s, to_s]: [f64; 2], is_there: bool) {
        let looks = ((to_s - from_s) / 0.2).round() as u32;
        for look in 0..=looks {
            presence.see(from_s + 0.2 * f64::from(look), is_there);
        }
    }

    fn counts(presence: &Presence) -> ([u32; 2], u32) {
        (presence.evidence.events(), presence.evidence.changes_after_gap())
    }

    #[test]
    fn what_a_view_begins_with_has_changed_out_of_view() {
        let mut presence = Presence::new(true, 0.0, Evidence::default(), false);
        see(&mut presence, [0.0, 10.0], true);
        // The map of the place is old for a moment.
        see(&mut presence, [3600.0, 3601.0], true);
        see(&mut presence, [3601.2, 3610.0], false);
        assert_eq!((counts(&presence), presence.last_look()), (([0, 0], 1), (false, 3610.0)));
        see(&mut presence, [3610.2, 3620.0], true);
        assert_eq!(counts(&presence), ([1, 0], 1), "this was in view");
    }

    #[test]
    fn one_look_at_the_end_of_a_view_is_no_change() {
        let mut presence = Presence::new(true, 0.0, Evidence::default(), false);
        for visit in 0..9 {
            let begin_s = 100.0 * f64::from(visit);
            see(&mut presence, [begin_s, begin_s + 10.0], true);
            presence.see(begin_s + 10.2, false);
        }
        see(&mut presence, [900.0, 910.0], true);
        assert_eq!(counts(&presence), ([0, 0], 0));
    }

    #[test]
    fn evidence_from_before_the_rates_changed_is_left_out() {
        let mut presence = Presence::new(false, 0.0, Evidence::default(), true);
        let mut begin_s = 0.0;
        for stay_s in std::iter::repeat_n(20.0, 60).chain(std::iter::repeat_n(600.0, 12)) {
            let is_there = !presence.is_there;
            see(&mut presence, [begin_s, begin_s + stay_s], is_there);
            begin_s += stay_s + 0.2;
        }
        let (low, high) = presence.alone().interval(0.9);
        assert!(low < 1.0 / 1200.0 && 1.0 / 1200.0 < high, "{low} to {high} Hz");
        assert_eq!(presence.evidence.changes(), 72, "how often it changed is known all the same");
    }
}
