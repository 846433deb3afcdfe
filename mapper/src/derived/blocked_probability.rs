//! The map as predicted: the probability that a cell is blocked now.

use crate::change::{CellStatistics, TransitionRates};

/// A cell that changes, as predicted by its own statistics: the probability that it is blocked at a time `elapsed` after it was
/// observed in a state is π + (x₀ − π) M, where π is the share of the time that the cell is blocked, x₀ the observed state
/// (0 or 1), and M the memory, which fades from 1 to 0. `variation` is the squared coefficient of variation CV² of free and of
/// blocked stays.
///
/// Somebody who looks at a random time sees the rest of a stay. In a Markov chain the rest lasts as long on average as a
/// whole stay, D. For stays of any distribution it lasts D (1 + CV²) / 2 (the inspection paradox): only half a stay where
/// stays are equal. The memory therefore fades 2 / (1 + CV²) times as fast as that of the chain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chain {
    share: f64,
    pub(super) memory: f64,
}

impl Chain {
    pub(super) fn new(
        rates: TransitionRates,
        seen: &CellStatistics,
        variation: [f64; 2],
        elapsed: f64,
    ) -> Self {
        let share = share_blocked(rates, seen);
        // The state with the shorter stays decides how the memory fades.
        let variation = variation[0] * share + variation[1] * (1.0 - share);
        Self { share, memory: rates.memory(elapsed, 2.0 / (1.0 + variation)) }
    }

    pub(super) fn blocked_probability(self, observed: f64) -> f64 {
        (self.share + (observed - self.share) * self.memory).clamp(0.0, 1.0)
    }
}

/// The share of the time that the cell is blocked: the share of the chain or that of the time in view, whichever is
/// smaller, with one more cycle in which the cell stays free (as in Laplace's rule of succession). After few events all
/// shares are too high: only cells that were seen to change have one; the robot stays while something moves, so that
/// the time in view has more events than other times; and the rates of a cell with few events are those of the
/// neighbors that changed, not of those that did not.
fn share_blocked(rates: TransitionRates, seen: &CellStatistics) -> f64 {
    let (watched, cycles) = (seen.watched_free + seen.watched_blocked, f64::from(seen.events()) / 2.0);
    let of_chain = rates.share_blocked();
    let share = if watched > 0.0 { of_chain.min(seen.watched_blocked / watched) } else { of_chain };
    share * cycles / (cycles + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::CellState;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, Gamma};

    /// Mean stays of 30 s free and 10 s blocked.
    const STAYS_S: [f64; 2] = [30.0, 10.0];
    const RATES: TransitionRates =
        TransitionRates { block: 1.0 / STAYS_S[0], free: 1.0 / STAYS_S[1], period: 0.0 };
    const STATES: [CellState; 2] = [CellState::Free, CellState::Blocked];

    fn predicted(variation: f64, state: CellState, elapsed_s: f64) -> f64 {
        let seen = CellStatistics {
            watched_free: 75.0,
            watched_blocked: 25.0,
            block_events: 1 << 30,
            ..Default::default()
        };
        let observed = f64::from(u8::from(state == CellState::Blocked));
        Chain::new(RATES, &seen, [variation; 2], elapsed_s).blocked_probability(observed)
    }

    /// The share of the times at which a simulated cell is blocked, `elapsed_s` after it was seen in each state. Stays
    /// have a gamma distribution with the squared coefficient of variation `variation`.
    fn simulated(variation: f64, elapsed_s: f64) -> [f64; 2] {
        const STEP_S: f64 = 0.5;
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let mut states = Vec::new();
        let (mut until_s, mut is_blocked) = (0.0, false);
        while states.len() < 300_000 {
            while until_s <= states.len() as f64 * STEP_S {
                is_blocked = !is_blocked;
                let mean_s = STAYS_S[usize::from(is_blocked)];
                until_s += Gamma::new(1.0 / variation, mean_s * variation).unwrap().sample(&mut rng);
            }
            states.push(is_blocked);
        }
        let later = (elapsed_s / STEP_S) as usize;
        [false, true].map(|seen| {
            let looks: Vec<bool> = states
                .windows(later + 1)
                .filter(|looks| looks[0] == seen)
                .map(|looks| looks[later])
                .collect();
            looks.iter().filter(|is_blocked| **is_blocked).count() as f64 / looks.len() as f64
        })
    }

    #[test]
    fn a_simulated_chain_is_as_predicted() {
        for elapsed_s in [1.0, 4.0, 10.0, 40.0] {
            let truth = simulated(1.0, elapsed_s);
            for (state, truth) in STATES.into_iter().zip(truth) {
                let found = predicted(1.0, state, elapsed_s);
                assert!((found - truth).abs() < 0.015, "{state:?}, {elapsed_s} s: {found}, not {truth}");
            }
        }
    }

    #[test]
    fn regular_stays_are_predicted_better_than_by_a_chain() {
        for variation in [0.5, 0.2, 0.05] {
            let truths = [2.0, 5.0, 8.0, 12.0].map(|elapsed_s| (elapsed_s, simulated(variation, elapsed_s)));
            let error = |assumed: f64| {
                let errors = truths.map(|(elapsed_s, truth)| {
                    [0, 1].map(|seen| (predicted(assumed, STATES[seen], elapsed_s) - truth[seen]).powi(2))
                });
                errors.iter().flatten().sum::<f64>()
            };
            let [regular, chain] = [variation, 1.0].map(error);
            assert!(regular < 0.6 * chain, "{regular} against {chain} for CV² = {variation}");
        }
    }

    #[test]
    fn the_prediction_goes_from_the_observed_state_to_the_share() {
        for variation in [0.0, 0.3, 1.0, 1.5] {
            for (state, observed) in STATES.into_iter().zip([0.0, 1.0]) {
                assert_eq!(predicted(variation, state, 0.0), observed);
                assert!((predicted(variation, state, 1e6) - 0.25).abs() < 1e-8);
                let apart: Vec<f64> = (0..60)
                    .map(|elapsed_s| (predicted(variation, state, f64::from(elapsed_s)) - 0.25).abs())
                    .collect();
                assert!(apart.is_sorted_by(|before, after| before > after), "{apart:?}");
            }
        }
    }

    #[test]
    fn the_smaller_share_counts_and_few_events_count_less() {
        let share = |watched_free: f64, watched_blocked: f64, block_events: u32| {
            let seen = CellStatistics { watched_free, watched_blocked, block_events, ..Default::default() };
            share_blocked(RATES, &seen)
        };
        assert_eq!([share(9.0, 1.0, 2), share(1.0, 9.0, 6), share(0.0, 0.0, 2)], [0.05, 0.1875, 0.125]);
    }
}
