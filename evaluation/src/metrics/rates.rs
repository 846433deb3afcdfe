use super::statistics::Mean;
use interfaces::{CellState, GroundTruth};
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
        let mut inside = Mean::default();
        for index in (0..truth.frame().len()).filter(|&index| mapper.was_ever_seen(index)) {
            let true_rate = f64::from(truth.predicted_events(index)) / truth.elapsed();
            if true_rate > 0.0 {
                let (low, high) = mapper.credible_interval(index, mass);
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

// Passages per hour and tile: how often people and robots come through a place of the size of a body.

/// The side of a tile, m.
const TILE_M: f64 = 0.5;
/// A tile counts for the log error if it has at least this rate, Hz: three passages per hour.
const BUSY_HZ: f64 = 3.0 / 3600.0;
/// The share of the tiles that are the busiest.
const BUSIEST: f64 = 0.1;

/// The estimated passages of tiles of 0.5 m compared with the true ones so far. The passages of a tile are the cycles of its
/// cells, averaged over those that are traversable (free in the map, or ever changed). All are `None` without a tile to
/// compare.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PassageScores {
    /// The mean log error over the tiles with at least three true passages per hour.
    pub log_error_busy: Option<f64>,
    /// The share of the truly busiest tenth of the tiles that are in the busiest tenth by the estimates. Tiles without a true
    /// passage are not in the busiest tenth, all tiles with the rate of its last one are. Tiles with equal estimates share the
    /// places that are left for them equally.
    pub busiest_tenth_hit: Option<f64>,
}

/// Compares the rates of `mapper` with the true events so far.
pub fn passage_scores(mapper: &Mapper, truth: &impl GroundTruth) -> PassageScores {
    let frame = truth.frame();
    let side = (TILE_M / frame.resolution_m()).round().max(1.0) as usize;
    let columns = frame.width().div_ceil(side);
    let mut tiles = vec![[Mean::default(); 2]; columns * frame.height().div_ceil(side)];
    for (index, state) in mapper.states().cells().iter().enumerate() {
        if *state == CellState::Free || mapper.statistics(index).events() > 0 {
            let tile = index / frame.width() / side * columns + index % frame.width() / side;
            tiles[tile][0].add(mapper.rate(index));
            tiles[tile][1].add(f64::from(truth.predicted_events(index)) / truth.elapsed());
        }
    }
    let rates: Vec<[f64; 2]> =
        tiles.iter().filter_map(|[estimate, truth]| Some([estimate.get()?, truth.get()?])).collect();
    let mut errors = Mean::default();
    rates
        .iter()
        .filter(|[_, truth]| *truth >= BUSY_HZ)
        .for_each(|[estimate, truth]| errors.add(log_error(*estimate, *truth)));
    PassageScores { log_error_busy: errors.get(), busiest_tenth_hit: hits_of_the_busiest(&rates) }
}

/// The share of the tenth with the largest second values that is in the tenth with the largest first values: the expected
/// share if chance chooses among equal first values. `None` if the tenth is empty, or has no second value above 0.
fn hits_of_the_busiest(rates: &[[f64; 2]]) -> Option<f64> {
    let places = (BUSIEST * rates.len() as f64).round() as usize;
    // The last of the largest values.
    let limit = |of: usize| {
        let mut values: Vec<f64> = rates.iter().map(|tile| tile[of]).collect();
        values.sort_unstable_by(|a, b| b.total_cmp(a));
        values.get(places.checked_sub(1)?).copied()
    };
    let [by_estimate, by_truth] = [limit(0)?, limit(1)?];
    let count =
        |is_counted: &dyn Fn(&[f64; 2]) -> bool| rates.iter().filter(|tile| is_counted(tile)).count() as f64;
    let is_busy = |tile: &[f64; 2]| tile[1] > 0.0 && tile[1] >= by_truth;
    let above = count(&|tile| tile[0] > by_estimate);
    let chance = (places as f64 - above) / count(&|tile| tile[0] == by_estimate);
    let certain = count(&|tile| is_busy(tile) && tile[0] > by_estimate);
    let hits = certain + chance * count(&|tile| is_busy(tile) && tile[0] == by_estimate);
    let most = count(&is_busy).min(places as f64);
    (most > 0.0).then(|| hits / most)
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

#[cfg(test)]
mod passages_tests {
    use super::*;

    #[test]
    fn the_busiest_tenth() {
        let mut rates: Vec<[f64; 2]> = (0..20).map(|tile| [0.0, f64::from(tile)]).collect();
        (rates[19][0], rates[3][0]) = (5.0, 7.0);
        assert_eq!(hits_of_the_busiest(&rates), Some(0.5));
        assert_eq!(hits_of_the_busiest(&rates[..4]), None);
    }

    #[test]
    fn equal_estimates_hit_by_chance_and_the_true_rates_hit_all() {
        for busy in 0..20_u32 {
            let truth = |tile: u32| f64::from(tile.saturating_sub(19 - busy).min(3));
            let of = |estimate: &dyn Fn(u32) -> f64| {
                let rates: Vec<[f64; 2]> = (0..20).map(|tile| [estimate(tile), truth(tile)]).collect();
                hits_of_the_busiest(&rates)
            };
            // Two places; the tiles that count have the largest rate, or any if there are fewer than two passages.
            let counted = if busy < 4 { busy.min(2) } else { busy - 2 };
            let by_chance = 0.1 * f64::from(counted) / f64::from(counted.min(2));
            assert_eq!(of(&truth), (busy > 0).then_some(1.0), "{busy}");
            for constant in [0.0, 0.5] {
                let found = of(&|_| constant);
                assert_eq!(found.is_some(), busy > 0);
                assert!(found.is_none_or(|found| (found - by_chance).abs() < 1e-12), "{busy}: {found:?}");
            }
        }
    }
}
