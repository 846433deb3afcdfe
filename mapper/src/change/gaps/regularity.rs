//! The regularity of stays: how equal the times are that cells stay in a state.
//!
//! In a Markov chain, the remaining time of a stay does not depend on how long the stay has lasted. For stays of
//! equal length it does, and this matters for gaps about as long as a stay: after the mean duration of a stay, 63 %
//! of the stays of a chain have ended, but all stays of equal length.
//!
//! Two measures, both from pairs of consecutive stays of the same cell, so that cells with stays of any length can be
//! pooled: how many pairs are equal (for the likelihood of gaps), and the coefficient of variation CV, the standard
//! deviation divided by the mean (for predictions). For stays a and b with a gamma distribution of shape k,
//! a / (a + b) has the distribution Beta(k, k) whatever the sum is: also in short visits, in which only stays with a
//! short sum are seen completely. The mean of ((a − b) / (a + b))² is 1/(2k + 1), and CV² is 1/k.

/// Two stays that differ by at most this share of their sum are equal.
const EQUAL: f64 = 0.1;
/// The number of pairs of a Markov chain that are assumed as observed at the start: stays count as random until the
/// observations show otherwise.
const DOUBT: f64 = 4.0;
/// Up to the first share of pairs that are equal beyond chance, stays count as random; from the second share on
/// they count as equal. Stays within short visits are a little more equal than others; regular motion stops while
/// something blocks it.
const BETWEEN: [f64; 2] = [0.15, 0.4];

/// How often two consecutive stays of a cell are equal, over all cells of the map.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(in crate::change) struct Regularity {
    /// For each state: the number of equal pairs, minus the number expected of Markov chains.
    equal: [f64; 2],
    /// The number of unequal pairs expected of Markov chains.
    unequal: [f64; 2],
    /// The number of pairs, and the sum of ((a − b) / (a + b))² over all pairs of stays a and b.
    pairs: [f64; 2],
    spread: [f64; 2],
}

impl Regularity {
    /// Adds a stay of `steps` steps in a state that began and ended with an event in view, after such a stay of
    /// `before` steps.
    pub(super) fn add(&mut self, state: usize, before: f64, steps: f64) {
        let (before, steps) = (libm::round(before), libm::round(steps));
        let sum = before + steps;
        if sum < 4.0 {
            return; // Two stays of one or two steps show nothing about regularity.
        }
        self.pairs[state] += 1.0;
        self.spread[state] += (before - steps) * (before - steps) / (sum * sum);
        // For a Markov chain of any rates, all ways to divide the sum into two stays are equally likely. Of the sum
        // − 1 ways, this number counts as equal:
        let most = libm::floor(EQUAL * sum);
        let ways = if sum % 2.0 == 0.0 {
            2.0 * libm::floor(most / 2.0) + 1.0
        } else {
            2.0 * libm::floor((most + 1.0) / 2.0)
        };
        let expected = ways / (sum - 1.0);
        self.equal[state] += f64::from(u8::from((before - steps).abs() <= most)) - expected;
        self.unequal[state] += 1.0 - expected;
    }

    /// For each state the squared coefficient of variation of stays, CV²: 1 for a Markov chain, 0 for equal stays.
    pub(in crate::change) fn variation(&self) -> [f64; 2] {
        [0, 1].map(|state| {
            // The assumed pairs of a Markov chain have the mean 1/3.
            let spread = (self.spread[state] + DOUBT / 3.0) / (self.pairs[state] + DOUBT);
            2.0 * spread / (1.0 - spread)
        })
    }

    /// For each state, from 0 for stays of random length to 1 for stays of equal length.
    pub(super) fn weights(&self) -> [f64; 2] {
        let [low, high] = BETWEEN;
        [0, 1].map(|state| {
            let share = self.equal[state] / (self.unequal[state] + DOUBT);
            ((share - low) / (high - low)).clamp(0.0, 1.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, Gamma, Geometric};

    fn regularity(stays: impl IntoIterator<Item = f64>) -> Regularity {
        let (mut regularity, mut before) = (Regularity::default(), 0.0);
        for stay in stays {
            if before > 0.0 {
                regularity.add(1, before, stay);
            }
            before = stay;
        }
        regularity
    }

    fn weight(stays: impl IntoIterator<Item = f64>) -> f64 {
        regularity(stays).weights()[1]
    }

    #[test]
    fn a_markov_chain_of_any_rate_is_not_regular() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for leave in [0.7, 0.5, 0.2, 0.01] {
            let stays = Geometric::new(leave).unwrap();
            let mut next = || stays.sample(&mut rng) as f64 + 1.0;
            assert_eq!(weight((0..3000).map(|_| next())), 0.0, "leaving with {leave}");
            // Only stays that fit into a window of ten steps are completely observed.
            let seen: Vec<f64> = (0..3000).map(|_| next()).filter(|&stay| stay < 9.0).collect();
            assert_eq!(weight(seen), 0.0, "leaving with {leave}, in short visits");
        }
    }

    #[test]
    fn a_clock_is_regular_once_shown_also_if_it_stops_at_times() {
        assert_eq!(weight([1.0; 100]), 0.0, "stays of one step tell nothing");
        assert!(weight([7.0; 2]) < 0.2);
        assert_eq!(weight([7.0; 40]), 1.0);
        let waits = |number: u32| if number.is_multiple_of(12) { 30.0 } else { 7.0 };
        assert!(weight((0..120).map(waits)) > 0.7);
    }

    #[test]
    fn the_variation_is_that_of_the_stays_also_in_short_visits() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for shape in [1.0, 2.0, 8.0] {
            let stays = Gamma::new(shape, 100.0 / shape).unwrap();
            let mut pair = || [stays.sample(&mut rng), stays.sample(&mut rng)];
            for longest_sum in [f64::INFINITY, 150.0] {
                let mut regularity = Regularity::default();
                let seen = (0..20_000).map(|_| pair()).filter(|[a, b]| a + b < longest_sum);
                seen.for_each(|[a, b]| regularity.add(1, a, b));
                let found = regularity.variation()[1];
                assert!((found * shape - 1.0).abs() < 0.1, "{found} for shape {shape}, up to {longest_sum}");
            }
        }
        assert!((regularity([]).variation()[0] - 1.0).abs() < 1e-12, "a chain until stays were seen");
        assert!(regularity([40.0; 100]).variation()[1] < 0.05);
    }
}
