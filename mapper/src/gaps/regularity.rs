//! How regular the times are that cells stay in a state.
//!
//! A Markov chain forgets: how much longer a cell stays does not depend on how long it has stayed. What moves by a
//! clock is not like that. It matters for gaps about as long as a stay: after one stay's length, the
//! chain says 63 % changed, the clock all.

use super::tune;

/// How much two stays in a row differ, over all cells, beside what they would for Markov chains.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Regularity {
    /// Per state: the sum over pairs of stays, 1 on average for Markov chains, 0 for clocks.
    differences: [f64; 2],
    pairs: [f64; 2],
}

impl Regularity {
    /// A cell stayed in a state for so many steps, from an event in view to an event in view, after it had
    /// stayed in it for `before` steps.
    pub(super) fn add(&mut self, state: usize, before: f64, steps: f64) {
        // Given their sum s, each split of it into two stays is as likely as another for a Markov chain,
        // whatever its rate. So their difference is s/2 on average, to less than 1 %, from 4 steps on; two stays of one
        // or two steps tell nothing.
        let sum = before + steps;
        if sum > 3.5 {
            // equal: |x - y| <= 0.1 s; of the s - 1 splits
            let even = (sum / 2.0).fract() < 0.25 || (sum / 2.0).fract() > 0.75;
            let h = 0.05 * sum; // |x - s/2| <= h
            let splits = if even { 1.0 + 2.0 * h.floor() } else { 2.0 * (h + 0.5).floor() };
            let expected = splits / (sum - 1.0);
            self.differences[state] += f64::from(u8::from((before - steps).abs() <= 0.1 * sum + 1e-9)) - expected;
            self.pairs[state] += 1.0 - expected;
        }
    }

    /// Per state, from 0 for a Markov chain to 1 for a clock.
    pub(super) fn weights(&self) -> [f64; 2] {
        if *tune::REG >= 0.0 { return [*tune::REG; 2]; }
        if std::env::var("SHOWR").is_ok() { eprintln!("{:?} {:?}", self.differences, self.pairs); }
        [0, 1].map(|state| {
            let w = self.differences[state] / (self.pairs[state] + *tune::RPRIOR);
            ((w - *tune::RCUT) / *tune::RSPAN).clamp(0.0, 1.0)
        })
    }
}
