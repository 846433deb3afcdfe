use super::{Chains, chains};
use crate::change::gaps::{Gap, GapHistogram};
use std::iter::zip;

/// What the looks at a thing say of its rates, in bounded memory. States: 0 away, 1 there.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Evidence {
    watched_s: [f64; 2],
    /// The changes in view, by the state that the thing left.
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

    /// The number of changes in view.
    pub fn changes_in_view(&self) -> u32 {
        self.events.iter().sum()
    }

    /// The number of changes, in view and over gaps.
    pub fn changes(&self) -> u32 {
        let over_gaps = self.gaps.iter().filter(|bin| bin.before() != bin.after()).map(|bin| bin.count);
        self.changes_in_view() + over_gaps.sum::<u32>()
    }

    /// The time from the first to the last look, s.
    pub fn span_s(&self) -> f64 {
        let gaps_s: f64 = self.gaps.iter().map(|bin| bin.length() * f64::from(bin.count)).sum();
        self.watched_s.iter().sum::<f64>() + gaps_s
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
            let (count, length_s) = (f64::from(bin.count), bin.length());
            for (sum, [come, go]) in zip(&mut sum, chains()) {
                let all = come + go;
                let leave = if bin.before() { go } else { come };
                let changed = leave / all * -libm::expm1(-all * length_s);
                let seen = if bin.before() == bin.after() { 1.0 - changed } else { changed };
                *sum += count * libm::log(seen);
            }
        }
        sum
    }
}
