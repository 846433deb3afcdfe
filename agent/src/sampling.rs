use interfaces::RandomStream;
use rand::RngExt;

/// Draws an index with a probability proportional to its weight; `None` if no weight is above zero. The weights
/// must be finite and not negative, and their sum must be finite.
pub(crate) fn proportional(
    weights: impl Iterator<Item = f64> + Clone,
    rng: &mut RandomStream,
) -> Option<usize> {
    let total: f64 = weights.clone().sum();
    if total <= 0.0 {
        return None;
    }
    let mut left = rng.random::<f64>() * total;
    let mut drawn = None;
    for (index, weight) in weights.enumerate().filter(|&(_, weight)| weight > 0.0) {
        // If rounding leaves a remainder after the last weight, the last index is drawn.
        drawn = Some(index);
        if left < weight {
            break;
        }
        left -= weight;
    }
    drawn
}

/// A random number from the gamma distribution with `shape` (above 0) and scale 1 (Marsaglia and Tsang 2000).
pub(crate) fn gamma(shape: f64, rng: &mut RandomStream) -> f64 {
    if shape < 1.0 {
        let boost = libm::pow(1.0 - rng.random::<f64>(), 1.0 / shape);
        return gamma(shape + 1.0, rng) * boost;
    }
    let d = shape - 1.0 / 3.0;
    let c = 1.0 / (9.0 * d).sqrt();
    loop {
        let x = normal(rng);
        let v = (1.0 + c * x) * (1.0 + c * x) * (1.0 + c * x);
        let limit = 0.5 * x * x + d - d * v + d * libm::log(v.max(f64::MIN_POSITIVE));
        if v > 0.0 && libm::log(1.0 - rng.random::<f64>()) < limit {
            return d * v;
        }
    }
}

/// A random number from the standard normal distribution (Box and Muller 1958).
fn normal(rng: &mut RandomStream) -> f64 {
    let (radius, angle) = (1.0 - rng.random::<f64>(), rng.random::<f64>());
    (-2.0 * libm::log(radius)).sqrt() * libm::cos(std::f64::consts::TAU * angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Purpose;
    use proptest::prelude::*;

    #[test]
    fn frequencies_follow_the_weights() {
        let weights = [1.0, 0.0, 2.0, 5.0];
        let mut counts = [0.0; 4];
        let mut rng = RandomStream::new(1, Purpose::Agent);
        let draws = 80_000.0;
        for _ in 0..draws as usize {
            counts[proportional(weights.iter().copied(), &mut rng).unwrap()] += 1.0;
        }
        assert_eq!(counts[1], 0.0);
        let chi_square: f64 = [0, 2, 3]
            .map(|index| {
                let expected: f64 = draws * weights[index] / 8.0;
                (counts[index] - expected).powi(2) / expected
            })
            .iter()
            .sum();
        assert!(chi_square < 13.8, "{counts:?}"); // two degrees of freedom, one in a thousand
    }

    #[test]
    fn gamma_has_its_mean_and_its_variance() {
        let mut rng = RandomStream::new(2, Purpose::Agent);
        for shape in [0.2, 1.0, 3.5, 400.0] {
            let draws = 100_000;
            let numbers: Vec<f64> = (0..draws).map(|_| gamma(shape, &mut rng)).collect();
            assert!(numbers.iter().all(|&number| number >= 0.0 && number.is_finite()));
            let mean = numbers.iter().sum::<f64>() / f64::from(draws);
            let square = |number: &f64| (number - mean) * (number - mean);
            let variance = numbers.iter().map(square).sum::<f64>() / f64::from(draws);
            // Both are the shape; of the variance's variance the fourth moment is 3 shape² + 6 shape.
            let sigma = (shape / f64::from(draws)).sqrt();
            assert!((mean - shape).abs() < 4.0 * sigma, "{shape}: {mean}");
            let sigma = ((2.0 * shape * shape + 6.0 * shape) / f64::from(draws)).sqrt();
            assert!((variance - shape).abs() < 4.0 * sigma, "{shape}: {variance}");
        }
    }

    proptest! {
        #[test]
        fn a_weight_of_zero_is_never_drawn(
            weights in prop::collection::vec(prop_oneof![Just(0.0), 0.0..1e-300, 0.0..1e200], 0..20),
            seed in any::<u64>(),
        ) {
            let mut rng = RandomStream::new(seed, Purpose::Agent);
            match proportional(weights.iter().copied(), &mut rng) {
                Some(index) => prop_assert!(weights[index] > 0.0),
                None => prop_assert!(weights.iter().all(|&weight| weight == 0.0)),
            }
        }
    }
}
