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
