//! Least squares over weights that are not negative and have the sum 1.

/// Weights are moved until no move has a slope above this share of the largest curvature, or this often.
const TOLERANCE: f64 = 1e-10;
const MAX_MOVES: usize = 500;

/// Minimizes wᵀ G w / 2 − rᵀ w over weights w ≥ 0 with the sum 1, starting at `weights`. Each move takes weight from the
/// part with the steepest slope to the part with the least (sequential minimal optimization; Platt, 1998).
pub(super) fn minimize<const N: usize>(gram: &[[f64; N]; N], right: &[f64; N], weights: &mut [f64; N]) {
    let scale = (0..N).map(|part| gram[part][part]).fold(f64::MIN_POSITIVE, f64::max);
    for _ in 0..MAX_MOVES {
        let slope: [f64; N] = std::array::from_fn(|row| {
            let products = gram[row].iter().zip(weights.iter()).map(|(gram, weight)| gram * weight);
            products.sum::<f64>() - right[row]
        });
        let by_slope = |a: &usize, b: &usize| slope[*a].total_cmp(&slope[*b]);
        let to = (0..N).min_by(by_slope);
        let from = (0..N).filter(|part| weights[*part] > 0.0).max_by(by_slope);
        let (Some(to), Some(from)) = (to, from) else { return };
        let gain = slope[from] - slope[to];
        if gain <= TOLERANCE * scale {
            return;
        }
        let curvature = gram[from][from] + gram[to][to] - 2.0 * gram[from][to];
        let moved = if curvature > 0.0 { weights[from].min(gain / curvature) } else { weights[from] };
        weights[from] -= moved;
        weights[to] += moved;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// No other point of a fine grid on the simplex is better.
        #[test]
        fn no_other_weights_are_better(
            rows in prop::array::uniform3(prop::array::uniform3(-1.0..1.0f64)),
            right in prop::array::uniform3(-1.0..1.0f64),
        ) {
            let gram: [[f64; 3]; 3] = std::array::from_fn(|a| {
                std::array::from_fn(|b| (0..3).map(|row| rows[row][a] * rows[row][b]).sum())
            });
            let cost = |weights: [f64; 3]| -> f64 {
                (0..3).map(|a| {
                    let product: f64 = (0..3).map(|b| gram[a][b] * weights[b]).sum();
                    weights[a] * (0.5 * product - right[a])
                }).sum()
            };
            let mut found = [0.2, 0.3, 0.5];
            minimize(&gram, &right, &mut found);
            prop_assert!((found.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            prop_assert!(found.iter().all(|weight| *weight >= 0.0));
            for (a, b) in (0..=50).flat_map(|a| (0..=50 - a).map(move |b| (a, b))) {
                let other = [f64::from(a) / 50.0, f64::from(b) / 50.0, f64::from(50 - a - b) / 50.0];
                prop_assert!(cost(found) <= cost(other) + 1e-9, "{found:?} is worse than {other:?}");
            }
        }
    }
}
