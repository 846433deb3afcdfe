//! The transition kernel of all chains, computed once: gaps are many.

use super::{Chains, chains};
use std::iter::zip;
use std::sync::LazyLock;

/// The lengths at which the kernel is known: this number per octave, from 2⁻⁴ s to 2²² s.
const PER_OCTAVE: f64 = 2.0;
const FIRST_OCTAVE: f64 = -4.0;
const LENGTHS: usize = 53;

/// By length, state before, and state after: the logarithm of the probability of each chain.
static LOG_PROBABILITIES: LazyLock<Vec<[[Vec<f32>; 2]; 2]>> = LazyLock::new(|| {
    let of_length = |length: usize| {
        let length_s = libm::exp2(FIRST_OCTAVE + length as f64 / PER_OCTAVE);
        let of = |before, after| {
            chains().map(|chain| libm::log(probability_of(chain, before, after, length_s)) as f32).collect()
        };
        [false, true].map(|before| [false, true].map(|after| of(before, after)))
    };
    (0..LENGTHS).map(of_length).collect()
});

/// Adds the logarithm of the likelihood of some gaps of a length, s; between lengths that are known, it is almost straight.
pub(super) fn add_gaps(sums: &mut Chains, count: u32, before: bool, after: bool, length_s: f64) {
    let at = (libm::log2(length_s) - FIRST_OCTAVE) * PER_OCTAVE;
    let at = at.clamp(0.0, (LENGTHS - 1) as f64 - 1e-9);
    let [near, far] = [0, 1].map(|next| {
        let known = &LOG_PROBABILITIES[at as usize + next];
        &known[usize::from(before)][usize::from(after)]
    });
    let (count, part) = (f64::from(count), at.fract());
    for (sum, (near, far)) in zip(sums, zip(near, far)) {
        let [near, far] = [near, far].map(|log| f64::from(*log));
        *sum += count * (near + part * (far - near));
    }
}

/// The probability that a chain is in the state `after` this time after it was in the state `before`.
pub(super) fn probability_of([come, go]: [f64; 2], before: bool, after: bool, elapsed_s: f64) -> f64 {
    let all = come + go;
    let leave = if before { go } else { come };
    let changed = leave / all * -libm::expm1(-all * elapsed_s);
    if before == after { 1.0 - changed } else { changed }
}
