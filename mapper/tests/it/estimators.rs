//! Properties of estimates for any observations, and how `two-state-gaps` treats cells that are not Markov chains.

use interfaces::{Cell, CellState, GridFrame};
use mapper::{EstimatorChoice, Mapper, MapperSettings, SharedPrior, TwoState, TwoStateGaps};
use nalgebra::Point2;
use proptest::prelude::*;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Gamma};

/// The estimator under which traversable cells share a prior.
const SHARED: &str = "shared-prior";

/// A mapper of one row of cells.
fn mapper(estimator: impl Into<EstimatorChoice>, cells: usize) -> Mapper {
    let frame = GridFrame::new(Point2::origin(), 1.0, cells, 1).unwrap();
    let estimator = estimator.into();
    Mapper::new(&MapperSettings { estimator, ..MapperSettings::default() }, frame).unwrap()
}

/// Gives a mapper the states of some cells, each with its column.
fn show(mapper: &mut Mapper, time: f64, cells: impl IntoIterator<Item = (usize, bool)>) {
    let cells = cells.into_iter().map(|(x, blocked)| (Cell::new(x as i32, 0), blocked));
    mapper.update(&crate::cells(time, cells)).unwrap();
}

/// Chains that leave their states with the probabilities `leave` (free, blocked) per step, `apart` columns from
/// each other, all observed whenever `looks` is true.
fn chains(count: usize, apart: usize, steps: u32, leave: [f64; 2], looks: fn(u32) -> bool) -> Mapper {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let share_blocked = leave[0] / (leave[0] + leave[1]);
    let mut blocked: Vec<bool> = (0..count).map(|_| random.random_bool(share_blocked)).collect();
    let mut mapper = mapper(TwoStateGaps, count * apart);
    for step in 0..steps {
        let seen = blocked.iter().enumerate().filter(|_| looks(step));
        show(&mut mapper, f64::from(step), seen.map(|(cell, &blocked)| (cell * apart, blocked)));
        for blocked in &mut blocked {
            *blocked ^= random.random_bool(leave[usize::from(*blocked)]);
        }
    }
    mapper
}

/// Cycles per step of a chain.
fn cycle_rate([block, free]: [f64; 2]) -> f64 {
    block * free / (block + free)
}

/// A stream of observations of three cells: which of them are seen, and which are blocked.
fn streams() -> impl Strategy<Value = Vec<[(bool, bool); 3]>> {
    prop::collection::vec(prop::array::uniform3((prop::bool::weighted(0.7), any::<bool>())), 2..120)
}

fn after(estimator: &EstimatorChoice, stream: &[[(bool, bool); 3]], step: f64, mirrored: bool) -> Mapper {
    let mut mapper = mapper(estimator.clone(), 3);
    for (number, cells) in stream.iter().enumerate() {
        let seen = cells.iter().enumerate().filter(|(_, (is_seen, _))| *is_seen);
        show(&mut mapper, number as f64 * step, seen.map(|(x, (_, blocked))| (x, *blocked != mirrored)));
    }
    mapper
}

fn assert_near(found: f64, expected: f64) {
    let is_near = found == expected || (found / expected - 1.0).abs() < 1e-6;
    assert!(is_near, "{found}, not {expected}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// A cycle blocked → free → blocked counts the same as free → blocked → free.
    #[test]
    fn free_and_blocked_are_alike(stream in streams()) {
        // Free cells are traversable, blocked ones are walls until they change: a shared prior treats them differently.
        for estimator in EstimatorChoice::all().iter().filter(|estimator| estimator.name() != SHARED) {
            let [seen, mirrored] = [false, true].map(|mirrored| after(estimator, &stream, 1.0, mirrored));
            for index in 0..3 {
                assert_near(mirrored.rate(index), seen.rate(index));
            }
        }
    }

    #[test]
    fn rates_are_per_unit_of_time(stream in streams()) {
        for estimator in &EstimatorChoice::all() {
            let [steps, quarters] = [1.0, 0.25].map(|step| after(estimator, &stream, step, false));
            for index in 0..3 {
                assert_near(quarters.rate(index), 4.0 * steps.rate(index));
                let [a, b] = [&steps, &quarters].map(|mapper| mapper.credible_interval(index, 0.8));
                assert_near(b.0, 4.0 * a.0);
                assert_near(b.1, 4.0 * a.1);
            }
        }
    }

    /// A cell has a rate above 0 only if it was seen in both states, and its interval then contains the rate.
    #[test]
    fn only_what_changed_has_a_rate(stream in streams()) {
        for estimator in &EstimatorChoice::all() {
            let mapper = after(estimator, &stream, 1.0, false);
            for index in 0..3 {
                let states: Vec<bool> =
                    stream.iter().map(|cells| cells[index]).filter(|cell| cell.0).map(|cell| cell.1).collect();
                let changed = states.windows(2).any(|pair| pair[0] != pair[1]);
                let is_free = mapper.states().cells()[index] == CellState::Free;
                let shares = estimator.name() == SHARED && is_free;
                prop_assert!(changed || shares || mapper.rate(index) == 0.0);
                if estimator.name() == "two-state-gaps" {
                    prop_assert_eq!(changed, mapper.rate(index) > 0.0);
                    let (low, high) = mapper.credible_interval(index, 0.99);
                    prop_assert!(!changed || low < mapper.rate(index) && mapper.rate(index) <= high * 1.001);
                }
            }
        }
    }
}

#[test]
fn nine_of_ten_intervals_of_mass_0_9_hold_the_truth() {
    const CELLS: usize = 300;
    for (leave, looks) in [
        ([0.02, 0.05], (|step| step % 40 < 10) as fn(u32) -> bool),
        ([0.004, 0.01], |step| step % 10 == 0),
        ([0.1, 0.1], |_| true),
    ] {
        let mapper = chains(CELLS, 4, 2000, leave, looks);
        let holds = |cell: &usize| {
            let (low, high) = mapper.credible_interval(cell * 4, 0.9);
            (low..=high).contains(&cycle_rate(leave))
        };
        let covered = (0..CELLS).filter(holds).count() as f64 / CELLS as f64;
        assert!((0.84..=0.96).contains(&covered), "{covered} with {leave:?}");
    }
}

/// Neighboring cells that change independently: with neighbors the estimates scatter less, but no interval becomes
/// narrower.
#[test]
fn neighbours_move_an_estimate_and_make_it_no_surer() {
    const CELLS: usize = 100;
    let leave = [0.02, 0.05];
    let of = |apart| chains(CELLS, apart, 2000, leave, |step| step % 40 < 10);
    let [alone, near] = [(of(4), 4), (of(1), 1)].map(|(mapper, apart)| {
        let error = |cell| (mapper.rate(cell * apart) / cycle_rate(leave)).ln().abs();
        let width = |cell| {
            let (low, high) = mapper.credible_interval(cell * apart, 0.9);
            (high / low).ln()
        };
        let mean = |of: &dyn Fn(usize) -> f64| (0..CELLS).map(of).sum::<f64>() / CELLS as f64;
        [mean(&error), mean(&width)]
    });
    assert!(near[0] < 0.85 * alone[0], "errors {} beside neighbours, {} alone", near[0], alone[0]);
    assert!((near[1] / alone[1] - 1.0).abs() < 0.15, "widths {} and {}", near[1], alone[1]);
}

/// A block that comes toward the robot hides the cell that it enters next: the cell is never seen becoming blocked,
/// only found blocked. Free for 20 steps, blocked for 5, hidden in the last 5 of the 20.
#[test]
fn a_cell_that_is_hidden_before_it_gets_blocked_still_has_its_rate() {
    let rate = |estimator: EstimatorChoice| {
        let mut mapper = mapper(estimator, 1);
        for step in 0..2500 {
            let phase = step % 25;
            show(&mut mapper, f64::from(step), (!(15..20).contains(&phase)).then_some((0, phase >= 20)));
        }
        mapper.rate(0) * 25.0
    };
    let (in_view, with_gaps) = (rate(TwoState.into()), rate(TwoStateGaps.into()));
    assert!((with_gaps - 1.0).abs() < 0.1, "{with_gaps} of the true rate");
    assert!(in_view < 0.1, "{in_view}: it counts only what it sees happen");
}

/// Stays of equal length, seen for 30 of about 130 steps at any phase: after 20 steps out of view the stay has
/// certainly ended, while a Markov chain would have more than a third left.
#[test]
fn stays_by_the_clock_are_no_chain() {
    const CELLS: usize = 20;
    let (stay, cycle) = (12, 60);
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let mut mapper = mapper(TwoStateGaps, CELLS * 4);
    let (mut visit, mut step) = (0, 0);
    for _ in 0..10_000 {
        if step == visit + 30 {
            visit += random.random_range(35..=50);
        }
        let seen = (0..CELLS).filter(|_| step >= visit);
        let blocked = |cell: usize| (step + 7 * cell) % cycle < stay;
        show(&mut mapper, step as f64, seen.map(|cell| (cell * 4, blocked(cell))));
        step += 1;
    }
    let mean = (0..CELLS).map(|cell| mapper.rate(cell * 4)).sum::<f64>() / CELLS as f64 * cycle as f64;
    assert!((mean - 1.0).abs() < 0.04, "{mean} of the true rate");
    let (block, free) = mapper.transition_rates(0).unwrap();
    assert!((free * f64::from(stay as u32) - 1.0).abs() < 0.1, "stays are {} steps", 1.0 / free);
    assert!(block < free);
}

/// Independent cells with gamma distributed rates, seen for different times: the prior is that distribution, and no cell that
/// is free has rate 0.
#[test]
fn traversable_cells_share_a_prior_and_none_has_rate_0() {
    const CELLS: usize = 4000;
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let (shape, mean) = (0.5, 0.002);
    let gamma = Gamma::new(shape, mean / shape).unwrap();
    let rates: Vec<f64> = (0..CELLS).map(|_| gamma.sample(&mut random)).collect();
    let mut mapper = mapper(SharedPrior, CELLS + 1);
    for step in 0..3000 {
        let seen = (0..CELLS).filter(|cell| step < 500 * (1 + cell % 6));
        let states: Vec<(usize, bool)> =
            seen.map(|cell| (cell, random.random_bool(rates[cell].min(1.0)))).collect();
        // Blocked for one step at each event; the last cell is a wall.
        show(&mut mapper, step as f64, states.into_iter().chain([(CELLS, true)]));
    }
    let prior = mapper.statistics(0).prior.unwrap();
    assert!((prior.events / shape - 1.0).abs() < 0.1, "shape {}", prior.events);
    assert!((prior.mean() / mean - 1.0).abs() < 0.1, "mean {}", prior.mean());
    assert!((0..CELLS).all(|cell| mapper.rate(cell) > 0.0) && mapper.rate(CELLS) == 0.0);
    let inside = (0..CELLS).filter(|&cell| {
        let (low, high) = mapper.credible_interval(cell, 0.9);
        (low..=high).contains(&rates[cell])
    });
    let share = inside.count() as f64 / CELLS as f64;
    // Intervals are wider than those of single passages, since passages come in pairs.
    assert!((0.92..0.99).contains(&share), "{share} of the rates are in the 90 % interval");
}

/// People walk in the middle of a room. A cell without an event has a higher rate there than beside a wall, and another one
/// in the middle a higher one where something moved around it.
#[test]
fn the_prior_of_a_cell_depends_on_its_place() {
    let frame = GridFrame::new(Point2::origin(), 0.05, 60, 30).unwrap();
    let mut mapper =
        Mapper::new(&MapperSettings { estimator: SharedPrior.into(), ..Default::default() }, frame).unwrap();
    let moves = |x: i32, y: i32, step: i32| {
        (10..20).contains(&y) && (12..36).contains(&x) && (x, y) != (20, 15) && step % 50 == x
    };
    for step in 0..400 {
        let cells = (0..30).flat_map(|y| (0..60).map(move |x| (Cell::new(x, y), moves(x, y, step))));
        mapper.update(&crate::cells(f64::from(step), cells)).unwrap();
    }
    let rate = |x, y| mapper.rate(frame.index(Cell::new(x, y)).unwrap());
    let [busy, quiet, beside_wall] = [rate(20, 15), rate(45, 15), rate(45, 0)];
    assert!(busy > 1.2 * quiet && quiet > 10.0 * beside_wall, "{busy}, {quiet}, {beside_wall}");
}
