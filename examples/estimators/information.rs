//! The maximum information of a pattern of observations: the Fisher information of the exact likelihood.

use crate::chains::Chain;
use std::collections::BTreeMap;

/// The observations of one kind of chain: for each number of steps and each state, how often a cell was observed
/// again after that time.
pub(crate) struct Information {
    chain: Chain,
    looks: BTreeMap<(bool, u64), u64>,
}

impl Information {
    pub(crate) fn new(chain: Chain) -> Self {
        Self { chain, looks: BTreeMap::new() }
    }

    /// Adds an observation of a cell `steps` steps after it was blocked or free.
    pub(crate) fn add(&mut self, before: bool, steps: u64) {
        *self.looks.entry((before, steps)).or_default() += 1;
    }

    /// The minimum relative standard deviation of the cycle rate of one of `cells` cells.
    pub(crate) fn least_deviation(&self, cells: f64) -> f64 {
        let mut matrix = [[0.0; 2]; 2];
        let logs = [self.chain.block.ln(), self.chain.free.ln()];
        for (&(before, steps), &count) in &self.looks {
            // Central differences in the logarithms of both probabilities.
            const D: f64 = 1e-4;
            let at = |k: usize, by: f64| {
                let mut moved = logs;
                moved[k] += by;
                blocked_after(moved[0].exp(), moved[1].exp(), before, steps)
            };
            let slope = [0, 1].map(|k| (at(k, D) - at(k, -D)) / (2.0 * D));
            let p = blocked_after(self.chain.block, self.chain.free, before, steps);
            let weight = count as f64 / cells / (p * (1.0 - p)).max(1e-12);
            for (row, a) in matrix.iter_mut().zip(slope) {
                for (cell, b) in row.iter_mut().zip(slope) {
                    *cell += weight * a * b;
                }
            }
        }
        let [[aa, ab], [_, bb]] = matrix;
        let determinant = aa * bb - ab * ab;
        if determinant.is_nan() || determinant <= 1e-9 * aa * bb {
            return f64::INFINITY;
        }
        // ln r = −ln(1/a + 1/b): its slopes are the shares of the other state.
        let sum = self.chain.block + self.chain.free;
        let (da, db) = (self.chain.free / sum, self.chain.block / sum);
        ((da * da * bb - 2.0 * da * db * ab + db * db * aa) / determinant).sqrt()
    }
}

/// The probability of being blocked after some steps, step by step from the transition matrix, by
/// repeated squaring.
fn blocked_after(block: f64, free: f64, before: bool, steps: u64) -> f64 {
    let times = |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| {
        let cell = |i: usize, j: usize| a[i][0] * b[0][j] + a[i][1] * b[1][j];
        [[cell(0, 0), cell(0, 1)], [cell(1, 0), cell(1, 1)]]
    };
    let (mut power, mut result, mut left) =
        ([[1.0 - block, block], [free, 1.0 - free]], [[1.0, 0.0], [0.0, 1.0]], steps);
    while left > 0 {
        if left % 2 == 1 {
            result = times(result, power);
        }
        power = times(power, power);
        left /= 2;
    }
    result[usize::from(before)][1]
}
