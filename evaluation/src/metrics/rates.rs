//! How right the rates are.

use mapper::Mapper;
use serde::Serialize;
use sim::physics::{Body, Truth};
use std::collections::BTreeMap;

/// A cell counts for [`RateScores::rate_error`] when it was in view for this many true cycles.
const MIN_CYCLES: f64 = 3.0;
/// Where the log error is cut: a factor of ten either way.
const MAX_FACTOR: f64 = 10.0;

/// The rates of change in the map against those that really happened.
#[derive(Clone, Debug, Default, Serialize)]
pub struct RateScores {
    /// Mean of |estimate − truth| / truth over the cells that truly change and were in view for at
    /// least three true cycles; `None` without such cells.
    pub rate_error: Option<f64>,
    /// The number of these cells.
    pub rate_error_cells: usize,
    /// The same mean over all cells that truly change; no estimate counts as 0.
    pub rate_error_all: Option<f64>,
    /// Mean of min(|ln(estimate / truth)|, ln 10) over the cells that truly change, averaged per
    /// moving thing first; no estimate counts as ln 10.
    pub log_error: Option<f64>,
    /// How well the rate tells cells that truly change from static ones: the area under the ROC
    /// curve. Cells within one cell of the border of what moved are left out.
    pub rate_auc: Option<f64>,
    /// Observed cells that nothing that moves ever touched.
    pub static_cells: usize,
    /// Change events counted on these.
    pub false_change_events: u64,
    /// Mean estimated cycle rate over these, Hz.
    pub false_rate_hz: f64,
}

/// Compares the rates of `mapper` with what really happened.
pub fn rate_scores(mapper: &Mapper, truth: &Truth) -> RateScores {
    let mut scores = RateScores::default();
    let (mut in_view, mut all) = (Mean::default(), Mean::default());
    let mut by_thing: BTreeMap<Body, Mean> = BTreeMap::new();
    let (mut changing_rates, mut static_rates) = (Vec::new(), Vec::new());
    for index in 0..truth.frame().len() {
        let cell = truth.frame().cell(index);
        let (estimate, seen) = (mapper.rate(index), mapper.statistics(index));
        let true_rate = truth.cycle_rate_hz(cell);
        if let (Some(thing), true) = (truth.movers()[index], true_rate > 0.0) {
            let error = (estimate - true_rate).abs() / true_rate;
            all.add(error);
            if seen.observed() * true_rate >= MIN_CYCLES {
                in_view.add(error);
            }
            let log = if estimate > 0.0 { (estimate / true_rate).ln().abs() } else { f64::INFINITY };
            by_thing.entry(thing).or_default().add(log.min(MAX_FACTOR.ln()));
        }
        if !mapper.was_ever_seen(index) {
            continue;
        }
        if truth.movers()[index].is_none() {
            scores.static_cells += 1;
            scores.false_change_events += u64::from(seen.events());
            scores.false_rate_hz += estimate;
        }
        let is_touched = |cell| truth.frame().index(cell).is_some_and(|near| truth.movers()[near].is_some());
        let touched_around = cell.neighbours8().into_iter().filter(|&near| is_touched(near)).count();
        match (is_touched(cell), touched_around) {
            (true, 8) if true_rate > 0.0 => changing_rates.push(estimate),
            (false, 0) => static_rates.push(estimate),
            _ => {}
        }
    }
    scores.false_rate_hz /= scores.static_cells.max(1) as f64;
    scores.rate_error = in_view.mean();
    scores.rate_error_cells = in_view.count;
    scores.rate_error_all = all.mean();
    let mut things = Mean::default();
    by_thing.values().filter_map(Mean::mean).for_each(|mean| things.add(mean));
    scores.log_error = things.mean();
    scores.rate_auc = area_under_roc(&changing_rates, &static_rates);
    scores
}

#[derive(Default)]
struct Mean {
    sum: f64,
    count: usize,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }
}

/// The probability that a positive is above a negative, ties counting half (Mann and Whitney).
fn area_under_roc(positives: &[f64], negatives: &[f64]) -> Option<f64> {
    if positives.is_empty() || negatives.is_empty() {
        return None;
    }
    let mut sorted = negatives.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let won = |value: &f64| {
        let below = sorted.partition_point(|negative| negative < value);
        let not_above = sorted.partition_point(|negative| negative <= value);
        (below + not_above) as f64 / 2.0
    };
    let sum: f64 = positives.iter().map(won).sum();
    Some(sum / (positives.len() * negatives.len()) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_is_the_share_of_pairs_in_order() {
        let (positives, negatives) = ([1.0, 0.0, 3.0], [0.0, 2.0]);
        let brute: f64 = positives
            .iter()
            .flat_map(|p| {
                negatives.iter().map(move |n| {
                    if p > n {
                        1.0
                    } else if p == n {
                        0.5
                    } else {
                        0.0
                    }
                })
            })
            .sum();
        assert_eq!(area_under_roc(&positives, &negatives), Some(brute / 6.0));
        assert_eq!(area_under_roc(&[], &negatives), None);
    }
}
