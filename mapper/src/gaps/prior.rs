//! What the cells around tell of a cell: what moves, moves from cell to cell, and stays in each alike.

use super::fit::Watch;
use super::tune;

/// The watching that stands for what was seen of the neighbours, `near`, given what was seen of the cell
/// itself, `own`: the less, the less they agree.
pub(super) fn of_neighbours(own: Watch, near: Watch) -> Watch {
    let mut prior = Watch::default();
    for state in 0..2 {
        let (events, steps) = (near.events[state].max(0.0), near.steps[state]);
        if !(steps > 0.0) {
            continue;
        }
        let leave = (events + 0.5) / (steps + 1.0);
        let own_events = own.events[state].max(0.0);
        let own_leave = (own_events + 0.5) / (own.steps[state] + 0.5 / leave);
        let apart = libm::log(own_leave / leave);
        let variance = 0.5 + 1.0 / (own_events + 0.5) + 1.0 / (events + 0.5);
        let doubt = 1.0 + apart * apart / variance / *tune::NU;
        let weight = *tune::KAPPA * events / (events + *tune::KAPPA) / libm::pow(doubt, *tune::POWER);
        prior.events[state] = weight;
        prior.steps[state] = weight / leave;
    }
    prior
}
