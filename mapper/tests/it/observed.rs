//! All public results of a mapper, for comparison.

use interfaces::{Cell, CellState, Transition};
use mapper::{CellStatistics, Mapper};
use nalgebra::Point2;

/// The public results for one cell.
#[derive(Debug, PartialEq)]
pub(crate) struct ObservedCell {
    state: CellState,
    statistics: CellStatistics,
    is_known: bool,
    is_in_view: bool,
    is_candidate: bool,
    figures: [u64; 7],
}

/// The sum of all change probabilities, and the longest recency.
pub(crate) fn features(mapper: &mut Mapper) -> [f64; 2] {
    [mapper.sum_change_probability(), mapper.max_recency()]
}

/// The public results of a mapper; numbers are compared bit by bit.
#[derive(Debug, PartialEq)]
pub(crate) struct Observed {
    cells: Vec<ObservedCell>,
    transitions: Vec<Transition>,
    points: Vec<Point2<f64>>,
    changed: Vec<usize>,
    time: u64,
    readings: usize,
    features: [u64; 2],
}

impl Observed {
    pub(crate) fn of(mapper: &Mapper) -> Self {
        // Quantiles take long to compute; a part of the cells is enough.
        let interval = |index: usize| match index % 17 {
            0 => mapper.credible_interval(index, 0.9),
            _ => (0.0, 0.0),
        };
        let cell = |index: usize| ObservedCell {
            state: mapper.states().cells()[index],
            statistics: mapper.statistics(index),
            is_known: mapper.was_ever_seen(index),
            is_in_view: mapper.is_in_view(index),
            is_candidate: mapper.is_candidate(index),
            figures: [
                mapper.interval(index),
                mapper.rate(index),
                mapper.change_probability(index),
                mapper.recency(index),
                mapper.blocked_probability(index),
                interval(index).0,
                interval(index).1,
            ]
            .map(f64::to_bits),
        };
        let [p, r] = features(&mut mapper.clone());
        Self {
            cells: (0..mapper.frame().len()).map(cell).collect(),
            transitions: mapper.transitions().to_vec(),
            points: mapper.points().to_vec(),
            changed: mapper.changed().collect(),
            time: mapper.time().to_bits(),
            readings: mapper.readings(),
            features: [p.to_bits(), r.to_bits()],
        }
    }
}

/// The changes of known cells in the last update.
pub(crate) fn changes(mapper: &Mapper) -> impl Iterator<Item = Cell> {
    let changes = mapper.transitions().iter().filter(|transition| transition.event().is_some());
    changes.map(|transition| transition.cell)
}

/// Every number of every cell is valid: no NaN, no infinite rate, no negative time.
pub(crate) fn assert_sound(mapper: &Mapper) {
    for index in 0..mapper.frame().len() {
        let seen = mapper.statistics(index);
        let times =
            [seen.first_seen, seen.last_seen, seen.unobserved, seen.watched_free, seen.watched_blocked];
        assert!(times.iter().all(|time| time.is_finite() && *time >= 0.0), "{seen:?}");
        assert!(mapper.interval(index) > 0.0, "interval {} of {seen:?}", mapper.interval(index));
        let rate = mapper.rate(index);
        assert!(rate.is_finite() && rate >= 0.0, "rate {rate} of {seen:?}");
        let probability = mapper.change_probability(index);
        assert!((0.0..=1.0).contains(&probability), "P(E > 0) = {probability} of {seen:?}");
        let cycle = mapper.interval(index);
        let (within, expected) = match cycle.is_finite() && seen.events() > 0 {
            true => (mapper.change_probability_within(index, cycle), 1.0 - (-1.0_f64).exp()),
            false => (mapper.change_probability_within(index, 1e9), 0.0),
        };
        assert!((within - expected).abs() < 1e-9, "{within} within a cycle of {cycle}");
        let blocked = mapper.blocked_probability(index);
        assert!((0.0..=1.0).contains(&blocked), "P(blocked) = {blocked} of {seen:?}");
        let (low, high) = mapper.credible_interval(index, 0.9);
        assert!(low >= 0.0 && low <= high, "a rate from {low} to {high} of {seen:?}");
        if let Some((block, free)) = mapper.transition_rates(index) {
            assert!([rate, block, free].iter().all(|rate| *rate > 0.0 && rate.is_finite()), "{seen:?}");
        }
        let recency = mapper.recency(index);
        assert!(recency.is_finite() && recency >= 0.0, "recency {recency} of {seen:?}");
    }
    let [p, r] = features(&mut mapper.clone());
    assert!((0.0..=mapper.frame().len() as f64).contains(&p), "p = {p}");
    assert!(r.is_finite() && r >= 0.0, "r = {r}");
}
