use super::mean::Mean;
use interfaces::GroundTruth;
use mapper::Mapper;
use serde::Serialize;

/// The log error is limited to that of a factor of 10, for too high and too low estimates.
pub const MAX_LOG_ERROR: f64 = std::f64::consts::LN_10;
/// A cell counts for [`RateScores::rate_error`] if it was in view for at least this many true cycles.
const MIN_CYCLES: f64 = 3.0;

/// The estimated rates of change compared with the true rates so far.
#[derive(Clone, Debug, Default, Serialize)]
pub struct RateScores {
    /// The rate error: the mean of |estimate − truth| / truth over the cells that truly changed and were in view
    /// for at least three true cycles; `None` without such cells.
    pub rate_error: Option<f64>,
    /// The number of cells in [`RateScores::rate_error`].
    pub rate_error_cells: usize,
    /// The mean of |estimate − truth| / truth over all cells that truly changed; a missing estimate counts as 0.
    pub rate_error_all: Option<f64>,
    /// The log error of the rates, averaged per moving thing and then over the things; see [`mean_log_error`].
    pub log_error: Option<f64>,
    /// The part of the log error that does not depend on how a pass counts that covers only a part of a cell; see
    /// [`mean_log_error_of_range`].
    pub log_error_of_range: Option<f64>,
    /// How well the estimated rates separate changing cells from static cells: the area under the ROC curve (1:
    /// completely, 0.5: not better than chance). Cells within one cell of the border of the swept area are left
    /// out.
    pub rate_auc: Option<f64>,
    /// The number of static cells that were observed. No moving thing ever touched a static cell.
    pub static_cells: usize,
    /// The number of false change events: changes of static cells in the statistics.
    pub false_change_events: u64,
    /// The number of false map changes: all changes of static cells in the map. The correction of a wrong first
    /// observation is one, but no event of the statistics.
    pub false_map_changes: u64,
    /// The mean estimated cycle rate of static cells, per unit of time (Hz in a physics world).
    pub false_rate_hz: f64,
}

/// The credible intervals of the rates compared with the true rates so far, over the observed cells that truly changed;
/// [`GroundTruth::predicted_events`] says which events count. All are `None` without such cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct IntervalScores {
    /// The share of the true rates inside the 50 % interval.
    pub inside_50: Option<f64>,
    /// The share of the true rates inside the 90 % interval.
    pub inside_90: Option<f64>,
}

/// Compares the credible intervals of `mapper` with the true rates so far.
pub fn interval_scores(mapper: &Mapper, truth: &impl GroundTruth) -> IntervalScores {
    let [inside_50, inside_90] = [0.5, 0.9].map(|mass| {
        let (interval_of, mut inside) = (mapper.credible_intervals(mass), Mean::default());
        for index in (0..truth.frame().len()).filter(|&index| mapper.was_ever_seen(index)) {
            let true_rate = f64::from(truth.predicted_events(index)) / truth.elapsed();
            if true_rate > 0.0 {
                let (low, high) = interval_of(index);
                inside.add_bool((low..=high).contains(&true_rate));
            }
        }
        inside.get()
    });
    IntervalScores { inside_50, inside_90 }
}

/// Compares the rates of `mapper` with the true rates so far.
pub fn rate_scores(mapper: &Mapper, truth: &impl GroundTruth) -> RateScores {
    let (mut in_view, mut all, mut false_rate) = (Mean::default(), Mean::default(), Mean::default());
    let (mut false_change_events, mut false_map_changes) = (0, 0);
    for index in 0..truth.frame().len() {
        let true_rate = truth.cycle_rate(index);
        if truth.is_swept(index) && true_rate > 0.0 {
            let error = (mapper.rate(index) - true_rate).abs() / true_rate;
            all.add(error);
            if mapper.statistics(index).observed() * true_rate >= MIN_CYCLES {
                in_view.add(error);
            }
        } else if !truth.is_swept(index) && mapper.was_ever_seen(index) {
            false_rate.add(mapper.rate(index));
            false_change_events += u64::from(mapper.statistics(index).events());
            false_map_changes += u64::from(mapper.map_changes(index));
        }
    }
    RateScores {
        rate_error: in_view.get(),
        rate_error_cells: in_view.count,
        rate_error_all: all.get(),
        log_error: mean_log_error(mapper, truth),
        log_error_of_range: mean_log_error_of_range(mapper, truth),
        rate_auc: rate_auc(mapper, truth),
        static_cells: false_rate.count,
        false_change_events,
        false_map_changes,
        false_rate_hz: false_rate.get().unwrap_or(0.0),
    }
}

/// The log error of one cell: min(|ln(estimate / truth)|, ln 10). No estimate counts as ln 10.
pub fn log_error(estimate: f64, truth: f64) -> f64 {
    if estimate > 0.0 { libm::log(estimate / truth).abs().min(MAX_LOG_ERROR) } else { MAX_LOG_ERROR }
}

/// The log error of the rates, the primary metric: for each moving thing, the mean of [`log_error`] over its cells
/// that truly changed; then the mean over the things. `None` before the first true change.
///
/// Too high and too low estimates count equally, no error is unbounded, and a long path counts as much as a short
/// one.
pub fn mean_log_error(mapper: &Mapper, truth: &impl GroundTruth) -> Option<f64> {
    mean_over_things(truth, |index, true_rate| log_error(mapper.rate(index), true_rate))
}

/// As [`mean_log_error`], but the error of a cell is the distance of the estimate to the range between two true rates:
/// that of the block events, where only a cell that is covered completely counts as blocked, and that of all passes,
/// see [`GroundTruth::pass_rate`].
///
/// A thing that is thinner than the diagonal of a cell, such as a swinging door, covers most of the cells that it
/// passes only in part. A robot that sees the door pass is right, although few of the passes are block events.
pub fn mean_log_error_of_range(mapper: &Mapper, truth: &impl GroundTruth) -> Option<f64> {
    mean_over_things(truth, |index, true_rate| {
        let estimate = mapper.rate(index);
        log_error(estimate, estimate.min(truth.pass_rate(index)).max(true_rate))
    })
}

/// The mean of `error` over the cells of a thing that truly changed, given the true rate of the cell; then the mean over
/// the things.
fn mean_over_things(truth: &impl GroundTruth, error: impl Fn(usize, f64) -> f64) -> Option<f64> {
    let mut things = Mean::default();
    for thing in truth.moving_things().iter() {
        let mut cells = Mean::default();
        for &index in thing {
            let true_rate = truth.cycle_rate(index);
            if true_rate > 0.0 {
                cells.add(error(index, true_rate));
            }
        }
        things.add_mean(&cells);
    }
    things.get()
}

/// How well the estimated rates separate the cells that truly changed from static cells: the area under the ROC
/// curve. Only observed cells count. Cells within one cell of the border of the swept area are left out. `None`
/// unless there are cells of both classes.
fn rate_auc(mapper: &Mapper, truth: &impl GroundTruth) -> Option<f64> {
    let frame = truth.frame();
    let (mut changing, mut static_) = (Vec::new(), Vec::new());
    for index in (0..frame.len()).filter(|&index| mapper.was_ever_seen(index)) {
        let is_swept = |cell| frame.index(cell).is_some_and(|near| truth.is_swept(near));
        let cell = frame.cell(index);
        let swept_neighbours = cell.neighbours8().into_iter().filter(|&near| is_swept(near)).count();
        match (truth.is_swept(index), swept_neighbours) {
            (true, 8) if truth.cycle_rate(index) > 0.0 => changing.push(mapper.rate(index)),
            (false, 0) => static_.push(mapper.rate(index)),
            _ => {}
        }
    }
    area_under_roc(&changing, &static_)
}

/// The probability that a positive value is above a negative value; equal values count one half (Mann and Whitney,
/// 1947).
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
        let pairs = positives.iter().flat_map(|p| negatives.iter().map(move |n| (p, n)));
        let brute: f64 = pairs.map(|(p, n)| 0.5 * (f64::from(p >= n) + f64::from(p > n))).sum();
        assert_eq!(area_under_roc(&positives, &negatives), Some(brute / 6.0));
        assert_eq!(area_under_roc(&[], &negatives), None);
    }
}
