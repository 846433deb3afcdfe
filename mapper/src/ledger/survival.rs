//! The feature p, kept from reading to reading: how probable it is that the cells out of view did not
//! change since they were seen.
//!
//! The rate of a cell stands still while the cell is out of view, so the probability that it did not
//! change shrinks by the same factor in every step of the same length: one product per cell and
//! reading, where the definition takes an exponential.

use crate::estimator::change_probability;

/// Steps that differ by less than this part are equal. What a cell's probability is off for it stays
/// below: the longer since the cell was seen, the smaller the probability.
const SAME_STEP: f64 = 1e-11;
/// Less than this is 0: products of ever smaller numbers take long.
const NOTHING: f64 = 1e-30;
/// Steps after which everything is computed anew, so that roundings do not add up.
const RENEWAL: u32 = 1 << 14;
/// Sums that run beside each other, since one addition has to wait for the one before.
const LANES: usize = 4;

/// A cell's place in the record of cells that ever changed.
pub(super) type Slot = u32;

/// The cells that ever changed, in the order of their first change.
#[derive(Clone, Debug, Default)]
pub(super) struct Survival {
    cells: Vec<u32>,
    /// The probability that the cell did not change since it was last seen; 1 in view.
    survival: Vec<f64>,
    /// What that shrinks by in a step; 1 in view.
    factor: Vec<f64>,
    rate: Vec<f64>,
    last_seen: Vec<f64>,
    is_in_view: Vec<bool>,
    /// The slots in view at the last sum, and those that came into view since.
    in_view: Vec<Slot>,
    /// The time of the last sum, and its distance from the one before.
    time: f64,
    step: f64,
    /// Whether the factors are for `step`.
    has_factors: bool,
    age: u32,
}

impl Survival {
    /// The cells that ever changed.
    pub(super) fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// A cell changed for the first time, in view of the open reading.
    pub(super) fn add(&mut self, index: usize) -> Slot {
        let slot = self.cells.len() as Slot;
        self.cells.push(index as u32);
        self.survival.push(1.0);
        self.factor.push(1.0);
        self.rate.push(0.0);
        self.last_seen.push(0.0);
        self.is_in_view.push(true);
        self.in_view.push(slot);
        slot
    }

    /// A cell came back into view.
    #[inline]
    pub(super) fn came_back(&mut self, slot: Slot) {
        let at = slot as usize;
        if !std::mem::replace(&mut self.is_in_view[at], true) {
            (self.survival[at], self.factor[at]) = (1.0, 1.0);
            self.in_view.push(slot);
        }
    }

    /// The expected number of cells that changed since they were seen. `look` tells, for a cell that
    /// the open reading does not see, when it was last seen, and its rate.
    pub(super) fn sum_changed(&mut self, now: f64, mut look: impl FnMut(usize) -> Option<(f64, f64)>) -> f64 {
        self.pass_to(now);
        let mut kept = 0;
        for position in 0..self.in_view.len() {
            let slot = self.in_view[position];
            let at = slot as usize;
            let Some((last_seen, rate)) = look(self.cells[at] as usize) else {
                self.in_view[kept] = slot;
                kept += 1;
                continue;
            };
            self.is_in_view[at] = false;
            (self.last_seen[at], self.rate[at]) = (last_seen, rate);
            self.survival[at] = 1.0 - change_probability(now - last_seen, rate);
            self.factor[at] = self.factor_of(rate);
        }
        self.in_view.truncate(kept);
        self.sum()
    }

    fn factor_of(&self, rate: f64) -> f64 {
        1.0 - change_probability(self.step, rate)
    }

    /// Lets the time pass for the cells out of view.
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
        // Factors are worth their cost once a step repeats.
        (self.step, self.has_factors, self.age) = (step, is_same, 0);
        for at in 0..self.cells.len() {
            if self.is_in_view[at] {
                continue;
            }
            self.survival[at] = 1.0 - change_probability(now - self.last_seen[at], self.rate[at]);
            if is_same {
                self.factor[at] = self.factor_of(self.rate[at]);
            }
        }
    }

    fn sum(&self) -> f64 {
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
}
