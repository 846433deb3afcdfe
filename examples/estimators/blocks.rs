//! Block worlds: blocks that stay on a cell for a fixed time and move on, observed by a robot that moves.

use crate::robots::{Habit, Robot};
use crate::score::{MASS, Mean, log_error};
use interfaces::GroundTruth;
use interfaces::{CellState, World};
use mapper::{EstimatorChoice, Mapper};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use sim::grid::{GenerateSettings, GridGroundTruth, GridSpec, GridWorld};

/// The first seed. The constants of the estimators were chosen on worlds with lower seeds.
const FIRST_SEED: u64 = 1000;
/// The number of seeds per shipped world.
const SHIPPED_SEEDS: u64 = 5;
const SHIPPED: [(&str, &str); 5] = [
    ("two_blocks.toml", include_str!("../../worlds/two_blocks.toml")),
    ("corridor_with_doors.toml", include_str!("../../worlds/corridor_with_doors.toml")),
    ("many_slow_blocks.toml", include_str!("../../worlds/many_slow_blocks.toml")),
    ("one_fast_block.toml", include_str!("../../worlds/one_fast_block.toml")),
    ("open_hall.toml", include_str!("../../worlds/open_hall.toml")),
];
/// The probabilities per step that a due move of a block happens, and that an action of the robot happens.
const CHANCES: (f64, f64) = (0.7, 0.9);

/// Cells that are in view for less than this share of the time count as sparsely observed.
const SPARSE: f64 = 0.05;
/// Predictions are evaluated once in this number of steps, in the second half of a run.
const JUDGED_EVERY: u64 = 97;

/// Worlds of one kind.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Set {
    Generated,
    Stochastic,
    Shipped,
}

impl Set {
    pub(crate) const ALL: [Self; 3] = [Self::Generated, Self::Stochastic, Self::Shipped];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Generated => "Generated block worlds",
            Self::Stochastic => "Generated block worlds, stochastic",
            Self::Shipped => "The shipped grid worlds",
        }
    }

    /// Every world, with the seed of its random streams.
    fn worlds(self, count: u64) -> anyhow::Result<Vec<(GridSpec, u64)>> {
        let generated = |seed| GridSpec::generate(&GenerateSettings::default(), seed);
        let seeds = FIRST_SEED..FIRST_SEED + count;
        match self {
            Self::Generated => Ok(seeds.map(|seed| (generated(seed), seed)).collect()),
            Self::Stochastic => {
                let (block, robot) = CHANCES;
                Ok(seeds.map(|seed| (generated(seed).with_probabilities(block, robot), seed)).collect())
            }
            Self::Shipped => {
                let mut worlds = Vec::new();
                for (name, text) in SHIPPED {
                    let spec = worldfile::grid::parse(name, text)?;
                    worlds.extend((0..SHIPPED_SEEDS).map(|seed| (spec.clone(), seed)));
                }
                Ok(worlds)
            }
        }
    }
}

/// The scores of one estimator.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Score {
    /// The log error for each habit of the robot, averaged per block, then over the blocks of a world, then over
    /// worlds.
    pub(crate) log_error: [Mean; Habit::ALL.len()],
    pub(crate) bias: Mean,
    /// The log error of cells that were in view for long, and of the other cells.
    pub(crate) dense: Mean,
    pub(crate) sparse: Mean,
    /// The estimated rate of cells that no block ever touches.
    pub(crate) false_rate: Mean,
    /// The share of the changing cells whose credible interval contains the true rate.
    pub(crate) covered: Mean,
    /// The squared error of P(blocked now) for cells out of view.
    pub(crate) brier: Mean,
}

impl Score {
    /// Evaluates one run at its end.
    fn add_life(&mut self, habit: usize, mapper: &Mapper, truth: &GridGroundTruth) {
        let [mut things, mut bias] = [Mean::default(); 2];
        for thing in truth.moving_things().iter() {
            let mut cells = Mean::default();
            for &index in thing.iter().filter(|&&index| truth.block_events(index) > 0) {
                let (rate, true_rate) = (mapper.rate(index), truth.cycle_rate(index));
                let error = log_error(rate, true_rate);
                cells.add(error);
                bias.add(rate / true_rate - 1.0);
                let is_sparse = mapper.statistics(index).observed() < SPARSE * truth.elapsed();
                if is_sparse {
                    self.sparse.add(error)
                } else {
                    self.dense.add(error)
                }
                let (low, high) = mapper.credible_interval(index, MASS);
                self.covered.add_if((low..=high).contains(&true_rate));
            }
            things.add_mean(&cells);
        }
        self.log_error[habit].add_mean(&things);
        self.bias.add_mean(&bias);
        for index in 0..mapper.frame().len() {
            if !truth.is_swept(index) && mapper.was_ever_seen(index) {
                self.false_rate.add(mapper.rate(index));
            }
        }
    }

    /// Evaluates the present predictions for the cells out of view.
    fn add_predictions(&mut self, mapper: &Mapper, truth: &GridGroundTruth) {
        for index in out_of_view(mapper, truth) {
            self.brier.add(square_error(mapper.blocked_probability(index), truth.is_blocked(index)));
        }
    }
}

/// The scores of predictions that need no rates.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Naive {
    /// Prediction: the cell has the state that was last seen.
    pub(crate) last_seen: Mean,
    /// Prediction: the probability is the share of the time in view during which the cell was blocked.
    pub(crate) always_mean: Mean,
}

impl Naive {
    fn add_predictions(&mut self, mapper: &Mapper, truth: &GridGroundTruth) {
        for index in out_of_view(mapper, truth) {
            let (is_blocked, seen) = (truth.is_blocked(index), mapper.statistics(index));
            let last = match mapper.states().cells()[index] {
                CellState::Unknown => 0.5,
                CellState::Free => 0.0,
                CellState::Blocked => 1.0,
            };
            let mean = if seen.observed() > 0.0 { seen.watched_blocked / seen.observed() } else { last };
            self.last_seen.add(square_error(last, is_blocked));
            self.always_mean.add(square_error(mean, is_blocked));
        }
    }
}

fn out_of_view<'a>(mapper: &'a Mapper, truth: &'a GridGroundTruth) -> impl Iterator<Item = usize> + 'a {
    truth.swept().into_owned().into_iter().filter(|&index| !mapper.is_in_view(index))
}

fn square_error(probability: f64, is_blocked: bool) -> f64 {
    (probability - f64::from(u8::from(is_blocked))).powi(2)
}

/// The scores of all estimators in worlds of one kind.
pub(crate) struct Judged {
    pub(crate) worlds: usize,
    pub(crate) steps: u64,
    /// The scores, in the order of [`EstimatorChoice::all`].
    pub(crate) scores: Vec<Score>,
    pub(crate) naive: Naive,
    /// The number of block events and of free events in view, over all changing cells.
    pub(crate) events: [u64; 2],
}

impl Judged {
    /// Runs a robot in a world; every estimator receives the same observations.
    fn live(&mut self, (spec, seed): &(GridSpec, u64), habit: usize) -> anyhow::Result<()> {
        let mut rng = ChaCha8Rng::seed_from_u64(*seed);
        rng.set_stream(1);
        let (mut world, mut robot) = (GridWorld::new(spec, *seed), Robot::new(spec, Habit::ALL[habit], rng));
        let mut mappers = crate::mappers(*spec.frame())?;
        for step in 0..=self.steps {
            let reading = world.sense();
            for mapper in &mut mappers {
                mapper.update(&reading)?;
            }
            if 2 * step > self.steps && step % JUDGED_EVERY == 0 {
                for (mapper, score) in mappers.iter().zip(&mut self.scores) {
                    score.add_predictions(mapper, world.truth());
                }
                self.naive.add_predictions(&mappers[0], world.truth());
            }
            if step < self.steps {
                world.act(&robot.act(&reading));
            }
        }
        for (mapper, score) in mappers.iter().zip(&mut self.scores) {
            score.add_life(habit, mapper, world.truth());
        }
        for &index in world.truth().swept().iter() {
            let seen = mappers[0].statistics(index);
            self.events[0] += u64::from(seen.block_events);
            self.events[1] += u64::from(seen.free_events);
        }
        Ok(())
    }
}

/// Evaluates all estimators with every robot, in `count` random worlds, or in the shipped worlds.
pub(crate) fn judge(set: Set, count: u64, steps: u64) -> anyhow::Result<Judged> {
    let worlds = set.worlds(count)?;
    let mut judged = Judged {
        worlds: worlds.len(),
        steps,
        scores: vec![Score::default(); EstimatorChoice::all().len()],
        naive: Naive::default(),
        events: [0; 2],
    };
    for (number, world) in worlds.iter().enumerate() {
        eprintln!("{}: {} of {}", set.name(), number + 1, worlds.len());
        for habit in 0..Habit::ALL.len() {
            judged.live(world, habit)?;
        }
    }
    Ok(judged)
}
