//! Least squares over weights that are not negative and have the sum 1.

/// Pairs of weights are moved until no move would improve the fit by more than this share of it, or this often.
const TOLERANCE: f64 = 1e-10;
const MAX_MOVES: usize = 500;

/// The weights w ≥ 0 with Σw = 1 that minimize wᵀ G w / 2 − rᵀ w, from `weights` on: moves weight between the two
/// parts with the steepest and the least steep slope, by the amount that is best for this pair.
pub(super) fn minimize<const N: usize>(gram: &[[f64; N]; N], right: &[f64; N], weights: &mut [f64; N]) {
    let scale: f64 = (0..N).map(|part| gram[part][part]).fold(f64::MIN_POSITIVE, f64::max);
    for _ in 0..MAX_MOVES {
        let slope: [f64; N] = std::array::from_fn(|part| {
            gram[part].iter().zip(weights.iter()).map(|(gram, weight)| gram * weight).sum::<f64>() - right[part]
        });
        let parts = 0..N;
        let least = |of: &[usize], sign: f64| {
            of.iter().copied().reduce(|a, b| if sign * slope[b] < sign * slope[a] { b } else { a })
        };
        let (all, positive): (Vec<usize>, Vec<usize>) =
            (parts.clone().collect(), parts.filter(|part| weights[*part] > 0.0).collect());
        let (Some(to), Some(from)) = (least(&all, 1.0), least(&positive, -1.0)) else { return };
        let gain = slope[from] - slope[to];
        if gain <= TOLERANCE * scale {
            return;
        }
        let curvature = gram[from][from] + gram[to][to] - 2.0 * gram[from][to];
        let moved = if curvature > 0.0 { (gain / curvature).min(weights[from]) } else { weights[from] };
        weights[from] -= moved;
        weights[to] += moved;
    }
}
