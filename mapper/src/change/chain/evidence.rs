use super::kernel::add_gaps;
use super::{Chains, leaving_rates};
use crate::change::gaps::{Gap, GapHistogram};

/// What stays for a shorter time on average is traffic, s.
const MIN_STAY_S: f64 = 6.0;
/// What the looks at a thing say of its rates, in bounded memory. States: 0 away, 1 there.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Evidence {
    watched_s: [f64; 2],
    /// The changes in view, by the state that the thing left: how often it came, and went.
    events: [u32; 2],
    /// The times without a look, by their lengths and the states before and after.
    gaps: GapHistogram,
    /// The number of changes before the rates changed, of which nothing else is kept.
    forgotten: u32,
}

impl Evidence {
    /// A thing stays in view between two looks that are at most this far apart, s: people pass between robot and thing.
    pub(crate) const MAX_GAP_S: f64 = 2.5;

    /// That of a cell, at the birth of its thing.
    pub(in crate::change) fn of_cell(watched_s: [f64; 2], events: [u32; 2], gaps: GapHistogram) -> Self {
        Self { watched_s, events, gaps, forgotten: 0 }
    }

    /// Adds a look this time after the one before, s.
    pub fn look(&mut self, was_there: bool, is_there: bool, length_s: f64) {
        if length_s > Self::MAX_GAP_S {
            return self.gap(was_there, is_there, length_s);
        }
        let before = usize::from(was_there);
        self.watched_s[before] += length_s;
        self.events[before] += u32::from(is_there != was_there);
    }

    /// Adds a time without a look, s.
    pub fn gap(&mut self, before: bool, after: bool, length: f64) {
        self.gaps.add(Gap { start: 0, end: 1, length, before, after });
    }

    /// The last time without a look ended in this state. Returns whether there was one.
    pub(crate) fn correct_gap(&mut self, after: bool) -> bool {
        self.gaps.correct_last(1, after)
    }

    /// The changes in view, by the state that the thing left: how often it came, and went.
    pub fn events(&self) -> [u32; 2] {
        self.events
    }

    /// The number of changes over gaps.
    pub fn changes_after_gap(&self) -> u32 {
        self.gaps.iter().filter(|bin| bin.before() != bin.after()).map(|bin| bin.count).sum()
    }

    /// Whether most changes were found after a gap: what was in view does not say how often there are.
    pub fn is_mostly_after_gap(&self) -> bool {
        self.changes_after_gap() > self.events.iter().sum()
    }

    /// The number of views, with gaps between them.
    pub fn looks(&self) -> u32 {
        self.gaps.count() + 1
    }

    /// The number of changes, in view and over gaps.
    pub fn changes(&self) -> u32 {
        self.events.iter().sum::<u32>() + self.changes_after_gap() + self.forgotten
    }

    /// The rates have changed since `recent` began: keeps that.
    pub(crate) fn forget_before(&mut self, recent: Self) {
        let forgotten = self.changes().saturating_sub(recent.changes());
        *self = Self { forgotten, ..recent };
    }

    /// The time in view, s.
    pub fn in_view_s(&self) -> f64 {
        self.watched_s.iter().sum()
    }

    /// Whether it is something that stands at its place, and not people who pass: they stay for a moment.
    pub(crate) fn stands(&self) -> bool {
        let over_gaps =
            |after: bool| self.gaps.iter().filter(move |bin| bin.before() && bin.after() == after);
        let stayed_s: f64 = over_gaps(true).map(|bin| bin.length() * f64::from(bin.count)).sum();
        let went = self.events[1] + over_gaps(false).map(|bin| bin.count).sum::<u32>();
        self.watched_s[1] + stayed_s >= MIN_STAY_S * f64::from(went + 1)
    }

    /// Whether the changes of a thing are those of a cell with this evidence. What stood in another part of the thing changes less, and
    /// traffic changes a cell much more often than the thing that stands there. A cell that stands can flicker: thin legs are missed.
    pub(crate) fn explains(&self, cell: &Self) -> bool {
        self.changes() <= 3 * cell.changes()
            && (2 * cell.changes() <= 3 * self.changes() + 2 || cell.stands())
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
        let rates = leaving_rates().map(|rate| (rate, libm::log(rate)));
        let of = |(rate, log): (f64, f64), count: f64, time_s: f64| count * log - rate * time_s;
        let mut sum: Chains = rates
            .iter()
            .flat_map(|come| rates.map(|go| of(*come, came, away_s) + of(go, went, there_s)))
            .collect();
        for bin in self.gaps.iter() {
            add_gaps(&mut sum, bin.count, bin.before(), bin.after(), bin.length());
        }
        sum
    }
}
