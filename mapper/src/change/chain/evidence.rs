use super::{Chains, chains};
use crate::change::gaps::{Gap, GapHistogram};
use std::iter::zip;

/// What the looks at a thing say of its rates, in bounded memory. States: 0 away, 1 there.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Evidence {
    watched_s: [f64; 2],
    /// The changes in view, by the state that the thing left: how often it came, and went.
    events: [u32; 2],
    /// The times without a look, by their lengths and the states before and after.
    gaps: GapHistogram,
}

impl Evidence {
    /// That of a cell, at the birth of its thing.
    pub(in crate::change) fn of_cell(watched_s: [f64; 2], events: [u32; 2], gaps: GapHistogram) -> Self {
        Self { watched_s, events, gaps }
    }

    /// Adds a time in view in one state, s.
    pub fn watch(&mut self, is_there: bool, time_s: f64) {
        self.watched_s[usize::from(is_there)] += time_s;
    }

    /// Adds a change in view.
    pub fn change(&mut self, was_there: bool) {
        self.events[usize::from(was_there)] += 1;
    }

    /// Adds a time without a look, s.
    pub fn gap(&mut self, before: bool, after: bool, length: f64) {
        self.gaps.put(&Gap { start: 0, end: 0, length, before, after });
    }

    /// The changes in view, by the state that the thing left: how often it came, and went.
    pub fn events(&self) -> [u32; 2] {
        self.events
    }

    /// The number of changes over gaps.
    pub fn changes_after_gap(&self) -> u32 {
        self.gaps.iter().filter(|bin| bin.before() != bin.after()).map(|bin| bin.count).sum()
    }

    /// The number of changes, in view and over gaps.
    pub fn changes(&self) -> u32 {
        self.events.iter().sum::<u32>() + self.changes_after_gap()
    }

    /// The time in view, s.
    pub fn in_view_s(&self) -> f64 {
        self.watched_s.iter().sum()
    }

    /// The time that the thing was there as far as it was seen, s, and how often it went.
    pub fn stays(&self) -> (f64, u32) {
        let over_gaps =
            |after: bool| self.gaps.iter().filter(move |bin| bin.before() && bin.after() == after);
        let stayed_s: f64 = over_gaps(true).map(|bin| bin.length() * f64::from(bin.count)).sum();
        (self.watched_s[1] + stayed_s, self.events[1] + over_gaps(false).map(|bin| bin.count).sum::<u32>())
    }

    /// How much of the time is known, s: the time in view, and a minute at most of each gap.
    pub fn known_s(&self) -> f64 {
        let gaps_s: f64 = self.gaps.iter().map(|bin| bin.length().min(60.0) * f64::from(bin.count)).sum();
        self.in_view_s() + gaps_s
    }

    /// The logarithm of the likelihood of each chain: αⁿ¹ βⁿ² e^(−α t₀ − β t₁), and for each gap the transition kernel.
    pub(super) fn log_likelihood(&self) -> Chains {
        let [came, went] = self.events.map(f64::from);
        let [away_s, there_s] = self.watched_s;
        let log = |rate: f64, count: f64| if count > 0.0 { count * libm::log(rate) } else { 0.0 };
        let mut sum: Chains = chains()
            .map(|[come, go]| log(come, came) - come * away_s + log(go, went) - go * there_s)
            .collect();
        for bin in self.gaps.iter() {
            for (sum, chain) in zip(&mut sum, chains()) {
                let seen = probability_of(chain, bin.before(), bin.after(), bin.length());
                *sum += f64::from(bin.count) * libm::log(seen);
            }
        }
        sum
    }
}

/// The probability that a chain is in the state `after` this time after it was in the state `before`.
fn probability_of([come, go]: [f64; 2], before: bool, after: bool, elapsed_s: f64) -> f64 {
    let all = come + go;
    let leave = if before { go } else { come };
    let changed = leave / all * -libm::expm1(-all * elapsed_s);
    if before == after { 1.0 - changed } else { changed }
}
