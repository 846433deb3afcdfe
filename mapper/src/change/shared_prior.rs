//! The prior of the rates of traversable cells, learned from all of them (empirical Bayes).
//!
//! The rate of a cell has a gamma distribution. Its mean depends on the place: first on the distance to the nearest wall, by the
//! mean rate that was observed at this distance (people walk in the middle of a room, and seldom along its walls), then on
//! what was observed around the cell. Its shape is common to all cells, and follows from how far the numbers of cycles differ
//! from their expectations: cells are alike where people walk everywhere (one event says little about a cell), and differ where a
//! few doors move and the rest stands still.

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

/// What was in view of every cell: 0 for a cell that is not traversable.
#[derive(Clone, Debug)]
pub(super) struct InView {
    pub(super) is_traversable: Vec<bool>,
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

    /// The prior that follows from what was in view, and the mean rate of each cell; `None` without any time.
    pub(super) fn learned(
        frame: &GridFrame,
        InView { is_traversable, cycles, times }: InView,
    ) -> Option<(Self, Vec<f32>)> {
        let sum = |values: &[f32]| values.iter().copied().map(f64::from).sum::<f64>();
        let mean = (FIRST_CYCLES + sum(&cycles)) / sum(&times);
        if !(mean.is_finite() && mean > 0.0) {
            return None;
        }
        let mut means = means_by_clearance(frame, mean, &is_traversable, &cycles, &times);
        let expected: Vec<f32> = means.iter().zip(&times).map(|(mean, time)| mean * time).collect();
        let shape = shape(frame, &cycles, &expected);
        let [cycles, expected] = [cycles, expected].map(|values| around(frame, &is_traversable, values));
        for ((mean, cycles), expected) in means.iter_mut().zip(cycles).zip(expected) {
            *mean *= (cycles + shape as f32) / (expected + shape as f32);
        }
        Some((Self { shape, mean }, means))
    }
}

/// The mean rate of the cells with the same distance to the nearest wall, shrunk toward the mean of all like one cycle.
fn means_by_clearance(
    frame: &GridFrame,
    mean: f64,
    is_traversable: &[bool],
    cycles: &[f32],
    times: &[f32],
) -> Vec<f32> {
    let classes = clearance_classes(frame, is_traversable);
    let mut sums = [RateDistribution { events: 1.0, time: 1.0 / mean }; CLASSES];
    for ((&class, &cycles), &time) in classes.iter().zip(cycles).zip(times) {
        sums[class].events += f64::from(cycles);
        sums[class].time += f64::from(time);
    }
    let rates = sums.map(|sum| sum.mean() as f32);
    let of_cell = |(class, is_traversable): (usize, &bool)| if *is_traversable { rates[class] } else { 0.0 };
    classes.into_iter().zip(is_traversable).map(of_cell).collect()
}

/// The class of the distance of each cell to the nearest cell that is not traversable: a chamfer distance in two passes
/// (Borgefors, 1986).
fn clearance_classes(frame: &GridFrame, is_traversable: &[bool]) -> Vec<usize> {
    const DIAGONAL: f32 = std::f32::consts::SQRT_2;
    let (width, row) = (frame.width(), frame.width() + 2);
    // A border of cells that are not traversable: every cell has eight neighbors.
    let mut distances = vec![0.0_f32; row * (frame.height() + 2)];
    let bordered = |index: usize| (index / width + 1) * row + index % width + 1;
    for index in (0..frame.len()).filter(|&index| is_traversable[index]) {
        let at = bordered(index);
        let straight = distances[at - 1].min(distances[at - row]) + 1.0;
        let diagonal = distances[at - row - 1].min(distances[at - row + 1]) + DIAGONAL;
        distances[at] = straight.min(diagonal);
    }
    for index in (0..frame.len()).rev().filter(|&index| is_traversable[index]) {
        let at = bordered(index);
        let straight = distances[at + 1].min(distances[at + row]) + 1.0;
        let diagonal = distances[at + row + 1].min(distances[at + row - 1]) + DIAGONAL;
        distances[at] = distances[at].min(straight.min(diagonal));
    }
    let per_class = (frame.resolution_m() / CLASS_M) as f32;
    let class = |index| ((distances[bordered(index)] * per_class + 0.5) as usize).clamp(1, CLASSES) - 1;
    (0..frame.len()).map(class).collect()
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

/// The weighted mean of the values around each cell, without its own: two-sided exponential filters along rows, then along
/// columns. Walls end them.
fn around(frame: &GridFrame, is_traversable: &[bool], mut values: Vec<f32>) -> Vec<f32> {
    let fade = libm::exp(-frame.resolution_m() / REACH_M) as f32;
    let own_weight = (1.0 - fade) / (1.0 + fade);
    let own: Vec<f32> = values.iter().map(|value| own_weight * own_weight * value).collect();
    let (width, height) = (frame.width(), frame.height());
    let mut forward = vec![0.0; width.max(height)];
    let mut filter = |start: usize, step: usize, length: usize| {
        let at = |position: usize| start + position * step;
        let mut sum = 0.0;
        for position in 0..length {
            sum = if is_traversable[at(position)] { sum * fade + values[at(position)] } else { 0.0 };
            forward[position] = sum;
        }
        sum = 0.0;
        for position in (0..length).rev() {
            let value = &mut values[at(position)];
            sum = if is_traversable[at(position)] { sum * fade + *value } else { 0.0 };
            *value = (forward[position] + sum - *value) * own_weight;
        }
    };
    (0..height).for_each(|row| filter(row * width, 1, width));
    (0..width).for_each(|column| filter(column, width, height));
    values.iter_mut().zip(own).for_each(|(value, own)| *value = (*value - own).max(0.0));
    values
}
