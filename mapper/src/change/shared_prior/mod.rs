//! The prior of the rates of traversable cells, learned from all of them (empirical Bayes).
//!
//! The rate of a cell has a gamma distribution. Its mean depends on the place: first on the distance to the nearest wall, by the
//! mean rate that was observed at this distance (people walk in the middle of a room, and seldom along its walls), then on
//! what was observed around the cell. Its shape is common to all cells, and follows from how far the numbers of cycles differ
//! from their expectations: cells are alike where people walk everywhere (one event says little about a cell), and differ where a
//! few doors move and the rest stands still.

mod beside;

use beside::Links;
use interfaces::GridFrame;

/// A gamma distribution of a cycle rate: what is known after `events` cycles in the time `time`. Its shape is `events`, its
/// mean `events / time`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct RateDistribution {
    /// The number of cycles.
    pub events: f64,
    /// The time in view, in the time unit of the readings.
    pub time: f64,
}

impl RateDistribution {
    /// The mean rate.
    pub fn mean(self) -> f64 {
        self.events / self.time
    }

    /// This prior, or for a cell that is too lively for it (a lamp or a fan in a still room) one that says nothing, if that
    /// explains the cycles better.
    #[must_use]
    pub(super) fn or_lively(self, cycles: u32, observed: f64) -> Self {
        let is_lively = LIVELY.log_evidence(cycles, observed) + libm::log(LIVELY_SHARE)
            > self.log_evidence(cycles, observed);
        if cycles > 0 && is_lively { LIVELY } else { self }
    }

    /// The logarithm of the probability of `cycles` in the time `observed`, but for a term that depends on these alone.
    fn log_evidence(self, cycles: u32, observed: f64) -> f64 {
        let (shape, after) = (self.events, self.time + observed);
        libm::lgamma(shape + f64::from(cycles)) - libm::lgamma(shape) + shape * libm::log(self.time / after)
            - f64::from(cycles) * libm::log(after)
    }

    /// The distribution after `cycles` more cycles in the time `observed`.
    #[must_use]
    pub fn after(self, cycles: u32, observed: f64) -> Self {
        Self { events: self.events + f64::from(cycles), time: self.time + observed }
    }
}

/// The share of the cells whose rate the prior of their place says nothing about, and what is known of these: half a cycle per
/// unit of time, as much as one look says.
const LIVELY_SHARE: f64 = 1e-3;
const LIVELY: RateDistribution = RateDistribution { events: 0.5, time: 1.0 };
/// The number of cycles of all cells together, before any observation: the mean of Jeffreys' posterior of a rate.
const FIRST_CYCLES: f64 = 0.5;
/// The width of a class of distances to the nearest wall, m, and the number of classes: the last is that of cells with
/// 0.6 m or more, where walls make no difference any more.
const CLASS_M: f64 = 0.05;
const CLASSES: usize = 12;
/// The area that a person covers on the way through a room, m²: 5 m times 0.5 m. The cells of this area change together and
/// count as one observation.
const PASSAGE_M2: f64 = 2.5;
/// Without observations the shape is 1, which counts as this many observations.
const USUAL_SHAPE_WEIGHT: f64 = 10.0;
/// The bounds of 1 / shape.
const DISPERSIONS: [f64; 2] = [0.1, 10.0];
/// Observations around a cell count less by a factor of e per this distance, m, along rows and columns.
const REACH_M: f64 = 0.2;

/// What was in view of every traversable cell.
#[derive(Clone, Debug, Default)]
pub(super) struct InView {
    /// The indices of the cells, in ascending order.
    pub(super) cells: Vec<u32>,
    pub(super) cycles: Vec<f32>,
    pub(super) times: Vec<f32>,
}

/// The prior of all traversable cells; the mean rate of each cell is kept apart.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
pub(super) struct RatePrior {
    shape: f64,
    /// The mean rate of all cells: that of cells which became traversable since.
    mean: f64,
}

impl RatePrior {
    /// The prior of a cell with this mean rate; 0 if the cell was not traversable when the prior was learned.
    pub(super) fn with_mean(self, mean: f32) -> RateDistribution {
        let mean = if mean > 0.0 { f64::from(mean) } else { self.mean };
        RateDistribution { events: self.shape, time: self.shape / mean }
    }

    /// The prior that follows from what was in view, and the mean rate of each traversable cell; `None` without any time.
    pub(super) fn learned(frame: &GridFrame, seen: InView) -> Option<Learned> {
        let InView { cells, cycles, times } = seen;
        let sum = |values: &[f32]| values.iter().copied().map(f64::from).sum::<f64>();
        let mean = (FIRST_CYCLES + sum(&cycles)) / sum(&times);
        if !(mean.is_finite() && mean > 0.0) {
            return None;
        }
        let links = beside::links(frame, &cells);
        let mut means = means_by_clearance(frame, mean, &links, &cycles, &times);
        let mut expected = times;
        expected.iter_mut().zip(&means).for_each(|(time, mean)| *time *= mean);
        let shape = shape(frame, &cycles, &expected);
        let pairs = cycles.into_iter().zip(expected).map(|(cycles, expected)| [cycles, expected]);
        let mut near: Vec<[f32; 2]> = std::iter::once([0.0; 2]).chain(pairs).collect();
        around(frame, &links, &mut near);
        for (mean, [cycles, expected]) in means.iter_mut().zip(&near[1..]) {
            *mean *= (cycles + shape as f32) / (expected + shape as f32);
        }
        Some(Learned { prior: Self { shape, mean }, cells, means })
    }
}

/// What [`RatePrior::learned`] finds.
pub(super) struct Learned {
    pub(super) prior: RatePrior,
    /// The traversable cells, and the mean rate of each.
    pub(super) cells: Vec<u32>,
    pub(super) means: Vec<f32>,
}

/// The mean rate of the cells with the same distance to the nearest wall, shrunk toward the mean of all like one cycle.
fn means_by_clearance(
    frame: &GridFrame,
    mean: f64,
    links: &[Links],
    cycles: &[f32],
    times: &[f32],
) -> Vec<f32> {
    let classes = clearance_classes(frame, links);
    let mut sums = [RateDistribution { events: 1.0, time: 1.0 / mean }; CLASSES];
    for ((&class, &cycles), &time) in classes.iter().zip(cycles).zip(times) {
        sums[class as usize].events += f64::from(cycles);
        sums[class as usize].time += f64::from(time);
    }
    let rates = sums.map(|sum| sum.mean() as f32);
    classes.into_iter().map(|class| rates[class as usize]).collect()
}

/// The class of the distance of each traversable cell to the nearest cell that is not: a chamfer distance in two passes
/// (Borgefors, 1986).
fn clearance_classes(frame: &GridFrame, links: &[Links]) -> Vec<u8> {
    const DIAGONAL: f32 = std::f32::consts::SQRT_2;
    /// The cells above and after a cell: bit 0 for the two along rows and columns, bit 1 for the two diagonal ones.
    const BOTH: [u8; 2] = [0b0011, 0b1100];
    let mut distances = vec![0.0_f32; links.len()];
    for (cell, Links { before, below: [left, below, right] }) in links.iter().enumerate().skip(1) {
        let of = |cell: &u32| distances[*cell as usize];
        distances[cell] = (of(before).min(of(below)) + 1.0).min(of(left).min(of(right)) + DIAGONAL);
    }
    // Each cell passes its distance on to those below and before, which come later in this order.
    let mut passed_on = vec![0_u8; links.len()];
    for (cell, Links { before, below: [left, below, right] }) in links.iter().enumerate().skip(1).rev() {
        let mut distance = distances[cell];
        for (both, step) in BOTH.into_iter().zip([1.0, DIAGONAL]) {
            if passed_on[cell] & both != both {
                distance = distance.min(step);
            }
        }
        distances[cell] = distance;
        for (cell, step, bit) in
            [(before, 1.0, 0b0001), (left, DIAGONAL, 0b1000), (below, 1.0, 0b0010), (right, DIAGONAL, 0b0100)]
        {
            let passed = &mut distances[*cell as usize];
            *passed = passed.min(distance + step);
            passed_on[*cell as usize] |= bit;
        }
    }
    let per_class = (frame.resolution_m() / CLASS_M) as f32;
    let class = |distance: &f32| ((distance * per_class + 0.5) as usize).clamp(1, CLASSES) as u8 - 1;
    distances[1..].iter().map(class).collect()
}

/// The shape of the distribution of all rates, from the variance of the numbers of cycles beyond that of a Poisson
/// distribution, which is expected² / shape. A cell counts by the inverse of the square of its standard deviation for the shape 1.
fn shape(frame: &GridFrame, cycles: &[f32], expected: &[f32]) -> f64 {
    let (mut excess, mut square) = (0.0, 0.0);
    for (&cycles, &expected) in cycles.iter().zip(expected) {
        let (cycles, expected) = (f64::from(cycles), f64::from(expected));
        let weight = 1.0 / ((1.0 + expected) * (1.0 + expected));
        excess += weight * ((cycles - expected) * (cycles - expected) - expected);
        square += weight * expected * expected;
    }
    let observations = frame.resolution_m() * frame.resolution_m() / PASSAGE_M2;
    let dispersion =
        (observations * excess + USUAL_SHAPE_WEIGHT) / (observations * square + USUAL_SHAPE_WEIGHT);
    1.0 / dispersion.clamp(DISPERSIONS[0], DISPERSIONS[1])
}

/// The weighted means of two values around each cell, without its own: two-sided exponential filters along rows, then along
/// columns. Walls end them. The first values are those of no cell, 0.
fn around(frame: &GridFrame, links: &[Links], values: &mut [[f32; 2]]) {
    let fade = libm::exp(-frame.resolution_m() / REACH_M) as f32;
    let own_weight = (1.0 - fade) / (1.0 + fade);
    let own: Vec<[f32; 2]> =
        values.iter().map(|both| both.map(|value| own_weight * own_weight * value)).collect();
    let mut sums = [vec![[0.0; 2]; values.len()], vec![[0.0; 2]; values.len()]];
    filter(values, fade, own_weight, links, |links| links.before, &mut sums);
    filter(values, fade, own_weight, links, |links| links.below[1], &mut sums);
    for (both, own) in values.iter_mut().zip(own) {
        *both = [0, 1].map(|side| (both[side] - own[side]).max(0.0));
    }
}

/// A two-sided exponential filter; `before` is the cell before a cell, along a row or a column. `sums` is scratch memory.
fn filter(
    values: &mut [[f32; 2]],
    fade: f32,
    own_weight: f32,
    links: &[Links],
    before: impl Fn(&Links) -> u32,
    [forward, backward]: &mut [Vec<[f32; 2]>; 2],
) {
    for (cell, links) in links.iter().enumerate().skip(1) {
        let (sum, value) = (forward[before(links) as usize], values[cell]);
        forward[cell] = [0, 1].map(|side| sum[side] * fade + value[side]);
    }
    // The sums of the cells after each cell.
    backward.fill([0.0; 2]);
    for (cell, links) in links.iter().enumerate().skip(1).rev() {
        let (value, after) = (values[cell], backward[cell]);
        let sum = [0, 1].map(|side| after[side] * fade + value[side]);
        backward[before(links) as usize] = sum;
        values[cell] = [0, 1].map(|side| (forward[cell][side] + sum[side] - value[side]) * own_weight);
    }
}

#[cfg(test)]
mod tests;
