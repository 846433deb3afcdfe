//! Cells that are two-state Markov chains, so that the true rates are known.

use crate::information::Information;
use crate::patterns::{Looker, Pattern};
use crate::score::{MASS, Mean, log_error};
use interfaces::{Cell, CellReading, GridFrame};
use nalgebra::Point2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// The probabilities of leaving a state from one step to the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chain {
    pub(crate) block: f64,
    pub(crate) free: f64,
}

impl Chain {
    /// A chain with this number of cycles per step that is blocked for this share of the time.
    fn new(cycle_rate: f64, share_blocked: f64) -> Self {
        Self { block: cycle_rate / (1.0 - share_blocked), free: cycle_rate / share_blocked }
    }

    fn share_blocked(self) -> f64 {
        self.block / (self.block + self.free)
    }

    fn cycle_rate(self) -> f64 {
        self.block * self.free / (self.block + self.free)
    }
}

/// Cycle rates over three decades, per step, and shares of the time that cells are blocked.
const RATES: [f64; 10] = [0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4];
pub(crate) const SHARES: [f64; 2] = [0.5, 0.1];
/// Chains that leave a state with a higher probability than this alternate, and are left out.
const FASTEST: f64 = 0.9;
const CELLS: usize = 100;
/// Cells are this far apart, so that no cell gives information about another.
const APART: usize = 4;

/// The scores of one estimator for one kind of chain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Score {
    /// The mean of estimate / truth − 1.
    pub(crate) bias: f64,
    pub(crate) rms: f64,
    pub(crate) log_error: f64,
    /// The share of the cells whose credible interval contains the true rate.
    pub(crate) covered: f64,
}

/// The results for one kind of chain under one pattern of observations.
pub(crate) struct Outcome {
    pub(crate) pattern: Pattern,
    pub(crate) share_blocked: f64,
    pub(crate) rate: f64,
    /// The minimum relative standard deviation of an estimator without bias.
    pub(crate) least: f64,
    pub(crate) scores: Vec<Score>,
}

/// The cells follow `chains` in turn, `apart` cells from each other; the cells of the first chain are evaluated.
fn run(chains: &[Chain], pattern: Pattern, apart: usize, steps: u64) -> anyhow::Result<Outcome> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let frame = GridFrame::new(Point2::origin(), 1.0, CELLS * apart, 1);
    let mut mappers = crate::mappers(frame.ok_or_else(|| anyhow::anyhow!("too many cells"))?)?;
    let of = |number: usize| chains[number % chains.len()];
    let mut cells: Vec<(bool, Looker)> =
        (0..CELLS).map(|number| (rng.random_bool(of(number).share_blocked()), Looker::default())).collect();
    let mut information = Information::new(chains[0]);
    let mut reading = CellReading { time: 0.0, pose: interfaces::pose(0.0, 0.0, 0.0), cells: Vec::new() };
    for step in 0..steps {
        reading.time = step as f64;
        reading.cells.clear();
        for (number, (blocked, looker)) in cells.iter_mut().enumerate() {
            if looker.looks(pattern, step, 7 * number as u64) {
                let before = looker.see(step, *blocked);
                if let Some((elapsed, was_blocked)) = before.filter(|_| number % chains.len() == 0) {
                    information.add(was_blocked, elapsed);
                }
                reading.cells.push((Cell::new((number * apart) as i32, 0), *blocked));
            }
            let leave = if *blocked { of(number).free } else { of(number).block };
            *blocked ^= rng.random_bool(leave);
        }
        for mapper in &mut mappers {
            mapper.update(&reading)?;
        }
    }
    let (truth, judged) = (chains[0].cycle_rate(), || (0..CELLS).step_by(chains.len()));
    let score = |mapper: &mapper::Mapper| {
        let [mut bias, mut square, mut log, mut covered] = [Mean::default(); 4];
        for number in judged() {
            let index = number * apart;
            let error = mapper.rate(index) / truth - 1.0;
            bias.add(error);
            square.add(error * error);
            log.add(log_error(mapper.rate(index), truth));
            let (low, high) = mapper.credible_interval(index, MASS);
            covered.add_if((low..=high).contains(&truth));
        }
        let (rms, log_error) = (square.mean().sqrt(), log.mean());
        Score { bias: bias.mean(), rms, log_error, covered: covered.mean() }
    };
    Ok(Outcome {
        pattern,
        share_blocked: chains[0].share_blocked(),
        rate: truth,
        least: information.least_deviation(judged().count() as f64),
        scores: mappers.iter().map(score).collect(),
    })
}

/// The results for every kind of chain under every pattern.
pub(crate) fn all(steps: u64) -> anyhow::Result<Vec<Outcome>> {
    let mut outcomes = Vec::new();
    for pattern in Pattern::ALL {
        eprintln!("Chains, looks {}", pattern.name());
        for share in SHARES {
            for rate in RATES.into_iter().filter(|rate| rate / share <= FASTEST) {
                outcomes.push(run(&[Chain::new(rate, share)], pattern, APART, steps)?);
            }
        }
    }
    Ok(outcomes)
}

/// The cycle rates of cells between neighbors with other rates.
const MIXED_RATES: [f64; 3] = [0.005, 0.01, 0.02];

/// Cells alone, between cells with rates 10 times higher, and between cells with rates 10 times lower, observed in
/// 10 of 40 steps.
pub(crate) fn unlike_neighbours(steps: u64) -> anyhow::Result<Vec<[Outcome; 3]>> {
    let outcome = |rate: f64, factor: f64| {
        let apart = if factor == 1.0 { APART } else { 1 };
        run(&[Chain::new(rate, 0.5), Chain::new(factor * rate, 0.5)], Pattern::Of(10, 40), apart, steps)
    };
    let row = |rate| Ok([outcome(rate, 1.0)?, outcome(rate, 10.0)?, outcome(rate, 0.1)?]);
    MIXED_RATES.into_iter().map(row).collect()
}
