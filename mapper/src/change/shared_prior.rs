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
        let beside = Beside::new(frame, &cells);
        let mut means = means_by_clearance(frame, mean, &beside, &cycles, &times);
        let mut expected = times;
        expected.iter_mut().zip(&means).for_each(|(time, mean)| *time *= mean);
        let shape = shape(frame, &cycles, &expected);
        let [cycles, expected] = [cycles, expected].map(|values| around(frame, &beside, values));
        for ((mean, cycles), expected) in means.iter_mut().zip(cycles).zip(expected) {
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

/// Which traversable cells lie beside each other. A cell is known by its position in the list of all of them.
struct Beside<'a> {
    cells: &'a [u32],
    width: u32,
    /// For each cell, the first one that is not before the place below and to the left.
    below: Vec<u32>,
}

impl<'a> Beside<'a> {
    fn new(frame: &GridFrame, cells: &'a [u32]) -> Self {
        let width = frame.width() as u32;
        let mut first = 0;
        let below = cells.iter().map(|index| {
            while cells[first] + width + 1 < *index {
                first += 1;
            }
            first as u32
        });
        let below = below.collect();
        Self { cells, width, below }
    }

    /// The cell before a cell in its row.
    fn before(&self, position: usize) -> Option<usize> {
        let before = position.checked_sub(1)?;
        let index = self.cells[position];
        (self.cells[before] + 1 == index && !index.is_multiple_of(self.width)).then_some(before)
    }

    /// The cells below and to the left, below, and below and to the right.
    fn below(&self, position: usize) -> [Option<usize>; 3] {
        let (first, index) = (self.below[position] as usize, self.cells[position]);
        let column = index % self.width;
        let mut found = [None; 3];
        for (at, cell) in self.cells[first..position].iter().enumerate().take(3) {
            // 0 for the place to the left, 1 below, 2 to the right.
            let side = (cell + self.width + 1).wrapping_sub(index) as usize;
            let is_in_row = (side > 0 || column > 0) && (side < 2 || column + 1 < self.width);
            if side < 3 && is_in_row {
                found[side] = Some(first + at);
            }
        }
        found
    }
}

/// The mean rate of the cells with the same distance to the nearest wall, shrunk toward the mean of all like one cycle.
fn means_by_clearance(
    frame: &GridFrame,
    mean: f64,
    beside: &Beside<'_>,
    cycles: &[f32],
    times: &[f32],
) -> Vec<f32> {
    let classes = clearance_classes(frame, beside);
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
fn clearance_classes(frame: &GridFrame, beside: &Beside<'_>) -> Vec<u8> {
    const DIAGONAL: f32 = std::f32::consts::SQRT_2;
    /// The cells above and after a cell: bit 0 for the two along rows and columns, bit 1 for the two diagonal ones.
    const BOTH: [u8; 2] = [0b0011, 0b1100];
    const STEPS: [(f32, u8); 3] = [(DIAGONAL, 0b1000), (1.0, 0b0010), (DIAGONAL, 0b0100)];
    let count = beside.cells.len();
    let mut distances = vec![0.0_f32; count];
    let of = |distances: &[f32], cell: Option<usize>| cell.map_or(0.0, |cell| distances[cell]);
    for position in 0..count {
        let [left, below, right] = beside.below(position).map(|cell| of(&distances, cell));
        let before = of(&distances, beside.before(position));
        distances[position] = (before.min(below) + 1.0).min(left.min(right) + DIAGONAL);
    }
    // Each cell passes its distance on to those below and before, which come later in this order.
    let mut passed_on = vec![0_u8; count];
    for position in (0..count).rev() {
        let mut distance = distances[position];
        for (both, step) in BOTH.into_iter().zip([1.0, DIAGONAL]) {
            if passed_on[position] & both != both {
                distance = distance.min(step);
            }
        }
        distances[position] = distance;
        let before = beside.before(position).map(|cell| (cell, (1.0, 0b0001)));
        let below =
            beside.below(position).into_iter().zip(STEPS).filter_map(|(cell, step)| Some((cell?, step)));
        for (cell, (step, bit)) in before.into_iter().chain(below) {
            distances[cell] = distances[cell].min(distance + step);
            passed_on[cell] |= bit;
        }
    }
    let per_class = (frame.resolution_m() / CLASS_M) as f32;
    let class = |distance: f32| ((distance * per_class + 0.5) as usize).clamp(1, CLASSES) as u8 - 1;
    distances.into_iter().map(class).collect()
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
fn around(frame: &GridFrame, beside: &Beside<'_>, mut values: Vec<f32>) -> Vec<f32> {
    let fade = libm::exp(-frame.resolution_m() / REACH_M) as f32;
    let own_weight = (1.0 - fade) / (1.0 + fade);
    let own: Vec<f32> = values.iter().map(|value| own_weight * own_weight * value).collect();
    filter(&mut values, fade, own_weight, |position| beside.before(position));
    filter(&mut values, fade, own_weight, |position| beside.below(position)[1]);
    values.iter_mut().zip(own).for_each(|(value, own)| *value = (*value - own).max(0.0));
    values
}

/// A two-sided exponential filter; `before` is the cell before a cell, along a row or a column.
fn filter(values: &mut [f32], fade: f32, own_weight: f32, before: impl Fn(usize) -> Option<usize>) {
    let mut forward = vec![0.0; values.len()];
    for position in 0..values.len() {
        let sum = before(position).map_or(0.0, |before| forward[before]);
        forward[position] = sum * fade + values[position];
    }
    // The sums of the cells after each cell.
    let mut backward = vec![0.0; values.len()];
    for position in (0..values.len()).rev() {
        let value = &mut values[position];
        let sum = backward[position] * fade + *value;
        if let Some(before) = before(position) {
            backward[before] = sum;
        }
        *value = (forward[position] + sum - *value) * own_weight;
    }
}
