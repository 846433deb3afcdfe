//! A run of the study: a learner, with what it has learned elsewhere, in a world.

use crate::cells::{CellPilot, CellSettings, Table};
use crate::goals::{GoalLearner, GoalPilot, GoalSettings, Learned};
use crate::life::{Outcome, live, run};
use crate::motives::{INTRINSIC, MOTIVES, RANDOM, Scale, motive};
use agent::{Agent, AgentSettings, Policy};
use anyhow::Context;
use controller::{CellDrive, Controller};
use evaluation::metrics::mean_log_error;
use interfaces::{Purpose, RandomStream};
use mapper::EstimatorChoice;
use robot::Autonomous;
use sim::grid::{GenerateSettings, GridSpec};

/// The strategies of the agent that are compared, and the random walk over cells.
pub(crate) const STRATEGIES: [&str; 4] = ["curious", "information-gain", "recency", "random"];
pub(crate) const WALK: &str = "walk";
/// The first words of the names of learners over single steps, and of those over goals.
const CELLS: &str = "cells-";
const GOALS: &str = "goals-";

/// A learner is trained in lives of this number of steps, each in another world.
const TRAINING_LIFE: u64 = 5000;
/// The seed of the first training world of training run 0; each training run has this number of seeds of its own.
const TRAINING_SEED: u64 = 200_000;
const TRAINING_SEEDS: u64 = 100_000;

/// The names of all learners and strategies. Learners over cells have no references.
pub(crate) fn learners() -> Vec<String> {
    let strategies = STRATEGIES.iter().map(ToString::to_string).chain([WALK.to_owned()]);
    let cells = MOTIVES[..INTRINSIC].iter().map(|motive| format!("{CELLS}{motive}"));
    strategies.chain(cells).chain(MOTIVES.iter().map(|motive| format!("{GOALS}{motive}"))).collect()
}

/// Whether a learner can learn in other worlds before it is measured: a learner over goals that does not choose at random.
pub(crate) fn can_be_trained(learner: &str) -> bool {
    learner.starts_with(GOALS) && !learner.ends_with(RANDOM)
}

/// What is computed, and what a row of the table begins with.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Run {
    pub(crate) learner: String,
    /// The steps of training in other worlds.
    pub(crate) experience: u64,
    pub(crate) estimator: String,
    /// The length of the life, steps.
    pub(crate) steps: u64,
    pub(crate) seed: u64,
}

/// The settings of the learners.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tuned {
    pub(crate) cells: CellSettings,
    pub(crate) goals: GoalSettings,
}

impl Run {
    /// The motive of a learner over goals.
    pub(crate) fn goal_motive(&self) -> Option<&str> {
        self.learner.strip_prefix(GOALS)
    }

    /// Runs the life. `learned` is what a learner over goals has learned elsewhere.
    pub(crate) fn outcome(&self, tuned: Tuned, learned: Option<&Learned>) -> anyhow::Result<Outcome> {
        let spec = GridSpec::generate(&GenerateSettings::default(), self.seed);
        let estimator = estimator(&self.estimator)?;
        let (seed, steps, reach) = (self.seed, self.steps, spec.sensor_radius as i32);
        if let Some(name) = self.goal_motive() {
            let nothing = Learned::new(tuned.goals);
            let pilot = goal_pilot(name, &spec, seed, tuned.goals, learned.unwrap_or(&nothing))?;
            let is_paid_by_truth = name == "error";
            return live(&spec, seed, steps, &estimator, pilot, |pilot, mapper, truth| {
                pilot.true_error = is_paid_by_truth.then(|| mean_log_error(mapper, truth)).flatten();
            });
        }
        let name = self.learner.strip_prefix(CELLS);
        if name.is_some() || self.learner == WALK {
            let mut rng = RandomStream::new(seed, Purpose::GridAgent);
            let motive = motive(name.unwrap_or_default(), *spec.frame(), &mut rng);
            let settings = match name {
                Some(_) => tuned.cells,
                None => CellSettings { epsilon: 1.0, replays: 0, ..tuned.cells },
            };
            let table = Table::new(spec.frame().len(), settings, rng);
            let pilot = CellPilot { table, motive, scale: Scale::default(), reach };
            return live(&spec, seed, steps, &estimator, pilot, |_, _, _| ());
        }
        let policy: Policy = self.learner.parse()?;
        let settings = AgentSettings { sensor_radius_m: f64::from(reach), ..AgentSettings::default() };
        let agent = Agent::new(&settings, &policy, RandomStream::new(seed, Purpose::GridAgent))?;
        let pilot = Autonomous::new(agent, controller(seed)?);
        live(&spec, seed, steps, &estimator, pilot, |_, _, _| ())
    }
}

fn estimator(name: &str) -> anyhow::Result<EstimatorChoice> {
    name.parse().with_context(|| format!("the estimator {name}"))
}

fn controller(seed: u64) -> anyhow::Result<Controller<CellDrive>> {
    let rng = RandomStream::new(seed, Purpose::GridController);
    Ok(Controller::new(CellDrive::settings(), CellDrive, rng)?)
}

fn goal_pilot(
    name: &str,
    spec: &GridSpec,
    seed: u64,
    settings: GoalSettings,
    learned: &Learned,
) -> anyhow::Result<GoalPilot> {
    let mut rng = RandomStream::new(seed, Purpose::GridAgent);
    let motive = motive(name, *spec.frame(), &mut rng);
    let epsilon = if name == RANDOM { 1.0 } else { settings.epsilon };
    let settings = GoalSettings { epsilon, ..settings };
    let learner = GoalLearner::new(settings, learned.tiles.clone(), rng);
    let pilot = Autonomous::new(learner, controller(seed)?);
    let reach = spec.sensor_radius as i32;
    Ok(GoalPilot { pilot, motive, scale: learned.scale, reach, true_error: None })
}

/// Trains a learner over goals. Returns what it has learned after each of these numbers of steps, in ascending order.
pub(crate) fn train(
    name: &str,
    training_run: u64,
    experiences: &[u64],
    estimator_name: &str,
    settings: GoalSettings,
) -> anyhow::Result<Vec<(u64, Learned)>> {
    let estimator = estimator(estimator_name)?;
    let mut learned = Learned::new(settings);
    let (mut done, mut kept) = (0, Vec::new());
    let first = TRAINING_SEED + training_run * TRAINING_SEEDS;
    for seed in first..first + TRAINING_SEEDS {
        while experiences.get(kept.len()).is_some_and(|experience| *experience <= done) {
            kept.push((experiences[kept.len()], learned.clone()));
        }
        let Some(&next) = experiences.get(kept.len()) else { break };
        let steps = TRAINING_LIFE.min(next - done);
        let spec = GridSpec::generate(&GenerateSettings::default(), seed);
        let pilot = goal_pilot(name, &spec, seed, settings, &learned)?;
        let mut pilot = run(&spec, seed, steps, &estimator, pilot, |_, pilot, mapper, truth| {
            if name == "error" {
                pilot.true_error = mean_log_error(mapper, truth);
            }
        })?;
        learned = pilot.learned();
        done += steps;
    }
    Ok(kept)
}
