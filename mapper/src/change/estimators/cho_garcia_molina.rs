use super::Estimator;
use crate::change::{CellStatistics, Exposure, GapBin, GapEvidence, GapHistogram, GapModel, GapWeights};

/// `cho-garcia-molina`: the estimator of Cho & Garcia-Molina for how often a web page changes ("Estimating
/// frequency of change", 2003). The changes are one Poisson process, and each visit shows whether there was any
/// event since the last visit. If X of N visits at interval I found a change, the rate is −ln((N − X + ½)/(N + ½))
/// / I. For visits at irregular intervals the rate has maximum likelihood. In view, each reading is a visit.
#[derive(Clone, Copy, Debug)]
pub struct ChoGarciaMolina;

impl Estimator for ChoGarciaMolina {
    fn name(&self) -> &'static str {
        "cho-garcia-molina"
    }

    /// Every second change begins a cycle.
    fn interval(&self, seen: &CellStatistics) -> f64 {
        let time = seen.observed() + seen.unobserved;
        2.0 * time / (changes_in_view(seen) + seen.gap_worth.block_events + seen.gap_worth.free_events)
    }

    fn gap_model(&self) -> Option<&dyn GapModel> {
        Some(self)
    }
}

impl GapModel for ChoGarciaMolina {
    fn weigh(&self, evidence: &GapEvidence<'_>) -> Option<GapWeights> {
        let events = [hidden_changes(evidence.gaps, evidence.seen), 0.0];
        Some(GapWeights { worth: Exposure { events, ..Exposure::default() }, ..GapWeights::default() })
    }
}

/// The changes in view, including those between two readings.
fn changes_in_view(seen: &CellStatistics) -> f64 {
    let changed = f64::from(seen.block_events + seen.free_events);
    if changed == 0.0 {
        return 0.0;
    }
    let visits = (seen.observed() / seen.period).max(changed);
    if !visits.is_finite() {
        return changed;
    }
    -visits * libm::log((visits - changed + 0.5) / (visits + 0.5))
}

/// The maximum number of iterations; the relative error is below a millionth much earlier.
const MAX_ROUNDS: usize = 100;

/// The number of changes in all gaps together that, with the changes in view, gives the rate that best explains both:
/// this rate times the whole time, without the changes in view.
///
/// A gap shows whether there was any change: a gap of length I at rate r has rI/(1 − e^(−rI)) changes if the state
/// differs, and none if the state is the same. As in the original estimator, half an unchanged gap is added, so
/// that there is a rate even if every gap showed a change. It only serves to find the rate: no time passed in it.
fn hidden_changes(bins: &GapHistogram, seen: &CellStatistics) -> f64 {
    let (changes, time) = (changes_in_view(seen), seen.observed());
    let total: f64 = bins.iter().map(|bin| bin.total).sum();
    let count: f64 = bins.iter().map(|bin| f64::from(bin.count)).sum();
    if total <= 0.0 {
        return 0.0;
    }
    let with_half_gap = total + 0.5 * total / count;
    let changed = || bins.iter().filter(|bin| bin.before() != bin.after());
    let expected = |rate: f64| -> f64 {
        let of = |bin: GapBin| {
            let mean = rate * bin.length();
            f64::from(bin.count) * mean / -libm::expm1(-mean)
        };
        changed().map(of).sum()
    };
    // r (T' + t) = changes + expected(r): the right side grows more slowly, so that there is one solution.
    let excess = |rate: f64| changes + expected(rate) - rate * (with_half_gap + time);
    let (mut low, mut high) =
        (0.0, (changes + changed().map(|bin| f64::from(bin.count)).sum::<f64>()) / with_half_gap);
    if !(high > 0.0 && high.is_finite()) {
        return 0.0;
    }
    for _ in 0..MAX_ROUNDS {
        if excess(high) < 0.0 {
            break;
        }
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..MAX_ROUNDS {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::change::gaps::Gap;

    /// The rate that `visits` visits at an interval give, of which `changed` found a change.
    fn rate(visits: u32, changed: u32, interval: f64) -> f64 {
        let mut gaps = GapHistogram::default();
        for visit in 0..visits {
            let (start, end) = (visit, visit + 1);
            gaps.add(Gap { start, end, length: interval, before: false, after: visit < changed });
        }
        let unobserved = f64::from(visits) * interval;
        let mut seen = CellStatistics { last_seen: unobserved, unobserved, ..CellStatistics::default() };
        seen.gap_worth.block_events = hidden_changes(&gaps, &seen);
        2.0 / ChoGarciaMolina.interval(&seen)
    }

    /// The closed form for visits at one interval, also with few of them.
    #[test]
    fn visits_at_one_interval_give_the_rate_of_the_closed_form() {
        for (visits, changed) in [(1, 1), (2, 1), (4, 4), (10, 3), (200, 60)] {
            let [n, x] = [f64::from(visits), f64::from(changed)];
            for interval in [0.5, 30.0] {
                let expected = -libm::log((n - x + 0.5) / (n + 0.5)) / interval;
                let found = rate(visits, changed, interval);
                assert!((found / expected - 1.0).abs() < 1e-5, "{x} of {n}: {found}, not {expected}");
            }
        }
        assert_eq!(rate(5, 0, 2.0), 0.0);
    }
}
