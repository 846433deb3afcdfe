//! The running sum of the change probabilities of all cells.
//!
//! The rate of a cell stays constant while the cell is out of view. The probability that the cell did not change is
//! therefore multiplied by the same factor in every step of the same length: one product per cell and reading,
//! instead of one exponential.

use super::change_probability;
use crate::change::CellMap;

/// Steps that differ by less than this share count as equal. The error of the probability of a cell stays below
/// this share: the longer the time since the last observation, the smaller the probability.
const SAME_STEP: f64 = 1e-11;
/// Values below this count as 0: operations on very small numbers are slow.
const NOTHING: f64 = 1e-30;
/// The number of steps after which everything is computed anew, so that rounding errors do not accumulate.
const RENEWAL: u32 = 1 << 14;
/// The number of sums that are computed side by side, since each addition has to wait for the one before.
const LANES: usize = 4;

/// The cells that ever changed, in the order of [`CellMap::changed`].
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct ExpectedChanges {
    /// The probability that the cell did not change since the last observation; 1 in view.
    survival: Vec<f64>,
    /// The factor by which the survival is multiplied in a step; 1 in view.
    factor: Vec<f64>,
    rate: Vec<f64>,
    last_seen: Vec<f64>,
    is_in_view: Vec<bool>,
    /// The cells in view at the last sum, and those that came into view since.
    in_view: Vec<usize>,
    /// The time of the last sum, and the step from the sum before.
    time: f64,
    step: f64,
    /// Whether the factors belong to `step`.
    has_factors: bool,
    age: u32,
}

impl ExpectedChanges {
    /// Records the cells that a reading brought into view, or found changed for the first time.
    pub(crate) fn note(&mut self, cells: &CellMap) {
        // Cells that changed for the first time come first: one of them may also have returned into view.
        let (before, after) = (self.survival.len(), cells.changed.len());
        self.survival.resize(after, 1.0);
        self.factor.resize(after, 1.0);
        self.rate.resize(after, 0.0);
        self.last_seen.resize(after, 0.0);
        self.is_in_view.resize(after, true);
        self.in_view.extend(before..after);
        for &slot in &cells.returned {
            let slot = slot as usize;
            if !std::mem::replace(&mut self.is_in_view[slot], true) {
                (self.survival[slot], self.factor[slot]) = (1.0, 1.0);
                self.in_view.push(slot);
            }
        }
    }

    /// Whether the lists are those of the cells that ever changed.
    pub(crate) fn is_sound(&self, cells: &CellMap) -> bool {
        let Self { survival, factor, rate, last_seen, is_in_view, in_view, .. } = self;
        let count = survival.len();
        count <= cells.changed.len()
            && [factor.len(), rate.len(), last_seen.len(), is_in_view.len()] == [count; 4]
            && in_view.len() <= count
            && in_view.iter().all(|slot| *slot < count)
            && self.age <= RENEWAL
    }

    /// The expected number of cells that changed since they were last observed.
    pub(super) fn sum(&mut self, cells: &CellMap) -> f64 {
        let now = cells.time();
        self.pass_to(now);
        let mut kept = 0;
        for position in 0..self.in_view.len() {
            let slot = self.in_view[position];
            let index = cells.changed[slot] as usize;
            if cells.is_seen_now(index) {
                self.in_view[kept] = slot;
                kept += 1;
                continue;
            }
            let (last_seen, rate) = (cells.last_seen(index), cells.acting_rate(index));
            self.is_in_view[slot] = false;
            (self.last_seen[slot], self.rate[slot]) = (last_seen, rate);
            self.survival[slot] = 1.0 - change_probability(now - last_seen, rate);
            self.factor[slot] = self.factor_of(rate);
        }
        self.in_view.truncate(kept);
        let mut sums = [0.0; LANES];
        let chunks = self.survival.chunks_exact(LANES);
        let rest: f64 = chunks.remainder().iter().map(|survival| 1.0 - survival).sum();
        for chunk in chunks {
            for (sum, survival) in sums.iter_mut().zip(chunk) {
                *sum += 1.0 - survival;
            }
        }
        sums.iter().sum::<f64>() + rest
    }

    fn factor_of(&self, rate: f64) -> f64 {
        1.0 - change_probability(self.step, rate)
    }

    /// Advances the time of the cells out of view.
    fn pass_to(&mut self, now: f64) {
        let step = now - self.time;
        if step == 0.0 {
            return;
        }
        self.time = now;
        let is_same = (step - self.step).abs() <= SAME_STEP * step;
        self.age += 1;
        if is_same && self.has_factors && self.age < RENEWAL {
            for (survival, factor) in self.survival.iter_mut().zip(&self.factor) {
                let left = *survival * factor;
                *survival = if left < NOTHING { 0.0 } else { left };
            }
            return;
        }
        // The factors are computed only when a step repeats.
        (self.step, self.has_factors, self.age) = (step, is_same, 0);
        for slot in 0..self.survival.len() {
            if self.is_in_view[slot] {
                continue;
            }
            self.survival[slot] = 1.0 - change_probability(now - self.last_seen[slot], self.rate[slot]);
            if is_same {
                self.factor[slot] = self.factor_of(self.rate[slot]);
            }
        }
    }
}
