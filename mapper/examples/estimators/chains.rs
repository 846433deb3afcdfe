//! Cells that are two-state Markov chains, each seen for itself: the truth is known.

use crate::information::Information;
use crate::score::{Mean, log_error};
use geometry::{Cell, CellReading, GridFrame};
use mapper::{Estimator, Mapper, MapperSettings};
use nalgebra::Point2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// The probabilities to leave a state from one step to the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chain {
    pub(crate) block: f64,
    pub(crate) free: f64,
}

impl Chain {
    /// A chain with so many cycles per step, blocked for such a share of the time.
    pub(crate) fn new(cycle_rate: f64, share_blocked: f64) -> Self {
        Self { block: cycle_rate / (1.0 - share_blocked), free: cycle_rate / share_blocked }
    }

    pub(crate) fn cycle_rate(self) -> f64 {
        self.block * self.free / (self.block + self.free)
    }
}

/// When a cell is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Pattern {
    /// For the first so many of every so many steps.
    Of(u64, u64),
    /// Every so many steps, until nothing changed for so many steps in a row.
    Stays { every: u64, calm: u64 },
}

impl Pattern {
    pub(crate) const ALL: [Self; 6] = [
        Self::Of(1, 1),
        Self::Of(10, 40),
        Self::Of(3, 50),
        Self::Of(1, 10),
        Self::Of(1, 50),
        Self::Stays { every: 50, calm: 5 },
    ];

    pub(crate) fn name(self) -> String {
        match self {
            Self::Of(1, 1) => "always".to_owned(),
            Self::Of(view, every) => format!("{view} of {every}"),
            Self::Stays { every, calm } => format!("stays {calm}, every {every}"),
        }
    }
}

/// A simulated cell and its looker.
#[derive(Clone, Copy, Debug)]
struct Life {
    blocked: bool,
    seen: Option<(u64, bool)>,
    looks: bool,
    calm: u64,
}

/// Cells lie so far apart that none tells of another.
const APART: usize = 3;

pub(crate) struct Outcome {
    /// Relative standard deviation that the best estimator without bias could have.
    pub(crate) floor: f64,
    pub(crate) bias: Vec<f64>,
    pub(crate) rms: Vec<f64>,
    pub(crate) log_error: Vec<f64>,
}

pub(crate) fn run(
    chains: &[Chain],
    pattern: Pattern,
    cells: usize,
    steps: u64,
    seed: u64,
    apart: usize,
) -> anyhow::Result<Outcome> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let frame = GridFrame::new(Point2::origin(), 1.0, cells * apart, 1)
        .ok_or_else(|| anyhow::anyhow!("too many cells"))?;
    let mut mappers = Estimator::ALL
        .map(|estimator| Mapper::new(&MapperSettings { estimator, ..MapperSettings::default() }, frame))
        .into_iter()
        .collect::<Result<Vec<_>, _>>()?;
    let mut information = Information::new(chains[0]);
    let mut lives: Vec<Life> = (0..cells)
        .map(|x| {
            let chain = chains[x % chains.len()];
            Life {
                blocked: rng.random_bool(chain.block / (chain.block + chain.free)),
                seen: None,
                looks: false,
                calm: 0,
            }
        })
        .collect();
    let mut reading = CellReading { time: 0.0, pose: geometry::pose(0.0, 0.0, 0.0), cells: Vec::new() };
    for step in 0..steps {
        reading.time = step as f64;
        reading.cells.clear();
        for (x, life) in lives.iter_mut().enumerate() {
            let chain = chains[x % chains.len()];
            let looks = match pattern {
                Pattern::Of(view, every) => (step + 7 * x as u64) % every < view,
                Pattern::Stays { every, calm } => {
                    (step + 7 * x as u64).is_multiple_of(every) || life.looks && life.calm < calm
                }
            };
            life.looks = looks;
            if looks {
                if let Some((at, before)) = life.seen {
                    if x % chains.len() == 0 {
                        information.add(before, step - at);
                    }
                    life.calm = if before == life.blocked && at + 1 == step { life.calm + 1 } else { 0 };
                }
                life.seen = Some((step, life.blocked));
                reading.cells.push((Cell::new((x * apart) as i32, 0), life.blocked));
            }
            let leave = if life.blocked { chain.free } else { chain.block };
            life.blocked ^= rng.random_bool(leave);
        }
        for mapper in &mut mappers {
            mapper.update(&reading)?;
        }
    }
    let n = cells.div_ceil(chains.len());
    let mut outcome = Outcome {
        floor: information.relative_deviation(n as f64),
        bias: vec![],
        rms: vec![],
        log_error: vec![],
    };
    let truth = chains[0].cycle_rate();
    for mapper in &mappers {
        let [mut bias, mut square, mut log] = [Mean::default(); 3];
        for x in (0..cells).step_by(chains.len()) {
            let rate = mapper.rate(x * apart);
            bias.add(rate / truth - 1.0);
            square.add((rate / truth - 1.0).powi(2));
            log.add(log_error(rate, truth));
        }
        outcome.bias.push(bias.mean());
        outcome.rms.push(square.mean().sqrt());
        outcome.log_error.push(log.mean());
    }
    Ok(outcome)
}

pub(crate) fn table(cells: usize, steps: u64) -> anyhow::Result<()> {
    for pattern in Pattern::ALL {
        for share in [0.5, 0.1] {
            for rate in [0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4] {
                if rate / share > 0.9 {
                    continue;
                }
                let outcome = run(&[Chain::new(rate, share)], pattern, cells, steps, 1, APART)?;
                print!("{:16} {share} {rate:6} floor {:.3} |", pattern.name(), outcome.floor);
                for k in 0..Estimator::ALL.len() {
                    print!(" {:+.3} {:.3} {:.3} |", outcome.bias[k], outcome.rms[k], outcome.log_error[k]);
                }
                let (p, g) = (0, 5);
                let bad = outcome.floor <= 0.1 && outcome.bias[g].abs() > 0.05;
                let worse = outcome.log_error[g] > outcome.log_error[p] * 1.02 + 0.002;
                let worse_rms = outcome.rms[g] > outcome.rms[p] * 1.02 + 0.002;
                println!(
                    "{}{}{}",
                    if bad { " BIAS" } else { "" },
                    if worse { " WORSE" } else { "" },
                    if worse_rms { " RMS" } else { "" }
                );
            }
        }
    }
    Ok(())
}
