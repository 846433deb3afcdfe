//! The estimators on cells that are simulated two-state Markov chains, so that the true rates are known.

use interfaces::{Cell, GridFrame};
use mapper::{EstimatorChoice, Mapper, MapperSettings};
use nalgebra::Point2;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Exp};

/// A cell that becomes blocked at the rate `block_hz` (1/s) while free, and free at the rate `free_hz` (1/s) while
/// blocked.
#[derive(Clone, Copy)]
struct Chain {
    block_hz: f64,
    free_hz: f64,
}

impl Chain {
    fn cycle_rate(self) -> f64 {
        1.0 / (1.0 / self.block_hz + 1.0 / self.free_hz)
    }

    fn share_free(self) -> f64 {
        self.free_hz / (self.block_hz + self.free_hz)
    }

    /// The probability that a free cell is blocked `gap_s` later (solution of the forward equation).
    fn blocked_after(self, gap_s: f64) -> f64 {
        let sum_hz = self.block_hz + self.free_hz;
        self.block_hz / sum_hz * (1.0 - (-sum_hz * gap_s).exp())
    }
}

const SAMPLE_S: f64 = 0.1;
const CELLS: usize = 8;
const READINGS: usize = 150_000;

/// The mean rate over cells that follow `chain`. Each cell is observed whenever `looks(reading, blocked now,
/// reading in which it was last seen blocked)` is true.
fn estimates(chain: Chain, looks: impl Fn(usize, bool, usize) -> bool) -> impl Fn(&str) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let frame = GridFrame::new(Point2::origin(), 1.0, CELLS, 1).unwrap();
    let mapper =
        |estimator| Mapper::new(&MapperSettings { estimator, ..MapperSettings::default() }, frame).unwrap();
    let mut mappers: Vec<Mapper> = EstimatorChoice::all().into_iter().map(mapper).collect();
    let dwells = [Exp::new(chain.block_hz).unwrap(), Exp::new(chain.free_hz).unwrap()];
    let mut cells = [(false, 0.0, 0); CELLS]; // state, when it ends, last seen blocked
    for cell in &mut cells {
        cell.1 = dwells[0].sample(&mut random);
    }
    for reading in 0..READINGS {
        let time = reading as f64 * SAMPLE_S;
        let mut seen = Vec::new();
        for (x, (blocked, until, seen_blocked)) in cells.iter_mut().enumerate() {
            while *until <= time {
                *blocked = !*blocked;
                *until += dwells[usize::from(*blocked)].sample(&mut random);
            }
            if looks(reading, *blocked, *seen_blocked) {
                if *blocked {
                    *seen_blocked = reading;
                }
                seen.push((Cell::new(x as i32, 0), *blocked));
            }
        }
        let reading = crate::cells(time, seen);
        for mapper in &mut mappers {
            mapper.update(&reading).unwrap();
        }
    }
    move |estimator| {
        let mapper = mappers.iter().find(|mapper| mapper.estimator().name() == estimator).unwrap();
        (0..CELLS).map(|index| mapper.rate(index)).sum::<f64>() / CELLS as f64
    }
}

#[track_caller]
fn assert_within(found: f64, expected: f64, tolerance: f64) {
    assert!((found / expected - 1.0).abs() <= tolerance, "{found}, not {expected}");
}

const FAST: Chain = Chain { block_hz: 0.1, free_hz: 0.25 };

#[test]
fn in_full_view_every_estimator_finds_the_rate() {
    let rate = estimates(FAST, |_, _, _| true);
    for estimator in EstimatorChoice::all() {
        assert_within(rate(estimator.name()), FAST.cycle_rate(), 0.04);
    }
}

/// In view for 10 of 40 readings: `paper-all` counts the changes found after a gap, but not the time in which they
/// can have happened. The bias follows from the chain.
#[test]
fn in_short_visits_counting_changes_after_gaps_biases() {
    let rate = estimates(FAST, |reading, _, _| reading % 40 < 10);
    for estimator in ["paper", "two-state", "two-state-gaps"] {
        assert_within(rate(estimator), FAST.cycle_rate(), 0.05);
    }
    let (view_s, gap_s) = (9.0 * SAMPLE_S, 31.0 * SAMPLE_S);
    let after_gap = FAST.share_free() * FAST.blocked_after(gap_s) / view_s;
    assert_within(rate("paper-all"), FAST.cycle_rate() + after_gap, 0.05);
}

/// Single observations: nothing happens in view, and only the gaps contain information.
#[test]
fn single_glances_tell_the_rate_by_their_gaps() {
    let chain = Chain { block_hz: 0.02, free_hz: 0.05 };
    let rate = estimates(chain, |reading, _, _| reading % 50 == 0);
    assert_within(rate("two-state-gaps"), chain.cycle_rate(), 0.05);
    assert_eq!(rate("paper"), 0.0);
    assert_eq!(rate("two-state"), 0.0);
}

/// A robot that observes a cell while it is blocked and for 5 s after, like a robot that follows a moving thing:
/// the paper's rate is the rate during these times; the rate conditioned on the state is correct.
#[test]
fn looking_where_things_happen_biases_the_paper_and_not_two_state() {
    let chain = Chain { block_hz: 0.005, free_hz: 0.1 };
    let looks = |reading: usize, _: bool, seen_blocked: usize| {
        reading % 250 < 50 || reading < seen_blocked + 50 && seen_blocked > 0
    };
    let rate = estimates(chain, looks);
    assert_within(rate("two-state"), chain.cycle_rate(), 0.15);
    assert_within(rate("two-state-gaps"), chain.cycle_rate(), 0.1);
    let paper = rate("paper");
    assert!(paper > 2.0 * chain.cycle_rate(), "{paper} against {}", chain.cycle_rate());
}

#[test]
fn a_cell_that_never_changes_has_no_rate() {
    let still = Chain { block_hz: 1e-12, free_hz: 1.0 };
    let rate = estimates(still, |reading, _, _| reading % 7 < 3);
    let all = EstimatorChoice::all();
    let mut alone = all.iter().map(EstimatorChoice::name).filter(|name| *name != "shared-prior");
    assert!(alone.all(|name| rate(name) == 0.0));
    // Under a shared prior it has less than one event of all cells in the time in view.
    let all_in_view_s = CELLS as f64 * READINGS as f64 * SAMPLE_S * 2.0 / 7.0;
    assert!((0.01..1.0).contains(&(rate("shared-prior") * all_in_view_s)), "{}", rate("shared-prior"));
}
