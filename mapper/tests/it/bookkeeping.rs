//! Change statistics and features, compared with a reference that stores every reading and recomputes everything
//! from the definitions each time.

use crate::observed::{assert_sound, features};
use interfaces::{Cell, CellState, Grid, GridFrame, Transition};
use mapper::{CellStatistics, EstimatorChoice, Mapper, MapperSettings};
use nalgebra::Point2;
use proptest::prelude::*;

const WIDTH: i32 = 6;
const HEIGHT: i32 = 4;

fn frame() -> GridFrame {
    GridFrame::new(Point2::origin(), 1.0, WIDTH as usize, HEIGHT as usize).unwrap()
}

/// One reading: a window of cells, some of which changed since they were last seen.
#[derive(Clone, Debug)]
struct Glance {
    wait: f64,
    low: (i32, i32),
    size: (i32, i32),
    /// Bit i: the cell at place i changes before this reading.
    changes: u32,
    /// Whether the features are computed after it.
    asks: bool,
}

fn glances() -> impl Strategy<Value = Vec<Glance>> {
    let wait = prop_oneof![6 => Just(1.0), 2 => 0.01..3.0f64, 1 => Just(0.0), 1 => 10.0..500.0f64];
    let changes =
        prop_oneof![2 => Just(0), 3 => any::<u32>().prop_flat_map(|a| any::<u32>().prop_map(move |b| a & b))];
    // Windows that reach out of the map on every side.
    let glance = (wait, (-2..WIDTH, -2..HEIGHT), (0..8, 0..6), changes, prop::bool::weighted(0.8))
        .prop_map(|(wait, low, size, changes, asks)| Glance { wait, low, size, changes, asks });
    prop::collection::vec(glance, 1..60)
}

/// All observations of a cell: the number of the reading, its time, and whether the cell was blocked.
type Sightings = Vec<(usize, f64, bool)>;

struct Book {
    sightings: Vec<Sightings>,
    /// Cells that are known before the first reading were seen "at time 0", long before it.
    prior: Vec<CellState>,
    /// Gaps up to this length do not count.
    max_gap: f64,
    /// The times of the readings.
    times: Vec<f64>,
    now: f64,
}

impl Book {
    fn known(&self, index: usize) -> CellState {
        match self.sightings[index].last() {
            Some((_, _, true)) => CellState::Blocked,
            Some((_, _, false)) => CellState::Free,
            None => self.prior[index],
        }
    }

    fn statistics(&self, index: usize) -> CellStatistics {
        let mut all = self.sightings[index].clone();
        if all.is_empty() {
            return CellStatistics::default();
        }
        let is_gapless = |a: (usize, f64, bool), b: (usize, f64, bool)| {
            a.0 != usize::MAX && (a.0 + 1 == b.0 || self.max_gap > 0.0 && b.1 - a.1 <= self.max_gap)
        };
        if self.prior[index] != CellState::Unknown {
            all.insert(0, (usize::MAX, 0.0, self.prior[index] == CellState::Blocked));
        }
        let last = all[all.len() - 1];
        let period = if last.0 == 0 { 0.0 } else { (last.1 - self.times[0]) / last.0 as f64 };
        let mut seen =
            CellStatistics { first_seen: all[0].1, last_seen: last.1, period, ..Default::default() };
        for pair in all.windows(2) {
            let ((_, time, was_blocked), (_, next_time, is_blocked)) = (pair[0], pair[1]);
            let in_view = is_gapless(pair[0], pair[1]);
            match (in_view, is_blocked) {
                (true, true) => seen.watched_blocked += next_time - time,
                (true, false) => seen.watched_free += next_time - time,
                (false, _) => seen.unobserved += next_time - time,
            }
            match (was_blocked, is_blocked, in_view) {
                (false, true, true) => seen.block_events += 1,
                (true, false, true) => seen.free_events += 1,
                (false, true, false) => seen.block_events_after_gap += 1,
                (true, false, false) => seen.free_events_after_gap += 1,
                _ => {}
            }
        }
        seen
    }

    /// Cycles per unit of time by the definitions of the estimators. Estimators that weigh gaps are left out; they
    /// have separate tests.
    fn rate(&self, index: usize, estimator: &str) -> Option<f64> {
        let seen = self.statistics(index);
        let (block, free) = (f64::from(seen.block_events), f64::from(seen.free_events));
        let gaps = (f64::from(seen.block_events_after_gap), f64::from(seen.free_events_after_gap));
        let observed = seen.last_seen - seen.first_seen - seen.unobserved;
        let interval = match estimator {
            "paper" => (observed / block).min(observed / free),
            "paper-all" => (observed / (block + gaps.0)).min(observed / (free + gaps.1)),
            "two-state" if block + free == 0.0 => f64::INFINITY,
            "two-state" => {
                let half_if_none = |events: f64| if events == 0.0 { 0.5 } else { events };
                seen.watched_free / half_if_none(block) + seen.watched_blocked / half_if_none(free)
            }
            _ => return None,
        };
        // 0/0: events, but no time in view.
        Some(if interval > 1e-9 { 1.0 / interval } else { 0.0 })
    }

    fn last_seen(&self, index: usize) -> f64 {
        self.sightings[index].last().map_or(0.0, |sighting| sighting.1)
    }

    fn is_candidate(&self, index: usize) -> bool {
        let frame = frame();
        let is_free = |cell: Cell| frame.index(cell).is_some_and(|at| self.known(at) == CellState::Free);
        let Cell { x, y } = frame.cell(index);
        [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)].iter().any(|(dx, dy)| is_free(Cell::new(x + dx, y + dy)))
    }

    /// The features by their definitions, given the rates.
    fn features(&self, rate: impl Fn(usize) -> f64) -> [f64; 2] {
        let cells = || 0..self.sightings.len();
        [
            cells().map(|at| 1.0 - (-(self.now - self.last_seen(at)) * rate(at)).exp()).sum(),
            cells()
                .filter(|&at| self.is_candidate(at))
                .map(|at| self.now - self.last_seen(at))
                .fold(0.0, f64::max),
        ]
    }
}

fn near(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= 1e-9 * (1.0 + a.abs().max(b.abs()))
}

fn assert_statistics(mapper: &Mapper, book: &Book, index: usize) {
    let (found, expected) = (mapper.statistics(index), book.statistics(index));
    let times = |seen: &CellStatistics| {
        let watched = [seen.unobserved, seen.watched_free, seen.watched_blocked];
        [[seen.first_seen, seen.last_seen, seen.period], watched].concat()
    };
    let is_near = times(&found).iter().zip(times(&expected)).all(|(&a, b)| near(a, b));
    let counts = |seen: &CellStatistics| {
        let CellStatistics {
            block_events, free_events, block_events_after_gap, free_events_after_gap, ..
        } = *seen;
        [block_events, free_events, block_events_after_gap, free_events_after_gap]
    };
    assert!(is_near && counts(&found) == counts(&expected), "found {found:?}, expected {expected:?}");
}

proptest! {
    #[test]
    fn statistics_and_features_are_those_of_the_book(
        glances in glances(),
        estimator in prop::sample::select(EstimatorChoice::all()),
        max_gap in prop::sample::select(vec![0.0, 2.5]),
        prior in prop_oneof![
            Just(vec![CellState::Unknown; 24]),
            prop::collection::vec(
                prop::sample::select(vec![CellState::Unknown, CellState::Free, CellState::Blocked]), 24),
        ],
    ) {
        let frame = frame();
        let settings = MapperSettings { estimator: estimator.clone(), max_gap, ..MapperSettings::default() };
        let grid = Grid::from_cells(frame, prior.clone()).unwrap();
        let mut mapper = Mapper::with_prior(&settings, grid).unwrap();
        let mut world: Vec<bool> = prior.iter().map(|&state| state == CellState::Blocked).collect();
        let mut book = Book { sightings: vec![Vec::new(); frame.len()], prior, max_gap, times: Vec::new(), now: 0.0 };

        for (number, glance) in glances.iter().enumerate() {
            book.now += glance.wait;
            book.times.push(book.now);
            for (index, blocked) in world.iter_mut().enumerate() {
                *blocked ^= glance.changes >> index & 1 == 1;
            }
            let (low, size) = (glance.low, glance.size);
            let window = (low.1..low.1 + size.1).flat_map(|y| (low.0..low.0 + size.0).map(move |x| Cell::new(x, y)));
            let cells: Vec<(Cell, bool)> =
                window.map(|cell| (cell, frame.index(cell).is_some_and(|index| world[index]))).collect();
            let mut expected = Vec::new();
            for &(cell, blocked) in &cells {
                let Some(index) = frame.index(cell) else { continue };
                let before = book.known(index);
                book.sightings[index].push((number, book.now, blocked));
                let after = book.known(index);
                if before != after {
                    expected.push(Transition { cell, before, after });
                }
            }
            mapper.update(&crate::cells(book.now, cells)).unwrap();

            prop_assert_eq!(mapper.transitions(), expected);
            for index in 0..frame.len() {
                prop_assert_eq!(mapper.states().cells()[index], book.known(index));
                prop_assert_eq!(mapper.is_candidate(index), book.is_candidate(index));
                prop_assert_eq!(mapper.was_ever_seen(index), !book.sightings[index].is_empty());
                let in_view = book.sightings[index].last().is_some_and(|sighting| sighting.0 == number);
                prop_assert_eq!(mapper.is_in_view(index), in_view);
                prop_assert!(near(mapper.recency(index), book.now - book.last_seen(index)));
                assert_statistics(&mapper, &book, index);
                if let Some(rate) = book.rate(index, estimator.name()) {
                    prop_assert!(near(mapper.rate(index), rate), "{}, not {rate}", mapper.rate(index));
                    prop_assert_eq!(mapper.acting_rate(index), mapper.rate(index));
                }
            }
            if glance.asks {
                let (found, expected) = (features(&mut mapper), book.features(|index| mapper.acting_rate(index)));
                prop_assert!(near(found[0], expected[0]) && near(found[1], expected[1]), "{:?}, not {:?}", found, expected);
            }
        }
    }

    /// Times that stay equal, advance slowly or jump, and contradicting states of cells: all results must be valid
    /// numbers.
    #[test]
    fn no_stream_makes_a_rate_that_is_not_a_number(
        readings in prop::collection::vec(
            (prop::sample::select(vec![0.0, f64::from_bits(1), f64::MIN_POSITIVE, 1e-300, 1.0, 1e300, f64::MAX]),
             prop::collection::vec((-1..=WIDTH, -1..=HEIGHT, any::<bool>()), 0..30)),
            1..20),
        estimator in prop::sample::select(EstimatorChoice::all()),
    ) {
        let settings = MapperSettings { estimator, ..MapperSettings::default() };
        let mut mapper = Mapper::new(&settings, frame()).unwrap();
        let mut time: f64 = 0.0;
        for (wait, cells) in readings {
            time = (time + wait).min(f64::MAX);
            let cells = cells.into_iter().map(|(x, y, blocked)| (Cell::new(x, y), blocked));
            mapper.update(&crate::cells(time, cells)).unwrap();
            assert_sound(&mapper);
        }
    }
}
