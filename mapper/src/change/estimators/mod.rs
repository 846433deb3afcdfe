//! Estimators of how often a cell changes, one per file.
//!
//! To add an estimator: write a file with a type that implements [`Estimator`], and add a line to
//! [`EstimatorChoice::all`]. An estimator of another crate is set in
//! [`MapperSettings::estimator`](crate::MapperSettings::estimator) with `.into()`.

mod paper;
mod shared_prior;
mod two_state;
mod two_state_gaps;

use super::{CellStatistics, TransitionRates};
pub use paper::{Paper, PaperAll};
pub use shared_prior::SharedPrior;
use std::fmt;
use std::sync::Arc;
pub use two_state::TwoState;
pub use two_state_gaps::TwoStateGaps;

/// An estimator of the rate at which a cell changes.
pub trait Estimator: fmt::Debug + Send + Sync {
    /// The name on the command line, in files and in reports.
    fn name(&self) -> &'static str;

    /// The cycle time T (equation 1): the mean duration of blocked → free → blocked, in the time unit of the
    /// statistics. Called only for cells with an event, and for all traversable cells if they [share a
    /// prior](Estimator::shares_prior). A result that is not a positive number means that the
    /// events give no rate.
    fn interval(&self, seen: &CellStatistics) -> f64;

    /// The cycle time T with which the robot acts: that of equation 2, from which goals follow, and of the trust in landmarks. By
    /// default that of [`Estimator::interval`]. Called only for cells with an event; must not depend on
    /// [`CellStatistics::prior`].
    fn acting_interval(&self, seen: &CellStatistics) -> f64 {
        self.interval(seen)
    }

    /// The rates of both changes, from which the state of a cell out of view is predicted; `None` if they are
    /// unknown. Called only for cells with a cycle time ([`Estimator::interval`]). By default, the cycle is divided
    /// between the states in proportion to the time that the cell was observed in each.
    fn transition_rates(&self, seen: &CellStatistics) -> Option<TransitionRates> {
        Some(TransitionRates::shared(seen, 1.0 / self.interval(seen)))
    }

    /// Whether gaps in the view are recorded and weighed as those of a two-state chain. Otherwise [`CellStatistics::gap_worth`]
    /// stays 0, and credible intervals are those without gaps.
    fn weighs_gaps(&self) -> bool {
        false
    }

    /// Whether all traversable cells (free, or ever changed) share a prior. Only then [`CellStatistics::prior`] is learned,
    /// and cells without an event have a rate.
    fn shares_prior(&self) -> bool {
        false
    }
}

/// A choice of an estimator, by its name. The default is `two-state-gaps`, for the reasons in `docs/estimators.md`.
#[derive(Clone)]
pub struct EstimatorChoice(Arc<dyn Estimator>);

interfaces::chosen_by_name!(EstimatorChoice, "estimator", EstimatorChoice::all());

impl<E: Estimator + 'static> From<E> for EstimatorChoice {
    fn from(estimator: E) -> Self {
        Self(Arc::new(estimator))
    }
}

impl Default for EstimatorChoice {
    fn default() -> Self {
        TwoStateGaps.into()
    }
}

impl EstimatorChoice {
    /// Every built-in estimator, in the order of reports.
    pub fn all() -> Vec<Self> {
        vec![Paper.into(), PaperAll.into(), TwoState.into(), TwoStateGaps.into(), SharedPrior.into()]
    }

    /// The name on the command line, in files and in reports.
    pub fn name(&self) -> &'static str {
        self.0.name()
    }

    /// The cycle time T; ∞ for a cell without an event unless cells share a prior, or for a cell that was in view for no
    /// time.
    pub fn interval(&self, seen: &CellStatistics) -> f64 {
        let is_static = seen.events() == 0 && !self.shares_prior();
        if is_static { f64::INFINITY } else { valid(self.0.interval(seen)) }
    }

    /// The cycle rate with which the robot acts; 0 for a cell without an event.
    pub(crate) fn acting_rate(&self, seen: &CellStatistics) -> f64 {
        if seen.events() == 0 { 0.0 } else { 1.0 / valid(self.0.acting_interval(seen)) }
    }

    /// The cycle rate 1/T, in cycles per unit of time; 0 where T is ∞.
    pub fn rate(&self, seen: &CellStatistics) -> f64 {
        1.0 / self.interval(seen)
    }

    /// The rates of both changes; `None` for a cell without a rate.
    pub fn transition_rates(&self, seen: &CellStatistics) -> Option<TransitionRates> {
        if self.rate(seen) == 0.0 {
            return None;
        }
        self.0.transition_rates(seen).map(TransitionRates::bounded)
    }

    pub(crate) fn shares_prior(&self) -> bool {
        self.0.shares_prior()
    }

    pub(crate) fn weighs_gaps(&self) -> bool {
        self.0.weighs_gaps()
    }
}

/// If the time in view is zero, or so small that it has no inverse, the events give no rate.
fn valid(interval: f64) -> f64 {
    if interval >= f64::MIN_POSITIVE { interval } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_choose() {
        let all = EstimatorChoice::all();
        for (index, choice) in all.iter().enumerate() {
            assert_eq!(choice.name().parse().as_ref(), Ok(choice));
            assert!(!all[..index].contains(choice));
        }
        assert!(all.contains(&EstimatorChoice::default()));
        let error = "guess".parse::<EstimatorChoice>().unwrap_err().to_string();
        assert!(error.starts_with("no estimator is called `guess`; there are paper, paper-all, "), "{error}");
    }
}
