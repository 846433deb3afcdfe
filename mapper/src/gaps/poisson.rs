//! Changes in gaps by one Poisson process, after Cho & Garcia-Molina.

use super::bins::{Bin, Bins};
use crate::CellStatistics;
use crate::estimator::changes_in_view;

/// Rounds at most; the rate is found to a millionth long before.
const MOST_ROUNDS: usize = 100;

/// The expected number of changes in all gaps together, at the rate that explains best what was
/// found after them and what happened in view.
///
/// A gap tells whether there was any change: one of length I at rate r holds rI/(1 − e^(−rI)) if so, and
/// none if not. As in their estimator, half an unchanged gap is added, so that a rate is found also
/// where every gap showed a change.
pub(super) fn hidden_changes(bins: &Bins, seen: &CellStatistics) -> f64 {
    let (changes, time) = (changes_in_view(seen), seen.observed());
    let total: f64 = bins.iter().map(|bin| bin.total).sum();
    let count: f64 = bins.iter().map(|bin| f64::from(bin.count)).sum();
    if total <= 0.0 {
        return 0.0;
    }
    let total = total + 0.5 * total / count;
    let changed = || bins.iter().filter(|bin| bin.before() != bin.after());
    let expected = |rate: f64| -> f64 {
        let of = |bin: Bin| {
            let mean = rate * bin.length();
            f64::from(bin.count) * mean / -libm::expm1(-mean)
        };
        changed().map(of).sum()
    };
    // r (T + t) = changes + expected(r): the right side grows slower, so there is one solution.
    let excess = |rate: f64| changes + expected(rate) - rate * (total + time);
    let (mut low, mut high) =
        (0.0, (changes + changed().map(|bin| f64::from(bin.count)).sum::<f64>()) / total);
    if !(high > 0.0 && high.is_finite()) {
        return 0.0;
    }
    for _ in 0..MOST_ROUNDS {
        if excess(high) < 0.0 {
            break;
        }
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..MOST_ROUNDS {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 {
            low = middle
        } else {
            high = middle
        }
        if high - low < 1e-6 * high {
            break;
        }
    }
    0.5 * (low + high) * (total + time) - changes
}
