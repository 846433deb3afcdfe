//! The results as rows: `docs/estimators.md` has its tables from them.

use crate::blocks::{Judged, Set};
use crate::chains::Outcome;
use crate::patterns::Pattern;
use crate::room;
use crate::score::Mean;
use crate::tables;
use mapper::EstimatorChoice;
use serde::Serialize;

pub(crate) const BLOCKS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/results/estimators_blocks.csv");
pub(crate) const CHAINS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/results/estimators_chains.csv");
pub(crate) const ROOM: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/results/estimators_room.csv");

/// An estimator in block worlds of one kind; a baseline has only a Brier score.
#[derive(Default, Serialize)]
pub(crate) struct BlockRow {
    worlds: &'static str,
    estimator: &'static str,
    log_error: Option<f64>,
    /// The log error divided by that of `paper`.
    of_paper: Option<f64>,
    bias: Option<f64>,
    dense: Option<f64>,
    sparse: Option<f64>,
    /// The share of the true rates inside the 90 % interval.
    covered: Option<f64>,
    brier: f64,
    /// In view, over all changing cells.
    block_events: u64,
    free_events: u64,
}

pub(crate) fn blocks(set: Set, judged: &Judged) -> Vec<BlockRow> {
    let worlds = match set {
        Set::Generated => "generated",
        Set::Stochastic => "stochastic",
        Set::Shipped => "shipped",
    };
    let [block_events, free_events] = judged.events;
    let row = |estimator, brier: &Mean| BlockRow {
        worlds,
        estimator,
        brier: brier.mean(),
        block_events,
        free_events,
        ..BlockRow::default()
    };
    let log_error = |at: usize| {
        let errors = &judged.scores[at].log_error;
        errors.iter().map(Mean::mean).sum::<f64>() / errors.len() as f64
    };
    let scores = judged.scores.iter().zip(EstimatorChoice::all()).enumerate();
    let rows = scores.map(|(at, (score, estimator))| BlockRow {
        log_error: Some(log_error(at)),
        of_paper: Some(log_error(at) / log_error(0)),
        bias: Some(score.bias.mean()),
        dense: Some(score.dense.mean()),
        sparse: Some(score.sparse.mean()),
        covered: Some(score.covered.mean()),
        ..row(estimator.name(), &score.brier)
    });
    let naive =
        [("last seen", &judged.naive.last_seen), ("share of time blocked", &judged.naive.always_mean)];
    rows.chain(naive.map(|(name, brier)| row(name, brier))).collect()
}

/// An estimator for the chains under one pattern of observations.
#[derive(Default, Serialize)]
pub(crate) struct ChainRow {
    pattern: String,
    estimator: &'static str,
    /// The kinds of chains whose rate the pattern identifies; the next three are of these.
    identified: u32,
    /// The largest bias, with its sign.
    bias: Option<f64>,
    /// The root mean square error, in units of Fisher's bound.
    over_least: Option<f64>,
    covered: Option<f64>,
    /// The most by which the log error is above that of `paper`.
    worse: f64,
}

pub(crate) fn chains(outcomes: &[Outcome]) -> Vec<ChainRow> {
    let row = |pattern: Pattern, at: usize, estimator: &'static str| {
        let row = tables::Row::of(outcomes, pattern, at);
        let known = |value: f64| Some(value).filter(|value| row.identified > 0 && value.is_finite());
        ChainRow {
            pattern: pattern.name(),
            estimator,
            identified: row.identified,
            bias: known(row.bias),
            over_least: known(row.over_least.mean()),
            covered: known(row.covered.mean()),
            worse: row.worse,
        }
    };
    let of_pattern = |pattern| {
        let all = EstimatorChoice::all().into_iter().enumerate();
        all.map(move |(at, estimator)| row(pattern, at, estimator.name()))
    };
    Pattern::ALL.into_iter().flat_map(of_pattern).collect()
}

/// An estimator in the room with one robot.
#[derive(Default, Serialize)]
pub(crate) struct RoomRow {
    /// The scans of a visit, and the mean number of scans from one visit to the next.
    seen: u32,
    of: u32,
    estimator: &'static str,
    log_error: f64,
    bias: f64,
    covered: f64,
}

pub(crate) fn room(scores: &[Vec<room::Score>]) -> Vec<RoomRow> {
    let row = |(seen, of), estimator: EstimatorChoice, score: &room::Score| RoomRow {
        seen,
        of,
        estimator: estimator.name(),
        log_error: score.log_error.mean(),
        bias: score.bias.mean(),
        covered: score.covered.mean(),
    };
    let visits = room::VISITS.into_iter().zip(scores);
    visits
        .flat_map(|(visit, scores)| {
            EstimatorChoice::all()
                .into_iter()
                .zip(scores)
                .map(move |(estimator, score)| row(visit, estimator, score))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use reports::pages::{Rows, columns_of};

    /// Rows with other columns are older than this program.
    #[test]
    fn the_rows_of_the_page_are_those_of_this_program() {
        let columns = |path| Rows::of_csv(&std::fs::read_to_string(path).unwrap()).unwrap().columns;
        assert_eq!(columns(BLOCKS), columns_of(&BlockRow::default()));
        assert_eq!(columns(CHAINS), columns_of(&ChainRow::default()));
        assert_eq!(columns(ROOM), columns_of(&RoomRow::default()));
    }
}
