//! A value over some features by tile coding: a grid of tiles over every pair of features, and once more with an offset.

/// The number of features.
pub(crate) const FEATURES: usize = 6;
/// The tiles along each feature.
const TILES: usize = 8;
/// One more for the tiling that is shifted by half a tile.
const ROW: usize = TILES + 1;
const PAIRS: usize = FEATURES * (FEATURES - 1) / 2;
/// The tiles that contain a point.
pub(crate) const ACTIVE: usize = 2 * PAIRS;

/// The tiles that contain a point.
pub(crate) type Active = [u32; ACTIVE];

/// The weights of all tiles; the value of a point is the sum over the tiles that contain it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tiles(Vec<f64>);

impl Tiles {
    /// The same value everywhere, for a number of actions that share no weight.
    pub(crate) fn new(actions: usize, value: f64) -> Self {
        Self(vec![value / ACTIVE as f64; actions * ACTIVE * ROW * ROW])
    }

    /// The tiles that contain `features`, each from 0 to 1, for an action.
    pub(crate) fn active(features: &[f64; FEATURES], action: usize) -> Active {
        let mut active = [0; ACTIVE];
        let mut tiling = 0;
        for first in 0..FEATURES {
            for second in first + 1..FEATURES {
                for offset in [0.0, 0.5] {
                    let at = |feature: usize| {
                        ((features[feature].clamp(0.0, 1.0) * TILES as f64 + offset) as usize).min(ROW - 1)
                    };
                    let grid = action * ACTIVE + tiling;
                    active[tiling] = ((grid * ROW + at(first)) * ROW + at(second)) as u32;
                    tiling += 1;
                }
            }
        }
        active
    }

    pub(crate) fn value(&self, active: &Active) -> f64 {
        active.iter().map(|&tile| self.0[tile as usize]).sum()
    }

    /// Moves the value of a point toward `target` by the share `step`.
    pub(crate) fn learn(&mut self, active: &Active, target: f64, step: f64) {
        let change = step * (target - self.value(active)) / ACTIVE as f64;
        active.iter().for_each(|&tile| self.0[tile as usize] += change);
    }
}
