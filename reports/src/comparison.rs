//! The comparison of two strategies, paired by trial or by world.

use super::statistics::{Moments, Quantiles, holm};
use super::strategy::{Measure, StrategyResult, Unit};
use serde::Serialize;

/// The difference between two strategies in one measure. Within a world, trials with the same seed are pairs; in
/// the run over all worlds, results in the same world are pairs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The first strategy.
    pub a: String,
    /// The second strategy.
    pub b: String,
    /// The measure that is compared.
    #[serde(rename = "metric")]
    pub measure: Measure,
    /// The number of pairs.
    pub pairs: usize,
    /// The mean of b, in the unit of the metric.
    pub mean_b: f64,
    /// The mean of a − b, in the unit of the metric.
    pub mean_difference: f64,
    /// The lower end of the 95 % confidence interval of the difference, within the range of the metric; NaN for a
    /// single pair.
    pub low: f64,
    /// The upper end of this interval, with the same limit.
    pub high: f64,
    /// The p-value of the two-sided paired t test; NaN for a single pair, 1 if nothing differs.
    pub p_value: f64,
    /// The p-value after Holm's correction for all pairs of strategies that are compared in this measure in this
    /// run.
    pub p_holm: f64,
    /// The mean of a divided by the mean of b.
    pub ratio: f64,
    /// Cohen's d of pairs: the mean difference divided by the standard deviation of the differences.
    pub effect_size: f64,
}

impl Comparison {
    /// Whether the difference is significant, at 5 % and without correction for other tests.
    pub fn is_significant(&self) -> bool {
        self.p_value < 0.05
    }

    /// The same comparison with a and b exchanged.
    pub fn flipped(&self) -> Self {
        Self {
            a: self.b.clone(),
            b: self.a.clone(),
            mean_b: self.mean_b + self.mean_difference,
            mean_difference: -self.mean_difference,
            low: -self.high,
            high: -self.low,
            ratio: 1.0 / self.ratio,
            effect_size: -self.effect_size,
            ..*self
        }
    }
}

/// Compares every pair of strategies in every measure of [`Measure::COMPARED`], where there is a pair of units.
pub(super) fn compare_all(strategies: &[StrategyResult], quantiles: &Quantiles) -> Vec<Comparison> {
    let mut all = Vec::new();
    for measure in Measure::COMPARED {
        let family = all.len();
        for (index, a) in strategies.iter().enumerate() {
            all.extend(strategies[index + 1..].iter().filter_map(|b| compare(a, b, measure, quantiles)));
        }
        let p_values: Vec<f64> = all[family..].iter().map(|test: &Comparison| test.p_value).collect();
        for (comparison, p_holm) in all[family..].iter_mut().zip(holm(&p_values)) {
            comparison.p_holm = p_holm;
        }
    }
    all
}

fn compare(a: &StrategyResult, b: &StrategyResult, by: Measure, quantiles: &Quantiles) -> Option<Comparison> {
    let pair = |unit: &Unit| {
        // Units are in the order of their keys.
        let partner = b.units.binary_search_by_key(&unit.key, |unit| unit.key).ok()?;
        let pair = [unit, &b.units[partner]].map(|unit| unit.value(by));
        (!pair.iter().any(|value| value.is_nan())).then_some(pair)
    };
    let pairs: Vec<[f64; 2]> = a.units.iter().filter_map(pair).collect();
    if pairs.is_empty() {
        return None;
    }
    let [mean_a, mean_b] = [0, 1].map(|side| Moments::of(pairs.iter().map(|pair| pair[side])).mean());
    let test = quantiles.paired_test(pairs.iter().map(|[a, b]| a - b));
    // No difference is larger than the range of the metric.
    let range = match by {
        Measure::Final(metric) | Measure::Area(metric) => metric.range(),
    };
    let most = range.end() - range.start();
    Some(Comparison {
        a: a.name.clone(),
        b: b.name.clone(),
        measure: by,
        pairs: pairs.len(),
        mean_b,
        mean_difference: test.difference.mean,
        low: test.difference.low.clamp(-most, most),
        high: test.difference.high.clamp(-most, most),
        p_value: test.p_value,
        p_holm: f64::NAN,
        ratio: mean_a / mean_b,
        effect_size: test.effect_size,
    })
}
