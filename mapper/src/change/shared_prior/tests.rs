//! The simple way to the same prior: every neighbor is searched for, and every value has a filter of its own.

use super::{CLASS_M, CLASSES, FIRST_CYCLES, InView, Learned, REACH_M, RateDistribution, RatePrior, shape};
use interfaces::GridFrame;
use nalgebra::Point2;
use proptest::prelude::*;

fn learned(frame: &GridFrame, seen: InView) -> Option<(f64, f64, Vec<f32>)> {
    let InView { cells, cycles, times } = seen;
    let sum = |values: &[f32]| values.iter().copied().map(f64::from).sum::<f64>();
    let mean = (FIRST_CYCLES + sum(&cycles)) / sum(&times);
    if !(mean.is_finite() && mean > 0.0) {
        return None;
    }
    let beside = Beside { width: frame.width() as u32, cells: &cells };
    let mut means = means_by_clearance(frame, mean, &beside, &cycles, &times);
    let mut expected = times;
    expected.iter_mut().zip(&means).for_each(|(time, mean)| *time *= mean);
    let shape = shape(frame, &cycles, &expected);
    let [cycles, expected] = [cycles, expected].map(|values| around(frame, &beside, values));
    for ((mean, cycles), expected) in means.iter_mut().zip(cycles).zip(expected) {
        *mean *= (cycles + shape as f32) / (expected + shape as f32);
    }
    Some((shape, mean, means))
}

/// The position of the neighbors in the list of all cells.
struct Beside<'a> {
    cells: &'a [u32],
    width: u32,
}

impl Beside<'_> {
    /// The cell that is this number of columns to the right of a cell, and rows above it.
    fn at(&self, position: usize, right: i64, above: i64) -> Option<usize> {
        let (index, width) = (i64::from(self.cells[position]), i64::from(self.width));
        let column = index % width + right;
        let wanted = index + above * width + right;
        let is_inside = (0..width).contains(&column) && wanted >= 0;
        is_inside.then(|| self.cells.binary_search(&u32::try_from(wanted).ok()?).ok())?
    }

    fn before(&self, position: usize) -> Option<usize> {
        self.at(position, -1, 0)
    }

    fn below(&self, position: usize) -> [Option<usize>; 3] {
        [-1, 0, 1].map(|right| self.at(position, right, -1))
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
    let count = beside.cells.len();
    let mut distances = vec![0.0_f32; count];
    let of = |distances: &[f32], cell: Option<usize>| cell.map_or(0.0, |cell| distances[cell]);
    for position in 0..count {
        let [left, below, right] = beside.below(position).map(|cell| of(&distances, cell));
        let before = of(&distances, beside.before(position));
        distances[position] = (before.min(below) + 1.0).min(left.min(right) + DIAGONAL);
    }
    for position in (0..count).rev() {
        let near = |right, above| of(&distances, beside.at(position, right, above));
        let straight = near(1, 0).min(near(0, 1)) + 1.0;
        let diagonal = near(-1, 1).min(near(1, 1)) + DIAGONAL;
        distances[position] = distances[position].min(straight).min(diagonal);
    }
    let per_class = (frame.resolution_m() / CLASS_M) as f32;
    let class = |distance: f32| ((distance * per_class + 0.5) as usize).clamp(1, CLASSES) as u8 - 1;
    distances.into_iter().map(class).collect()
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

proptest! {
    /// Cells in any places, also at the borders of narrow grids.
    #[test]
    fn the_prior_has_the_same_bits_as_that_of_the_simple_way(
        width in 1usize..40,
        cells in prop::collection::vec((prop::bool::weighted(0.8), 0u8..4, 0.0f32..500.0), 1..900),
    ) {
        let height = cells.len().div_ceil(width);
        let frame = GridFrame::new(Point2::origin(), 0.05, width, height).unwrap();
        let mut seen = [InView::default(), InView::default()];
        for (index, (_, cycles, time)) in cells.into_iter().enumerate().filter(|(_, cell)| cell.0) {
            for seen in &mut seen {
                seen.cells.push(index as u32);
                seen.cycles.push(f32::from(cycles / 2));
                seen.times.push(time);
            }
        }
        let [one, other] = seen;
        let found = RatePrior::learned(&frame, one);
        let expected = learned(&frame, other);
        prop_assert_eq!(found.is_some(), expected.is_some());
        if let (Some(Learned { prior, means, .. }), Some((shape, mean, expected))) = (found, expected) {
            prop_assert_eq!([prior.shape, prior.mean].map(f64::to_bits), [shape, mean].map(f64::to_bits));
            let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&means), bits(&expected));
        }
    }
}
