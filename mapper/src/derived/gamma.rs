//! Quantiles of the gamma distribution.

use statrs::function::erf::erfc_inv;
use statrs::function::gamma::{gamma_lr, ln_gamma};
use std::f64::consts::SQRT_2;

/// From this shape on the cube root of a gamma variable is normal, to 1e-4 of the quantile (Wilson &
/// Hilferty).
const NORMAL_FROM: f64 = 100.0;
/// The largest number of rounds; most quantiles take four.
const MAX_ROUNDS: usize = 100;
/// A quantile is found when it moves by less than this share of itself.
const FOUND: f64 = 1e-12;

/// The quantile of a gamma distribution of mean 1: Newton's method in the logarithm, within bounds that close in.
pub(super) fn quantile(shape: f64, probability: f64) -> f64 {
    if shape >= NORMAL_FROM {
        let ninth = 1.0 / (9.0 * shape);
        let root = (1.0 - ninth - SQRT_2 * erfc_inv(2.0 * probability) * ninth.sqrt()).max(0.0);
        return root * root * root;
    }
    let of_shape = ln_gamma(shape);
    // No requested quantile lies beyond these bounds.
    let (mut low, mut high) = (-(40.0 / shape).min(700.0), libm::log(60.0 * (1.0 + shape)));
    // The first term of the power series, which is exact for small quantiles.
    let mut log = ((libm::log(probability * shape) + of_shape) / shape).clamp(low, libm::log(shape + 1.0));
    for _ in 0..MAX_ROUNDS {
        let x = libm::exp(log);
        let below = gamma_lr(shape, x);
        *(if below < probability { &mut low } else { &mut high }) = log;
        // The logarithm of the probability is almost straight where x is small.
        let density = libm::exp(shape * log - x - of_shape);
        let next = log - below / density * libm::log(below / probability);
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        let is_found = (next - log).abs() < FOUND;
        log = next;
        if is_found {
            break;
        }
    }
    libm::exp(log) / shape
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The distribution function by integrating the density (Simpson's rule in the logarithm).
    fn summed(shape: f64, x: f64) -> f64 {
        let density = |log: f64| libm::exp(shape * log - libm::exp(log) - libm::lgamma(shape));
        let (from, to, steps) = (-60.0 / shape.min(1.0), x.ln(), 20_000);
        let width = (to - from) / f64::from(steps);
        let weight = |step: i32| match step {
            0 => 1.0,
            _ if step == steps => 1.0,
            _ if step % 2 == 1 => 4.0,
            _ => 2.0,
        };
        (0..=steps).map(|step| weight(step) * density(from + f64::from(step) * width)).sum::<f64>() * width
            / 3.0
    }

    #[test]
    fn quantiles_invert_the_distribution() {
        for shape in [0.3, 0.5, 1.0, 2.5, 20.0, 99.0, 101.0, 5000.0] {
            for probability in [0.001, 0.05, 0.5, 0.9, 0.999] {
                let x = quantile(shape, probability) * shape;
                let found = summed(shape, x);
                assert!((found - probability).abs() < 2e-4, "shape {shape}: {found}, not {probability}");
            }
        }
    }
}
