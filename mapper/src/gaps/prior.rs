//! What is known of a cell before it was watched for long.

use super::bins::Bins;
use super::watch::Watch;

/// Events of a cell of which nothing was seen, in one step. By Jeffreys' prior the rate after n events is distributed as
/// Γ(n + ½), and its median, which is too high as often as too low, is that of n + ⅙ events.
pub(crate) const MEDIAN_EVENTS: f64 = 1.0 / 6.0;
/// The same for the mean of that distribution.
pub(crate) const MEAN_EVENTS: f64 = 0.5;

/// What the neighbours tell counts as so many events at most.
const NEAR_EVENTS: f64 = 8.0;
/// The variance of the logarithms of rates between neighbours.
const NEAR_VARIANCE: f64 = 0.5;
/// Degrees of freedom of the doubt whether a cell is like its neighbours: few, so that one that is not
/// soon stands for itself.
const FREEDOM: f64 = 3.0;

/// The watching that stands for what was seen of the neighbours, `near`, given what was seen of the cell
/// itself, `own`: the less, the less they agree. What moves, moves from cell to cell, and stays in each
/// alike.
pub(super) fn of_neighbours(own: Watch, near: Watch) -> Watch {
    let mut prior = Watch::default();
    for state in 0..2 {
        let (events, steps) = (near.events[state].max(0.0), near.steps[state]);
        if events == 0.0 || steps <= 0.0 {
            continue;
        }
        let leave = (events + MEAN_EVENTS) / (steps + 1.0);
        let own_events = own.events[state].max(0.0) + MEAN_EVENTS;
        let own_leave = own_events / (own.steps[state] + MEAN_EVENTS / leave);
        let apart = libm::log(own_leave / leave);
        let variance = NEAR_VARIANCE + 1.0 / own_events + 1.0 / (events + MEAN_EVENTS);
        let doubt = 1.0 + apart * apart / variance / FREEDOM;
        let weight = NEAR_EVENTS * events / (events + NEAR_EVENTS) / (doubt * doubt);
        prior.events[state] = weight;
        prior.steps[state] = weight / leave;
    }
    prior
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

    #[test]
    fn a_cell_without_a_story_of_its_own_takes_that_of_its_neighbours() {
        let prior = of_neighbours(Watch::default(), watch(40.0, 400.0));
        assert!((prior.events[0] / prior.steps[0] - 0.1).abs() < 0.002);
        assert!((5.0..=NEAR_EVENTS).contains(&prior.events[0]));
    }

    #[test]
    fn a_cell_that_differs_stands_for_itself() {
        for (own_steps, near_steps) in [(100.0, 3000.0), (3000.0, 100.0)] {
            let own = watch(100.0, own_steps);
            let prior = of_neighbours(own, watch(100.0, near_steps));
            let leave = |watch: Watch| watch.events[0] / watch.steps[0];
            assert!((leave(own + prior) / leave(own) - 1.0).abs() < 0.05, "{prior:?}");
        }
    }

    #[test]
    fn neighbours_that_never_change_tell_nothing() {
        assert_eq!(of_neighbours(watch(3.0, 10.0), watch(0.0, 1e6)).steps, [0.0; 2]);
    }
}
