use crate::CellStatistics;

/// How the rate of change of a cell is estimated from what was seen of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Estimator {
    /// The paper's equation 1, counting the changes that happened in view.
    Paper,
    /// The paper's equation 1, counting also the changes that were found after a gap.
    PaperAll,
    /// A two-state continuous-time Markov chain: each rate is conditioned on the state in which
    /// the cell was watched, so that looking longer while something stands there biases less.
    #[default]
    TwoState,
}

/// What one event counts for a state that was left often but never seen to be entered again: half
/// an event, the mean of the Jeffreys posterior of a Poisson rate for no event.
const UNSEEN_EVENTS: f64 = 0.5;

impl Estimator {
    /// Every estimator, in the order of their history.
    pub const ALL: [Self; 3] = [Self::Paper, Self::PaperAll, Self::TwoState];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::PaperAll => "paper-all",
            Self::TwoState => "two-state",
        }
    }

    /// The mean time of one cycle, blocked to free and back (equation 1's T), in the unit of the
    /// statistics' times; ∞ for a cell without an event, or that was never in view for any time.
    pub fn interval(self, seen: &CellStatistics) -> f64 {
        let interval = match self {
            Self::Paper => paper(seen, seen.block_events, seen.free_events),
            Self::PaperAll => paper(
                seen,
                seen.block_events + seen.block_events_after_gap,
                seen.free_events + seen.free_events_after_gap,
            ),
            Self::TwoState => two_state(seen),
        };
        // Events of a cell that was never watched, or not for any time that has an inverse, tell of a
        // change, but not how often.
        if interval >= f64::MIN_POSITIVE { interval } else { f64::INFINITY }
    }

    /// The number of cycles per unit of time, 1/T; 0 for a cell without an event.
    pub fn rate(self, seen: &CellStatistics) -> f64 {
        1.0 / self.interval(seen)
    }
}

/// Equation 1: observed time per event, the smaller of the two processes'. They are coupled, so
/// they share one rate, and the estimate errs towards long intervals.
fn paper(seen: &CellStatistics, block_events: u32, free_events: u32) -> f64 {
    let events = block_events.max(free_events);
    if events == 0 { f64::INFINITY } else { seen.observed() / f64::from(events) }
}

/// T = 1/α + 1/β with α the rate of block events while free, and β of free events while blocked.
fn two_state(seen: &CellStatistics) -> f64 {
    if seen.block_events + seen.free_events == 0 {
        return f64::INFINITY;
    }
    let dwell =
        |watched: f64, events: u32| watched / if events == 0 { UNSEEN_EVENTS } else { f64::from(events) };
    dwell(seen.watched_free, seen.block_events) + dwell(seen.watched_blocked, seen.free_events)
}

/// The probability that a cell changed since it was last seen (equation 2, with the λ of the
/// text): 1 − e^(−elapsed/T).
pub(crate) fn change_probability(elapsed: f64, rate: f64) -> f64 {
    // Summed over thousands of cells at every reading: `exp` takes half the time of `expm1`, and its
    // error of 1e-16 is nothing beside the error of any rate.
    1.0 - libm::exp(-elapsed * rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen() -> CellStatistics {
        CellStatistics {
            first_seen: 0.0,
            last_seen: 130.0,
            unobserved: 30.0,
            watched_free: 80.0,
            watched_blocked: 20.0,
            block_events: 4,
            free_events: 5,
            block_events_after_gap: 6,
            free_events_after_gap: 1,
        }
    }

    #[test]
    fn the_readings_of_equation_1() {
        assert_eq!(Estimator::Paper.interval(&seen()), 100.0 / 5.0);
        assert_eq!(Estimator::PaperAll.interval(&seen()), 100.0 / 10.0);
    }

    #[test]
    fn two_state_adds_the_mean_dwells() {
        assert_eq!(Estimator::TwoState.interval(&seen()), 80.0 / 4.0 + 20.0 / 5.0);
    }

    #[test]
    fn without_an_event_nothing_changes() {
        let still = CellStatistics { last_seen: 9.0, watched_free: 9.0, ..Default::default() };
        for estimator in Estimator::ALL {
            assert_eq!(estimator.interval(&still), f64::INFINITY);
            assert_eq!(estimator.rate(&still), 0.0);
        }
        assert_eq!(change_probability(1e6, 0.0), 0.0);
    }
}
