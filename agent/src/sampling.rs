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

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Purpose;
    use proptest::prelude::*;

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
