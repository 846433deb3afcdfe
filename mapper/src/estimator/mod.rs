//! How often a cell changes, from what was seen of it.

mod baselines;
mod two_state;

use crate::CellStatistics;
use crate::chain::Chain;
pub(crate) use baselines::changes_in_view;

/// How the rate of change of a cell is estimated from what was seen of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Estimator {
    /// The paper's equation 1, counting the changes that happened in view.
    Paper,
    /// The paper's equation 1, counting also the changes that were found after a gap.
    PaperAll,
    /// Cho & Garcia-Molina's estimator of how often a web page changes ("Estimating frequency of
    /// change", 2003): one Poisson process, of which each visit tells whether there was any event since
    /// the visit before. Visits at irregular intervals by their maximum likelihood.
    ChoGarciaMolina,
    /// Independent Markov chains of Saarinen, Andreasson & Lilienthal (IROS 2012): per state, the changes
    /// found at the next observation over the observations, one more of both.
    Imac,
    /// A two-state continuous-time Markov chain: each rate is conditioned on the state in which
    /// the cell was watched, so that looking longer while something stands there biases less.
    TwoState,
    /// The same chain in steps of the readings, with what gaps tell: the state before, the state
    /// after, and the time between. Maximum a posteriori. The default: `docs/estimators.md` says why.
    #[default]
    TwoStateGaps,
}

impl Estimator {
    /// Every estimator.
    pub const ALL: [Self; 6] =
        [Self::Paper, Self::PaperAll, Self::ChoGarciaMolina, Self::Imac, Self::TwoState, Self::TwoStateGaps];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::PaperAll => "paper-all",
            Self::ChoGarciaMolina => "cho-garcia-molina",
            Self::Imac => "imac",
            Self::TwoState => "two-state",
            Self::TwoStateGaps => "two-state-gaps",
        }
    }

    /// Whether the gaps of a cell count one by one.
    pub(crate) fn weighs_gaps(self) -> bool {
        matches!(self, Self::ChoGarciaMolina | Self::TwoStateGaps)
    }

    /// Whether the worth of the gaps is that of a two-state chain.
    pub(crate) fn fits_chain(self) -> bool {
        self == Self::TwoStateGaps
    }

    /// The mean time of one cycle, blocked to free and back (equation 1's T), in the unit of the
    /// statistics' times; ∞ for a cell without an event, or that was never in view for any time.
    pub fn interval(self, seen: &CellStatistics) -> f64 {
        let interval = match self {
            _ if seen.events() == 0 => f64::INFINITY,
            Self::Paper => baselines::paper(seen, seen.block_events, seen.free_events),
            Self::PaperAll => baselines::paper(
                seen,
                seen.block_events + seen.block_events_after_gap,
                seen.free_events + seen.free_events_after_gap,
            ),
            Self::ChoGarciaMolina => baselines::cho_garcia_molina(seen),
            Self::Imac => baselines::imac(seen).interval(),
            Self::TwoState => two_state::interval_in_view(seen),
            Self::TwoStateGaps => two_state::with_gaps(seen).interval(),
        };
        // Events of a cell that was never watched, or not for any time that has an inverse, tell of a
        // change, but not how often.
        if interval >= f64::MIN_POSITIVE { interval } else { f64::INFINITY }
    }

    /// The number of cycles per unit of time, 1/T; 0 for a cell without an event.
    pub fn rate(self, seen: &CellStatistics) -> f64 {
        1.0 / self.interval(seen)
    }

    /// The rates of both processes, by which what is out of view is predicted; none for a cell
    /// without a rate.
    pub(crate) fn chain(self, seen: &CellStatistics) -> Option<Chain> {
        let cycle_rate = self.rate(seen);
        if cycle_rate == 0.0 {
            return None;
        }
        let chain = match self {
            Self::Imac => baselines::imac(seen),
            Self::TwoState => two_state::in_view(seen)?,
            Self::TwoStateGaps => two_state::with_gaps(seen),
            Self::Paper | Self::PaperAll | Self::ChoGarciaMolina => baselines::shared(seen, cycle_rate),
        };
        Some(chain.bounded())
    }
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
            period: 1.0,
            unobserved: 30.0,
            watched_free: 80.0,
            watched_blocked: 20.0,
            block_events: 4,
            free_events: 5,
            block_events_after_gap: 6,
            free_events_after_gap: 1,
            gaps_from_free: 8,
            gaps_from_blocked: 3,
            ..CellStatistics::default()
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
