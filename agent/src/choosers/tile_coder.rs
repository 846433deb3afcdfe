use crate::situation::Features;
use interfaces::RandomStream;
use rand::RngExt;
use std::collections::BTreeMap;

/// The number of tilings, and the size of a tile in p (expected changed cells) and r (s; steps in a grid world), as in the paper.
const TILINGS: usize = 5;
const TILE: [f64; 2] = [0.5, 100.0];
/// The maximum number of tiles of a tiling. A run of 20 minutes at 10 Hz does not reach it. Without a limit, a cell that
/// is never seen would add new tiles for ever, since r grows with the time.
const MAX_TILES: usize = 1 << 14;

/// A value function over the features (p, r): several grids of tiles (tilings) with random offsets, and one weight
/// per tile (section 4). Tiles are stored by column and row: two tiles never share a weight. The weight of a tile
/// is 0 until something is learned for the tile. A tiling has at most 16,384 tiles: the tiles that were visited longest
/// ago are forgotten.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(super) struct TileCoder {
    tilings: Vec<Tiling>,
}

#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
struct Tiling {
    /// The offset of the tiling in p and r, in tiles, in [0, 1).
    offset: [f64; 2],
    tiles: BTreeMap<(i64, i64), Tile>,
    /// The number of visits of all tiles.
    visits: u64,
}

#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
struct Tile {
    weight: f64,
    /// The number of the last visit.
    visit: u64,
}

impl Tiling {
    /// The weight of a tile at its next visit.
    fn visit(&mut self, tile: (i64, i64)) -> &mut f64 {
        if self.tiles.len() == MAX_TILES && !self.tiles.contains_key(&tile) {
            self.forget_half();
        }
        self.visits += 1;
        let tile = self.tiles.entry(tile).or_default();
        tile.visit = self.visits;
        &mut tile.weight
    }

    /// Forgets the half of the tiles that were visited longest ago.
    fn forget_half(&mut self) {
        let mut visits: Vec<u64> = self.tiles.values().map(|tile| tile.visit).collect();
        let (_, &mut median, _) = visits.select_nth_unstable(MAX_TILES / 2);
        self.tiles.retain(|_, tile| tile.visit >= median);
    }
}

impl TileCoder {
    /// A tile coder with value 0 everywhere and random offsets. Draws two numbers per tiling.
    pub(super) fn new(rng: &mut RandomStream) -> Self {
        Self::with_offsets((0..TILINGS).map(|_| [rng.random(), rng.random()]))
    }

    /// A tile coder with value 0 everywhere, and one tiling per offset (in tiles).
    fn with_offsets(offsets: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let tiling = |offset| Tiling { offset, tiles: BTreeMap::new(), visits: 0 };
        Self { tilings: offsets.into_iter().map(tiling).collect() }
    }

    /// V(p, r): the mean over the tilings of the weight of the tile that contains the features.
    pub(super) fn value(&self, features: Features) -> f64 {
        let weight = |tiling: &Tiling| Some(tiling.tiles.get(&tile(tiling.offset, features))?.weight);
        let sum: f64 = self.tilings.iter().filter_map(weight).sum();
        sum / self.tilings.len().max(1) as f64
    }

    /// For every (p, r) of `trajectory`, moves the weight of each tile that contains (p, r) toward `target`:
    /// w ← w (1 − λ) + target λ.
    pub(super) fn learn(&mut self, trajectory: &[Features], target: f64, learning_rate: f64) {
        for tiling in &mut self.tilings {
            let offset = tiling.offset;
            let tile = |features: &Features| tile(offset, *features);
            // The features change slowly: consecutive pairs are mostly in the same tile.
            for visit in trajectory.chunk_by(|a, b| tile(a) == tile(b)) {
                let weight = tiling.visit(tile(&visit[0]));
                for _ in visit {
                    *weight = *weight * (1.0 - learning_rate) + target * learning_rate;
                }
            }
        }
    }
}

/// The tile that contains the features. The casts saturate, and NaN is in tile 0: every pair of features has a
/// tile.
fn tile(offset: [f64; 2], features: Features) -> (i64, i64) {
    let axis = |axis: usize, feature: f64| (feature / TILE[axis] + offset[axis]).floor() as i64;
    (axis(0, features.p), axis(1, features.r))
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Purpose;
    use proptest::prelude::*;

    fn at(p: f64, r: f64) -> Features {
        Features { p, r }
    }

    /// Two tilings of 0.5 × 100: one from the origin, one displaced by half a tile in p and a
    /// quarter of a tile in r.
    fn two_tilings() -> TileCoder {
        TileCoder::with_offsets([[0.0, 0.0], [0.5, 0.25]])
    }

    #[test]
    fn an_example_by_hand() {
        let mut coder = two_tilings();
        assert_eq!(coder.value(at(0.6, 80.0)), 0.0);
        // p = 0.6: column 1 of the first tiling (0.5 to 1.0), column 1 of the second (0.25 to 0.75).
        // r = 80: row 0 of the first (0 to 100), row 1 of the second (75 to 175).
        coder.learn(&[at(0.6, 80.0)], 10.0, 0.9);
        assert_eq!(coder.value(at(0.6, 80.0)), 9.0);
        // In the same tile of the first tiling only: half of the value.
        assert_eq!(coder.value(at(0.9, 10.0)), 4.5);
        // In the same tile of the second only.
        assert_eq!(coder.value(at(0.3, 170.0)), 4.5);
        // In neither.
        assert_eq!(coder.value(at(0.3, 60.0)), 0.0);
        // A second visit of the first tile: 9 → 9 · 0.1 + 2 · 0.9 = 2.7; a first visit of another
        // tile in the second tiling: 0 → 1.8.
        coder.learn(&[at(0.9, 10.0)], 2.0, 0.9);
        assert!((coder.value(at(0.9, 10.0)) - (2.7 + 1.8) / 2.0).abs() < 1e-12);
        assert!((coder.value(at(0.6, 80.0)) - (2.7 + 9.0) / 2.0).abs() < 1e-12);
    }

    #[test]
    fn each_pair_of_a_trajectory_counts() {
        let mut coder = TileCoder::with_offsets([[0.0, 0.0]]);
        coder.learn(&[at(0.1, 1.0), at(0.2, 2.0), at(9.0, 2.0), at(0.3, 3.0)], 1.0, 0.5);
        assert_eq!(coder.value(at(0.0, 0.0)), 1.0 - 0.5f64.powi(3));
        assert_eq!(coder.value(at(9.0, 0.0)), 0.5);
    }

    #[test]
    fn the_tiles_visited_longest_ago_are_forgotten() {
        let mut coder = TileCoder::with_offsets([[0.0, 0.0]]);
        let row = |row: usize| at(0.0, 100.0 * row as f64);
        for newest in 0..5 * MAX_TILES {
            coder.learn(&[row(0), row(newest)], 1.0, 1.0);
            assert!(coder.tilings[0].tiles.len() <= MAX_TILES);
        }
        let newest = 5 * MAX_TILES - 1;
        assert!((newest - MAX_TILES / 4..=newest).all(|kept| coder.value(row(kept)) == 1.0));
        assert_eq!(coder.value(row(0)), 1.0, "visited all the time");
        assert_eq!(coder.value(row(MAX_TILES)), 0.0, "visited once, long ago");
    }

    proptest! {
        #[test]
        fn learning_one_pair_in_turn_is_learning_all(
            pairs in prop::collection::vec((0.0..3.0, 0.0..400.0), 1..40),
            seed in any::<u64>(),
        ) {
            let mut whole = TileCoder::new(&mut RandomStream::new(seed, Purpose::Agent));
            let mut single = whole.clone();
            let trajectory: Vec<_> = pairs.iter().map(|&(p, r)| at(p, r)).collect();
            whole.learn(&trajectory, 7.0, 0.9);
            trajectory.iter().for_each(|&pair| single.learn(&[pair], 7.0, 0.9));
            for &pair in &trajectory {
                prop_assert_eq!(whole.value(pair), single.value(pair));
            }
        }

        #[test]
        fn values_stay_finite_and_between_zero_and_the_target(
            p in prop_oneof![0.0..10.0, 0.0..f64::MAX, Just(f64::INFINITY), Just(f64::NAN)],
            r in prop_oneof![0.0..1e6, 0.0..f64::MAX, Just(f64::INFINITY), Just(f64::NAN)],
            target in 0.0..1e6,
        ) {
            let mut coder = TileCoder::new(&mut RandomStream::new(3, Purpose::Agent));
            coder.learn(&[at(p, r), at(p, r)], target, 0.9);
            let value = coder.value(at(p, r));
            prop_assert!((0.98 * target..=target * (1.0 + 1e-12)).contains(&value), "{}", value);
        }

        #[test]
        fn far_apart_is_independent(dp in 0.5..1e5, dr in 0.0..1e5) {
            let mut coder = TileCoder::new(&mut RandomStream::new(5, Purpose::Agent));
            coder.learn(&[at(1.0, 50.0)], 10.0, 0.9);
            prop_assert_eq!(coder.value(at(1.0 + dp + 1e-9, 50.0 + dr)), 0.0);
        }
    }
}
