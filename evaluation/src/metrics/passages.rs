//! Passages per hour and tile: how often people and robots come through a place of the size of a body.

use super::mean::Mean;
use super::rates::log_error;
use interfaces::{CellState, GroundTruth};
use mapper::Mapper;
use serde::Serialize;

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
    /// The share of the truly busiest tenth of the tiles that are in the busiest tenth by the estimates.
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

/// The share of the tenth with the largest second values that is in the tenth with the largest first values.
fn hits_of_the_busiest(rates: &[[f64; 2]]) -> Option<f64> {
    let count = (BUSIEST * rates.len() as f64).round() as usize;
    let [by_estimate, by_truth] = [0, 1].map(|of| {
        let mut order: Vec<usize> = (0..rates.len()).collect();
        order.sort_by(|a, b| rates[*b][of].total_cmp(&rates[*a][of]));
        order.truncate(count);
        order
    });
    let hits = by_truth.iter().filter(|tile| by_estimate.contains(tile)).count();
    (count > 0).then(|| hits as f64 / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_busiest_tenth() {
        let mut rates: Vec<[f64; 2]> = (0..20).map(|tile| [0.0, f64::from(tile)]).collect();
        (rates[19][0], rates[3][0]) = (5.0, 7.0);
        assert_eq!(hits_of_the_busiest(&rates), Some(0.5));
        assert_eq!(hits_of_the_busiest(&rates[..4]), None);
    }
}
