//! The maps that follow from the states and the change statistics: interval, rate, change probability, recency,
//! credible interval, probability of being blocked.

mod change_probability;
mod credible_interval;
mod expected_changes;
mod gamma;

use crate::Mapper;
use change_probability::change_probability;
pub(crate) use expected_changes::ExpectedChanges;
use interfaces::CellState;

impl Mapper {
    /// Mean time of a cycle of the cell, T of equation 1; ∞ for a cell that never changed.
    #[inline]
    pub fn interval(&self, index: usize) -> f64 {
        self.estimator().interval(&self.statistics(index))
    }

    /// Cycles of the cell per unit of time, 1/T; 0 for a cell that never changed.
    #[inline]
    pub fn rate(&self, index: usize) -> f64 {
        self.cells.rate(index)
    }

    /// The probability that the cell changed since it was last observed (equation 2).
    #[inline]
    pub fn change_probability(&self, index: usize) -> f64 {
        change_probability(self.recency(index), self.rate(index))
    }

    /// The time since the cell was last observed. A cell that was never observed counts as last seen at 0.
    #[inline]
    pub fn recency(&self, index: usize) -> f64 {
        self.cells.time() - self.cells.last_seen(index)
    }

    /// The expected number of cells that changed since they were last observed: Σ P(E > 0) over all cells. Takes
    /// time in proportion to the cells that ever changed.
    pub fn sum_change_probability(&mut self) -> f64 {
        self.expected_changes.sum(&self.cells)
    }

    /// The longest time since a [candidate](Mapper::is_candidate) was last observed; 0 without candidates.
    pub fn max_recency(&mut self) -> f64 {
        self.cells.oldest_candidate().map_or(0.0, |last_seen| self.cells.time() - last_seen)
    }

    /// The interval that holds the cycle rate of the cell with probability `mass`, with equal probabilities below and
    /// above, per unit of time: the posterior of the two-state chain, with the gaps if the model of the estimator in
    /// use is [a two-state chain](crate::GapModel::is_two_state). A cell without an event has rate 0; its interval
    /// shows the prior, and the time of observation: the longer without an event, the lower the upper bound. From 0
    /// to ∞ before the second reading.
    pub fn credible_interval(&self, index: usize, mass: f64) -> (f64, f64) {
        let belief = self.cells.belief(index);
        belief.map_or((0.0, f64::INFINITY), |(belief, period)| {
            credible_interval::of_cycle_rate(belief, period, mass)
        })
    }

    /// The rates at which the cell leaves its states, per unit of time: free → blocked (α) and
    /// blocked → free (β). Times the time between two readings they are probabilities of a step. `None` for a cell
    /// that never changed, or for which the estimator in use has no rate.
    pub fn transition_rates(&self, index: usize) -> Option<(f64, f64)> {
        self.cells.transition_rates(index).map(|rates| (rates.block, rates.free))
    }

    /// The probability that the cell is blocked now. A cell in view is as observed; out of view a cell that
    /// changes relaxes from its last state to its mean by the two-state chain,
    /// π + (x₀ − π) λ^t. A cell that never changed stays as it was last observed, and an unknown cell has 0.5.
    pub fn blocked_probability(&self, index: usize) -> f64 {
        let state = self.cells.state(index);
        let is_certain = self.is_in_view(index) && state != CellState::Unknown;
        match self.cells.transition_rates(index).filter(|_| !is_certain) {
            Some(rates) => rates.blocked_probability(state, self.recency(index)),
            None => match state {
                CellState::Unknown => 0.5,
                CellState::Free => 0.0,
                CellState::Blocked => 1.0,
            },
        }
    }
}
