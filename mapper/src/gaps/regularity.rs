//! How regular the times are that cells stay in a state.
//!
//! A Markov chain forgets: how much longer a cell stays does not depend on how long it has stayed. What moves by a
//! clock is not like that. It matters for gaps about as long as a stay: after one stay's length, the
//! chain says 63 % left, the clock all.

use super::tune;

/// The complete stays in one state that were seen of a cell, in steps.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stays {
    count: f64,
    mean: f64,
}

/// The spread of stays of all cells around the mean of each, beside that of a Markov chain.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Regularity {
    /// Per state: the sum of squares around the cells' means.
    squares: [f64; 2],
    /// What it would be on average for Markov chains of the same means.
    expected: [f64; 2],
    count: [f64; 2],
}

impl Regularity {
    /// A cell stayed in a state for so many steps, from an event in view to an event in view.
    pub(super) fn add(&mut self, stays: &mut Stays, state: usize, steps: f64) {
        stays.count += 1.0;
        let before = stays.mean;
        stays.mean += (steps - before) / stays.count;
        if stays.count > 1.0 {
            self.squares[state] += (steps - before) * (steps - stays.mean);
            // The variance of a geometric distribution.
            self.expected[state] += stays.mean * (stays.mean - 1.0).max(0.0);
            self.count[state] += 1.0;
        }
    }

    /// Per state, from 0 for a Markov chain to 1 for a clock.
    pub(super) fn weights(&self) -> [f64; 2] {
        if *tune::REG >= 0.0 {
            return [*tune::REG; 2];
        }
        [0, 1].map(|state| {
            if self.expected[state] <= 0.0 {
                return 0.0;
            }
            let mean = self.expected[state] / self.count[state];
            let doubt = *tune::RPRIOR * mean;
            let ratio = (self.squares[state] + doubt) / (self.expected[state] + doubt);
            (1.0 - ratio / *tune::RCUT).max(0.0)
        })
    }
}
