use super::{Estimator, TwoStateGaps};
use crate::change::{CellStatistics, TransitionRates};

/// `shared-prior`: the changes in view, as in equation 1, with a prior that all traversable cells share (empirical
/// Bayes). Few events are shrunk toward the mean rate of all cells, and a cell without an event has a rate above 0, the lower the
/// longer the cell was in view. States out of view are predicted, and goals chosen, as by `two-state-gaps`: goals by these rates brought no better map, and
/// with `curious` a slower one (docs/estimators.md).
#[derive(Clone, Copy, Debug)]
pub struct SharedPrior;

impl Estimator for SharedPrior {
    fn name(&self) -> &'static str {
        "shared-prior"
    }

    fn interval(&self, seen: &CellStatistics) -> f64 {
        seen.posterior().map_or(f64::INFINITY, |posterior| posterior.time / posterior.events)
    }

    fn acting_interval(&self, seen: &CellStatistics) -> f64 {
        TwoStateGaps.interval(seen)
    }

    fn transition_rates(&self, seen: &CellStatistics) -> Option<TransitionRates> {
        TwoStateGaps.transition_rates(seen)
    }

    fn weighs_gaps(&self) -> bool {
        true
    }

    fn shares_prior(&self) -> bool {
        true
    }
}
