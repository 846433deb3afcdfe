//! Block worlds: things that stand for a fixed time and move on, seen by a robot that moves.

use crate::robots::{Habit, Robot};
use crate::score::{Mean, log_error};
use geometry::World;
use mapper::{Estimator, Mapper};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use sim::grid::{GenerateSettings, GridSpec, GridTruth, GridWorld};

/// Cells in view for less than this share of the time are seen sparsely.
const SPARSE: f64 = 0.05;
/// Every so many steps predictions are judged, in the second half of a life.
const JUDGED_EVERY: u64 = 97;

const HEADER: &str = "| robot | estimator | log error | relative error | bias | log error, dense view | sparse view \
                      | false rate | Brier score |\n|---|---|---|---|---|---|---|---|---|";

/// What one estimator reached.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    /// Averaged per thing, then over the things of a world, then over worlds.
    log_error: Mean,
    relative_error: Mean,
    bias: Mean,
    /// The log error of cells that were in view for long, and of the others.
    dense: Mean,
    sparse: Mean,
    /// The rate of cells that no thing ever touches.
    false_rate: Mean,
    /// The square error of P(blocked now) of cells out of view.
    brier: Mean,
}

impl Score {
    /// Judges one life at its end.
    fn add_life(&mut self, mapper: &Mapper, truth: &GridTruth) {
        let [mut things, mut relative, mut bias] = [Mean::default(); 3];
        for thing in truth.things() {
            let mut cells = Mean::default();
            for &index in thing.iter().filter(|&&index| truth.block_events(index) > 0) {
                let (rate, true_rate) = (mapper.rate(index), truth.cycle_rate(index));
                let error = log_error(rate, true_rate);
                cells.add(error);
                relative.add((rate / true_rate - 1.0).abs());
                bias.add(rate / true_rate - 1.0);
                let is_sparse = mapper.statistics(index).observed() < SPARSE * truth.time();
                if is_sparse { self.sparse.add(error) } else { self.dense.add(error) }
            }
            things.add_mean(&cells);
        }
        self.log_error.add_mean(&things);
        self.relative_error.add_mean(&relative);
        self.bias.add_mean(&bias);
        for index in 0..mapper.frame().len() {
            if !truth.is_swept(index) && mapper.was_ever_seen(index) {
                self.false_rate.add(mapper.rate(index));
            }
        }
    }

    /// Judges what is believed now of the cells out of view.
    fn add_predictions(&mut self, mapper: &Mapper, truth: &GridTruth) {
        for &index in truth.swept() {
            if !mapper.is_in_view(index) {
                let now = f64::from(u8::from(truth.is_blocked(index)));
                self.brier.add((mapper.blocked_probability(index) - now).powi(2));
            }
        }
    }
}

/// Lets a robot live in a world, and every estimator learn from what it sees.
fn live(spec: &GridSpec, habit: Habit, steps: u64, seed: u64, scores: &mut [Score]) -> anyhow::Result<()> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(1);
    let (mut world, mut robot) = (GridWorld::new(spec, seed), Robot::new(spec, habit, rng));
    let mut mappers = crate::mappers(*spec.frame())?;
    for step in 0..=steps {
        let reading = world.sense();
        for (mapper, score) in mappers.iter_mut().zip(scores.iter_mut()) {
            mapper.update(&reading)?;
            if 2 * step > steps && step % JUDGED_EVERY == 0 {
                score.add_predictions(mapper, world.truth());
            }
        }
        if step < steps {
            world.act(&robot.act(&reading));
        }
    }
    for (mapper, score) in mappers.iter().zip(scores) {
        score.add_life(mapper, world.truth());
    }
    Ok(())
}

/// Prints what every estimator reached with every robot, over random worlds.
pub(crate) fn table(worlds: u64, steps: u64) -> anyhow::Result<()> {
    println!("{worlds} random worlds, {steps} steps each:\n\n{HEADER}");
    for habit in Habit::ALL {
        let mut scores = vec![Score::default(); Estimator::ALL.len()];
        for seed in 0..worlds {
            let spec = GridSpec::generate(&GenerateSettings::default(), seed);
            live(&spec, habit, steps, seed, &mut scores)?;
        }
        for (estimator, score) in Estimator::ALL.iter().zip(&scores) {
            print!("| {} | `{}` |", habit.name(), estimator.name());
            print!(" {:.3} | {:.3} |", score.log_error.mean(), score.relative_error.mean());
            print!(" {:+.3} | {:.3} |", score.bias.mean(), score.dense.mean());
            print!(" {:.3} | {} |", score.sparse.mean(), score.false_rate.mean());
            println!(" {:.4} |", score.brier.mean());
        }
    }
    println!();
    Ok(())
}
