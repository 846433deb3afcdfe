//! The maps that are computed from the states and the change statistics: cycle time, rate, change probability,
//! recency, credible interval, probability of being blocked.

mod alone;
mod blocked_probability;
mod change_probability;
mod credible_interval;
mod expected_changes;
mod gamma;
mod look_worth;

use crate::Mapper;
use crate::change::{Evidence, Posterior, Waiting};
use crate::things::OfCell;
pub(crate) use alone::Alone;
use blocked_probability::Chain;
use change_probability::change_probability;
pub(crate) use expected_changes::ExpectedChanges;
use interfaces::{Cell, CellState, Obstacles};
pub use look_worth::Undiscovered;
use std::borrow::Cow;
use std::sync::Arc;

impl Mapper {
    /// The cycle time T of the cell (equation 1): the mean duration of blocked → free → blocked; ∞ for a cell that
    /// never changed, unless traversable cells [share a prior](crate::Estimator::shares_prior).
    #[inline]
    pub fn interval(&self, index: usize) -> f64 {
        match self.posterior(index) {
            Some(posterior) => 1.0 / posterior.cycle_rate(),
            None if self.cells.has_rate(index) => self.estimator().interval(&self.statistics(index)),
            None => f64::INFINITY,
        }
    }

    /// The rate of the cell, 1/T, in cycles per unit of time; 0 where T is ∞.
    #[inline]
    pub fn rate(&self, index: usize) -> f64 {
        1.0 / self.interval(index)
    }

    /// The rate of the cell with which the robot acts, in cycles per unit of time: the rate by which goals are chosen and
    /// landmarks are trusted; 0 for a cell that never changed. Of estimators whose rates are made to predict, it can differ from
    /// [`Mapper::rate`] ([why](crate::Estimator::acting_interval)).
    #[inline]
    pub fn acting_rate(&self, index: usize) -> f64 {
        self.cells.acting_rate(index)
    }

    /// The probability that the cell changed since it was last observed (equation 2), by [`Mapper::acting_rate`].
    #[inline]
    pub fn change_probability(&self, index: usize) -> f64 {
        change_probability(self.recency(index), self.acting_rate(index))
    }

    /// The probability that the cell changes within this time, from 0 to 1, by [`Mapper::rate`]; 0 for a cell that never
    /// changed.
    #[inline]
    pub fn change_probability_within(&self, index: usize, time: f64) -> f64 {
        if self.cells.has_changed(index) { change_probability(time, self.rate(index)) } else { 0.0 }
    }

    /// The time since the cell was last observed. A cell that was never observed counts as last seen at time 0.
    #[inline]
    pub fn recency(&self, index: usize) -> f64 {
        self.cells.time() - self.cells.last_seen(index)
    }

    /// The expected number of cells that changed since they were last observed: Σ P(E > 0) over all cells. The
    /// computing time is proportional to the number of cells that ever changed.
    pub fn sum_change_probability(&mut self) -> f64 {
        self.expected_changes.sum(&self.cells)
    }

    /// The longest time since a [candidate](Mapper::is_candidate) was last observed; 0 without candidates.
    pub fn max_recency(&mut self) -> f64 {
        self.cells.oldest_candidate().map_or(0.0, |last_seen| self.cells.time() - last_seen)
    }

    /// The interval that contains the cycle rate of the cell (per unit of time) with probability `mass`, with equal
    /// probabilities below and above the interval. The interval is that of the posterior of the two-state chain;
    /// the gaps are included if the estimator in use [weighs them](crate::Estimator::weighs_gaps). The
    /// estimate for a cell without an event is 0, but its interval is not: it follows from the prior and the
    /// observation time, and the longer the cell was observed without an event, the lower is the upper bound.
    /// Before the second reading the interval is 0 to ∞. Where traversable
    /// cells [share a prior](crate::Estimator::shares_prior), it is the interval of the posterior with this prior.
    pub fn credible_interval(&self, index: usize, mass: f64) -> (f64, f64) {
        if let Some(posterior) = self.posterior(index) {
            return posterior.interval(mass);
        }
        if self.cells.has_rate(index)
            && let Some(posterior) = self.statistics(index).posterior()
        {
            return posterior.interval(mass);
        }
        let belief = self.cells.belief(index);
        belief.map_or((0.0, f64::INFINITY), |(belief, period)| belief.interval(period, mass))
    }

    /// The rates at which the cell leaves its states, per unit of time: free → blocked (α) and blocked → free (β).
    /// Multiplied by the time between two readings they are the probabilities per step. Of a cell of an object, they are those by
    /// which the cell follows the object. `None` for a cell that never changed, or if the estimator in use has no rate for the cell.
    pub fn transition_rates(&self, index: usize) -> Option<(f64, f64)> {
        let of_object = self.object(index).map(|object| {
            let (share, fading) = object.posterior().share_and_fading();
            (object.mix(share), fading)
        });
        match of_object.or_else(|| Some(self.alone(index)?.share_and_fading())) {
            Some((share, fading)) => Some((share * fading, (1.0 - share) * fading)),
            None => self.cells.transition_rates(index).map(|rates| (rates.block, rates.free)),
        }
    }

    /// The probability that the cell is blocked now: the map as predicted. A cell in view is as observed. Out of view,
    /// the probability for a cell that changes goes from the last observed state to the share of the time that the cell
    /// is blocked; the faster, the more regular the stays of the whole map are. A cell of a door, or of an object that
    /// comes and goes, follows the state of this thing. A cell that never changed stays as last observed, and an unknown cell
    /// has 0.5.
    pub fn blocked_probability(&self, index: usize) -> f64 {
        self.blocked_probability_later(index, 0.0)
    }

    /// The probability that the cell is blocked this much time after the last reading: the map as predicted from now. With
    /// [clocks](crate::MapperSettings::clocks), the hours of its tile count, the more the longer they are known.
    pub fn blocked_probability_later(&self, index: usize, time: f64) -> f64 {
        let state = self.cells.state(index);
        let last_seen = match state {
            CellState::Unknown => 0.5,
            CellState::Free => 0.0,
            CellState::Blocked => 1.0,
        };
        let is_seen_then = time <= 0.0 && self.is_in_view(index);
        if !self.cells.has_changed(index) || is_seen_then && state != CellState::Unknown {
            return last_seen;
        }
        self.predicted(index, last_seen, time).unwrap_or(last_seen)
    }

    /// The thing to which a cell belongs, if what is known of the thing is worth more than what is known of the cell.
    fn thing(&self, index: usize) -> Option<OfCell<'_>> {
        let thing = self.things.of_cell(index)?;
        let explains = || thing.presence.evidence.explains(&self.cells.evidence(index));
        (thing.clock.is_some() || self.estimator().shares_prior() && explains()).then_some(thing)
    }

    /// The object to which a cell belongs. The rate of a cell of a door has that of the door as its prior, since people pass there.
    fn object(&self, index: usize) -> Option<OfCell<'_>> {
        self.thing(index).filter(|thing| thing.clock.is_none())
    }

    /// What looks say of how long a cell stays free (the state “away”) and blocked (“there”): those at its object, or its own.
    pub fn evidence(&self, index: usize) -> Evidence {
        self.object(index)
            .map_or_else(|| self.cells.evidence(index), |object| object.presence.evidence.clone())
    }

    /// What is known of the object of a cell, or of the cell as a thing of its own.
    fn posterior(&self, index: usize) -> Option<Cow<'_, Posterior>> {
        let of_object = self.object(index).map(|object| Cow::Borrowed(object.posterior()));
        of_object.or_else(|| self.alone(index).map(|alone| Cow::Owned((*alone).clone())))
    }

    /// What is known of a cell that was mostly found to have changed out of view, and belongs to nothing: it is a thing of one cell.
    fn alone(&self, index: usize) -> Option<Arc<Posterior>> {
        self.alone.of(index, self.cells.reading(), || {
            let evidence = self.changed_out_of_view(index).filter(Evidence::stands)?;
            Some(Posterior::new(&evidence, &self.things.objects.population))
        })
    }

    /// The looks at a cell that was mostly found to have changed out of view.
    fn changed_out_of_view(&self, index: usize) -> Option<Evidence> {
        let may_be = self.estimator().shares_prior() && self.cells.has_changed(index);
        may_be.then(|| self.cells.evidence(index)).filter(Evidence::is_mostly_after_gap)
    }

    /// The probability that what comes and goes at a cell is there, this much time after the last reading; `None` where nothing
    /// does.
    pub fn presence(&self, index: usize, time: f64) -> Option<f64> {
        Some(self.object(index)?.presence(self.time() + time))
    }

    /// How long a cell stays blocked if it is blocked this much time after the last reading: by the looks at its thing, or at the cell.
    /// `None` where nothing is known of that: where nothing ever changed, and where people pass.
    pub fn waiting(&self, index: usize, time: f64) -> Option<Waiting> {
        let time_s = self.time() + time;
        if let Some(thing) = self.thing(index) {
            return Some(thing.waiting(time_s));
        }
        let evidence = Some(self.cells.evidence(index)).filter(|seen| seen.changes() > 0 && seen.stands())?;
        let was_there = self.cells.state(index) == CellState::Blocked;
        let posterior = Posterior::new(&evidence, &self.things.objects.population);
        Some(posterior.waiting(true, was_there, time_s - self.cells.last_seen(index)))
    }

    /// What predicts a cell that changes and was last seen as `observed`, 0 or 1: its thing, or its chain, and the clocks of its
    /// tile and of its door.
    fn predicted(&self, index: usize, observed: f64, time: f64) -> Option<f64> {
        let seen = self.statistics(index);
        let rates = self.estimator().transition_rates(&seen)?;
        let (thing, time_s) = (self.thing(index), self.time() + time);
        let thing = thing.filter(|thing| thing.agrees(observed, seen.last_seen));
        let chain = Chain::new(rates, &seen, self.cells.variation(), time_s - seen.last_seen);
        let by_cell = |alone: &Posterior| alone.probability(observed > 0.5, time_s - seen.last_seen);
        let alone = match &thing {
            Some(thing) => thing.blocked_probability(time_s),
            None => self.alone(index).as_deref().map_or_else(|| chain.blocked_probability(observed), by_cell),
        };
        let by_tile = self.tiles.of_cell(self.frame().cell(index), self.cells.slot(index)?, time_s);
        let predicted = by_tile.map_or(alone, |tile| tile.blocked_probability(observed, chain.memory, alone));
        Some(thing.map_or(predicted, |thing| thing.with_clock(predicted, time_s, self.tiles.dates())))
    }
}

impl Obstacles for Mapper {
    fn cells(&self) -> Vec<Cell> {
        let is_there = |index: &usize| self.cells.state(*index) == CellState::Blocked;
        let of_things = self.changed().filter(|index| is_there(index) && self.thing(*index).is_some());
        of_things.map(|index| self.frame().cell(index)).collect()
    }

    fn patience(&self, cell: Cell, detour: f64) -> f64 {
        let waiting = self.frame().index(cell).and_then(|index| self.waiting(index, 0.0));
        waiting.map_or(0.0, |waiting| waiting.patience_s(detour))
    }
}
