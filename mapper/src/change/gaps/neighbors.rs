//! The information that the cells nearby give about a cell: a moving thing goes from cell to cell, and stays
//! equally long in each.

use super::MEAN_EVENTS;
use crate::change::Exposure;

// The next four were chosen on generated block worlds; `docs/notebook/estimators.md` lists the alternatives.

/// The maximum number of events that all neighbors together count as.
const NEAR_EVENTS: f64 = 120.0;
/// The maximum number of events that all neighbors together count as for a cell without an event of its own; each
/// of its own events adds one. At first, all neighbors were observed in the same few passages of one obstacle:
/// together they have little more information than one neighbor, and their rate is too high.
const FIRST_NEAR_EVENTS: f64 = 2.0;
/// The variance of the logarithms of rates between similar neighbors.
const NEAR_VARIANCE: f64 = 0.03;
/// The degrees of freedom of the distribution that compares a neighbor with the cell. With few degrees of freedom,
/// a neighbor that differs soon counts for nothing.
const FREEDOM: f64 = 1.5;

/// The information of the cells `near` a cell with the exposure `own`, as an exposure of the cell.
///
/// Every neighbor counts separately. The less a neighbor agrees with the observations of the cell, the less it
/// counts: the ends of a back-and-forth path are entered half as often as the cells between, and another thing may
/// move nearby.
pub(in crate::change) fn prior(own: Exposure, near: impl Iterator<Item = Exposure>) -> Exposure {
    let mut sum = Exposure::default();
    for near in near {
        for state in 0..2 {
            let (events, steps) = (near.events[state], near.steps[state]);
            if events <= 0.0 || steps <= 0.0 {
                continue;
            }
            let leave = (events + MEAN_EVENTS) / (steps + 1.0);
            let own_events = own.events[state].max(0.0) + MEAN_EVENTS;
            let own_leave = own_events / (own.steps[state] + MEAN_EVENTS / leave);
            let apart = libm::log(own_leave / leave);
            let variance = NEAR_VARIANCE + 1.0 / own_events + 1.0 / (events + MEAN_EVENTS);
            let doubt = 1.0 + apart * apart / variance / FREEDOM;
            let weight = events / (1.0 + NEAR_VARIANCE * events) / (doubt * doubt);
            sum.events[state] += weight;
            sum.steps[state] += weight / leave;
        }
    }
    sum.scaled([0, 1].map(|state| {
        let most = (FIRST_NEAR_EVENTS + own.events[state].max(0.0)).min(NEAR_EVENTS);
        most / (most + sum.events[state])
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exposure(events: f64, steps: f64) -> Exposure {
        Exposure { events: [events; 2], steps: [steps; 2] }
    }

    fn prior(own: Exposure, near: &[Exposure]) -> Exposure {
        super::prior(own, near.iter().copied())
    }

    #[test]
    fn a_cell_without_events_takes_the_rate_of_its_neighbors() {
        let prior = prior(Exposure::default(), &[exposure(40.0, 400.0); 8]);
        assert!((prior.events[0] / prior.steps[0] - 0.1).abs() < 0.002);
        assert!((1.5..=FIRST_NEAR_EVENTS).contains(&prior.events[0]));
    }

    #[test]
    fn neighbors_count_more_for_a_cell_with_more_events() {
        let events = |own: f64| prior(exposure(own, 10.0 * own), &[exposure(40.0, 400.0); 40]).events[0];
        assert!(events(1.0) < 3.0 && events(10.0) > 10.0 && events(1000.0) > 50.0);
        assert!(events(1e6) < NEAR_EVENTS);
    }

    #[test]
    fn a_different_neighbor_counts_for_nothing_beside_a_similar_one() {
        let leave = |of: Exposure| of.events[0] / of.steps[0];
        let (own, alike) = (exposure(100.0, 1000.0), exposure(100.0, 1010.0));
        for other_steps in [100.0, 300.0, 3000.0, 10_000.0] {
            let prior = prior(own, &[alike, exposure(100.0, other_steps)]);
            assert!((leave(own + prior) / leave(own) - 1.0).abs() < 0.03, "{other_steps}: {prior:?}");
            assert!(prior.events[0] > 10.0, "{prior:?}");
        }
    }

    #[test]
    fn neighbors_that_never_change_tell_nothing() {
        assert_eq!(prior(exposure(3.0, 10.0), &[exposure(0.0, 1e6)]), Exposure::default());
    }
}
