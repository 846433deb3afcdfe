//! Quantiles of the gamma distribution.

/// From this shape on the cube root of a gamma variable is normal, to 1e-4 of the quantile (Wilson &
/// Hilferty).
const NORMAL_FROM: f64 = 100.0;
/// The largest number of rounds; most quantiles take three.
const MAX_ROUNDS: usize = 100;
/// A quantile is found when it moves by less than this share of itself.
const FOUND: f64 = 1e-12;

/// A quantile of gamma distributions.
pub(super) struct Quantile {
    probability: f64,
    /// The same quantile of a normal distribution of variance 1 around 0.
    normal: f64,
}

impl Quantile {
    /// The quantile for a probability.
    pub(super) fn new(probability: f64) -> Self {
        Self { probability, normal: normal_quantile(probability) }
    }

    /// The quantile of a gamma distribution of mean 1: Newton's method in the logarithm, within bounds that close in.
    pub(super) fn of(&self, shape: f64) -> f64 {
        if shape >= NORMAL_FROM {
            let root = self.cube_root(shape);
            return root.max(0.0) * root * root;
        }
        let of_shape = libm::lgamma(shape);
        // No requested quantile lies beyond these bounds.
        let (mut low, mut high) = (-(40.0 / shape).min(700.0), libm::log(60.0 * (1.0 + shape)));
        let mut log = self.first_guess(shape, of_shape).clamp(low, high);
        for _ in 0..MAX_ROUNDS {
            let x = libm::exp(log);
            let density = libm::exp(shape * log - x - of_shape);
            let below = lower(shape, x, density);
            if below < self.probability {
                low = log
            } else {
                high = log
            }
            // Newton's method for the logarithm of the probability: almost straight where x is small.
            let next = log - below / density * libm::log(below / self.probability);
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            let is_found = (next - log).abs() < FOUND;
            log = next;
            if is_found {
                break;
            }
        }
        libm::exp(log) / shape
    }

    /// The logarithm of a value near the quantile: from the first term of the power series where that is small, else by
    /// the rule of Wilson and Hilferty.
    fn first_guess(&self, shape: f64, of_shape: f64) -> f64 {
        let small = (libm::log(self.probability * shape) + of_shape) / shape;
        if small < libm::log(0.2 * (shape + 1.0)) {
            return small;
        }
        libm::log(shape) + 3.0 * libm::log(self.cube_root(shape).max(0.1))
    }

    /// The cube root of the quantile, as if it were normal (Wilson & Hilferty).
    fn cube_root(&self, shape: f64) -> f64 {
        let ninth = 1.0 / (9.0 * shape);
        1.0 - ninth + self.normal * libm::sqrt(ninth)
    }
}

/// The quantile of a normal distribution of variance 1 around 0, by halving.
fn normal_quantile(probability: f64) -> f64 {
    let (mut low, mut high) = (-9.0, 9.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        let below = 0.5 * libm::erfc(-middle * std::f64::consts::FRAC_1_SQRT_2);
        if below < probability { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The regularized lower incomplete gamma function γ(shape, x)/Γ(shape), as a power series. `scale` is
/// x^shape e^−x / Γ(shape).
fn lower(shape: f64, x: f64, scale: f64) -> f64 {
    let (mut term, mut sum, mut n) = (1.0 / shape, 1.0 / shape, shape);
    while term > sum * f64::EPSILON {
        n += 1.0;
        term *= x / n;
        sum += term;
    }
    // Far beyond the mean the sum overflows: ∞ · 0 is not a number, and the minimum is 1.
    (sum * scale).min(1.0)
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
                let x = Quantile::new(probability).of(shape) * shape;
                let found = summed(shape, x);
                assert!((found - probability).abs() < 2e-4, "shape {shape}: {found}, not {probability}");
            }
        }
    }
}
