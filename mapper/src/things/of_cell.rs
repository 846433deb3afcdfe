//! What a thing says of one of its cells.

use super::presence::Presence;
use crate::change::{Population, Posterior, RateDistribution, Waiting};
use crate::clock::{Clock, Dates};
use crate::tiles::HALF_HOURS;

/// The passages of a leaf count as much as this number of cycles of the cell in view.
const CYCLES: f64 = 3.0;

/// What a thing says of one of its cells. The states of an object are away and there, those of a door open and closed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OfCell<'a> {
    pub(crate) presence: &'a Presence,
    /// The number of the thing among doors, or among objects, and of its cells.
    pub(crate) number: u32,
    pub(crate) cells: usize,
    /// The population of the map; `None` for a door.
    pub(super) population: Option<&'a Population>,
    /// The clock of a door; `None` of an object.
    pub(crate) clock: Option<&'a Clock>,
    /// The probability that the cell is blocked in both states.
    pub(super) shares: [f64; 2],
}

impl<'a> OfCell<'a> {
    /// What is known of the thing.
    pub(crate) fn posterior(&self) -> &'a Posterior {
        self.population.map_or_else(|| self.presence.alone(), |map| self.presence.posterior(map))
    }

    /// What a look at the thing is worth now (`Fading::look_worth`), at a time, s.
    pub(crate) fn look_worth(&self, time_s: f64) -> f64 {
        let (was_there, last_s) = self.presence.last_look();
        self.posterior().fading().look_worth(was_there, (time_s - last_s).max(0.0))
    }

    /// Whether a look at the cell that found it blocked (1) or free (0), at a time, s, is older than the last look at the thing, or says
    /// the same. Otherwise the cell is no longer a part of the thing, or something else has come to it.
    pub(crate) fn agrees(&self, observed: f64, time_s: f64) -> bool {
        let (is_there, last_s) = self.presence.last_look();
        last_s > time_s || (self.shares[usize::from(is_there)] - observed).abs() < 0.5
    }

    /// The probability of the second state, at a time, s.
    pub(crate) fn presence(&self, time_s: f64) -> f64 {
        let (was_there, last_s) = self.presence.last_look();
        self.posterior().probability(was_there, (time_s - last_s).max(0.0))
    }

    /// The probability that the cell is blocked at a time, s.
    pub(crate) fn blocked_probability(&self, time_s: f64) -> f64 {
        self.mix(self.presence(time_s))
    }

    /// How long the cell stays blocked if it is blocked at a time, s.
    pub(crate) fn waiting(&self, time_s: f64) -> Waiting {
        let [away, there] = self.shares;
        let (was_there, last_s) = self.presence.last_look();
        self.posterior().waiting(there >= away, was_there, time_s - last_s)
    }

    /// What the clock of a door makes of this probability at a time, s.
    pub(crate) fn with_clock(&self, alone: f64, time_s: f64, dates: Dates) -> f64 {
        let Some(clock) = self.clock else { return alone };
        let half_hours = clock.half_hours();
        let later = self.mix(1.0 - clock.probability(dates.epoch_s + time_s, dates.calendar));
        alone + half_hours / (half_hours + HALF_HOURS) * (later - alone)
    }

    /// The probability that the cell is blocked, by that of the second state.
    pub(crate) fn mix(&self, is_there: f64) -> f64 {
        let [away, there] = self.shares;
        away + (there - away) * is_there
    }

    /// The prior of the cycle rate of a cell, 1/s, by the motions of its door: where the leaf rests, it passes once per opening, and
    /// twice elsewhere.
    pub(crate) fn rate_prior(&self) -> Option<RateDistribution> {
        let passages = 2.0 - self.shares.iter().sum::<f64>();
        let time = || CYCLES / (passages * self.posterior().cycle_rate());
        self.clock.map(|_| RateDistribution { events: CYCLES, time: time() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::change::Evidence;

    #[test]
    fn a_leaf_passes_twice_per_opening_but_where_it_rests() {
        let mut evidence = Evidence::default();
        for cycle in 0..200 {
            let is_there = cycle % 2 == 0;
            (0..90).for_each(|_| evidence.look(is_there, is_there, 2.0));
            evidence.look(is_there, !is_there, 0.0);
        }
        let presence = Presence::new(false, 0.0, evidence, false);
        let clock = Clock::default();
        for (shares, per_opening) in [([0.0, 1.0], 1.0), ([1.0, 0.0], 1.0), ([0.0, 0.0], 2.0)] {
            let of_cell = OfCell {
                presence: &presence,
                number: 0,
                cells: 1,
                population: None,
                clock: Some(&clock),
                shares,
            };
            let per_hour = 3600.0 * of_cell.rate_prior().unwrap().mean();
            assert!((per_hour / per_opening - 10.0).abs() < 0.6, "{shares:?}: {per_hour} per hour");
            assert_eq!(OfCell { clock: None, ..of_cell }.rate_prior(), None);
        }
    }
}
