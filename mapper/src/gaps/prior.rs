//! What is known of a cell before it was watched for long.

use super::bins::Bins;
use super::watch::Watch;

/// Events of a cell of which nothing was seen, in one step. By Jeffreys' prior the rate after n events is distributed as
/// Γ(n + ½), and its median, which is too high as often as too low, is that of n + ⅙ events.
pub(crate) const MEDIAN_EVENTS: f64 = 1.0 / 6.0;
/// The same for the mean of that distribution.
pub(crate) const MEAN_EVENTS: f64 = 0.5;

// The next four were chosen on generated block worlds; `docs/estimators.md` has what else was tried.

/// What the neighbours tell counts as so many events at most.
const NEAR_EVENTS: f64 = 120.0;
/// The same for a cell without an event of its own; each of its own lets them count for one more. At first all
/// were seen in the same few passages of the same thing, found because it was passing: many neighbours then
/// tell as little as one, and that too fast.
const FIRST_NEAR_EVENTS: f64 = 2.0;
/// The variance of the logarithms of rates between neighbours that are alike.
const NEAR_VARIANCE: f64 = 0.03;
/// Degrees of freedom of the doubt whether a neighbour is like the cell: few, so that one that is not soon
/// counts for nothing.
const FREEDOM: f64 = 1.5;

/// What the cells around one tell of it: what moves, moves from cell to cell, and stays in each alike.
///
/// Every neighbour counts for itself, and the less, the less it agrees with what was seen of the cell: the
/// ends of a path to and fro are entered half as often as the cells between, and something else may move
/// nearby.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    own: Watch,
    sum: Watch,
}

impl Near {
    /// Around a cell of which `own` was seen.
    pub(crate) fn of(own: Watch) -> Self {
        Self { own, sum: Watch::default() }
    }

    /// Adds what was seen of a neighbour.
    pub(crate) fn add(&mut self, near: Watch) {
        for state in 0..2 {
            let (events, steps) = (near.events[state], near.steps[state]);
            if events <= 0.0 || steps <= 0.0 {
                continue;
            }
            let leave = (events + MEAN_EVENTS) / (steps + 1.0);
            let own_events = self.own.events[state].max(0.0) + MEAN_EVENTS;
            let own_leave = own_events / (self.own.steps[state] + MEAN_EVENTS / leave);
            let apart = libm::log(own_leave / leave);
            let variance = NEAR_VARIANCE + 1.0 / own_events + 1.0 / (events + MEAN_EVENTS);
            let doubt = 1.0 + apart * apart / variance / FREEDOM;
            let weight = events / (1.0 + NEAR_VARIANCE * events) / (doubt * doubt);
            self.sum.events[state] += weight;
            self.sum.steps[state] += weight / leave;
        }
    }

    /// The watching of the cell itself that would tell the same.
    pub(crate) fn prior(self) -> Watch {
        let part = [0, 1].map(|state| {
            let most = (FIRST_NEAR_EVENTS + self.own.events[state].max(0.0)).min(NEAR_EVENTS);
            most / (most + self.sum.events[state])
        });
        self.sum.times(part)
    }
}

/// Steps without an event that make the prior weigh one step of looking: the harmonic mean of the time between
/// two looks. What changes much faster than it was looked at, nobody can tell the rate of; the estimate is then
/// the slowest that explains what was seen.
pub(super) fn of_looking(watch: Watch, gaps: &Bins, period: f64) -> Watch {
    let steps = watch.steps[0] + watch.steps[1];
    let (mut looks, mut pace) = (steps, steps);
    for bin in gaps.iter() {
        let count = f64::from(bin.count);
        looks += count;
        pace += count * period / bin.length();
    }
    let look = looks / pace;
    Watch::of_both(0.0, if look > 1.0 && look.is_finite() { look - 1.0 } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn watch(events: f64, steps: f64) -> Watch {
        Watch { events: [events; 2], steps: [steps; 2] }
    }

    fn prior(own: Watch, near: &[Watch]) -> Watch {
        let mut around = Near::of(own);
        near.iter().for_each(|&near| around.add(near));
        around.prior()
    }

    #[test]
    fn a_cell_without_a_story_of_its_own_takes_that_of_its_neighbours() {
        let prior = prior(Watch::default(), &[watch(40.0, 400.0); 8]);
        assert!((prior.events[0] / prior.steps[0] - 0.1).abs() < 0.002);
        assert!((1.5..=FIRST_NEAR_EVENTS).contains(&prior.events[0]));
    }

    #[test]
    fn the_more_a_cell_tells_itself_the_more_its_neighbours_may() {
        let told = |own: f64| prior(watch(own, 10.0 * own), &[watch(40.0, 400.0); 40]).events[0];
        assert!(told(1.0) < 3.0 && told(10.0) > 10.0 && told(1000.0) > 50.0);
        assert!(told(1e6) < NEAR_EVENTS);
    }

    #[test]
    fn a_neighbour_that_differs_counts_for_nothing_beside_one_that_does_not() {
        let leave = |watch: Watch| watch.events[0] / watch.steps[0];
        let (own, alike) = (watch(100.0, 1000.0), watch(100.0, 1010.0));
        for other_steps in [100.0, 300.0, 3000.0, 10_000.0] {
            let prior = prior(own, &[alike, watch(100.0, other_steps)]);
            assert!((leave(own + prior) / leave(own) - 1.0).abs() < 0.03, "{other_steps}: {prior:?}");
            assert!(prior.events[0] > 10.0, "{prior:?}");
        }
    }

    #[test]
    fn neighbours_that_never_change_tell_nothing() {
        assert_eq!(prior(watch(3.0, 10.0), &[watch(0.0, 1e6)]), Watch::default());
    }
}
