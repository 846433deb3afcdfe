//! Many lives in grid worlds: every strategy under every estimator in every world, over and over
//! with other seeds.
//!
//! Trials of the same world and seed are paired: the world's chance is the same whatever the robot
//! does. Each trial depends on nothing but its own seed, so any number of threads gives the same
//! results.

mod run;
mod strategy;

pub use run::{TrialSettings, TrialStep, run_trial};
pub use strategy::TrialStrategy;

use crate::report::Trial;
use agent::AgentSettings;
use mapper::{Estimator, MapperSettings};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use sim::grid::GridSpec;
use std::sync::atomic::{AtomicBool, Ordering};

/// What is compared, and how.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The worlds.
    pub worlds: Vec<GridSpec>,
    /// The ways to estimate rates.
    pub estimators: Vec<Estimator>,
    /// The ways to choose goals.
    pub strategies: Vec<TrialStrategy>,
    /// Trials of each combination.
    pub trials: u64,
    /// The seed of the first trial; the others count up from it.
    pub seed: u64,
    /// Steps of each trial, at least one.
    pub steps: u64,
    /// How evidence becomes a map; the estimator here is not used.
    pub mapper: MapperSettings,
    /// The agent's settings.
    pub agent: AgentSettings,
    /// The controller's settings.
    pub controller: controller::Settings,
}

/// One trial: which world, estimator and strategy (by their places in the experiment), and its seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Job {
    /// The place of the world.
    pub world: usize,
    /// The place of the estimator.
    pub estimator: usize,
    /// The place of the strategy.
    pub strategy: usize,
    /// The seed of the trial.
    pub seed: u64,
}

impl Experiment {
    /// All trials. Those that are compared with each other come next to each other, so that what is
    /// finished when a person interrupts can be compared.
    pub fn jobs(&self) -> Vec<Job> {
        let mut jobs = Vec::new();
        for trial in 0..self.trials {
            for world in 0..self.worlds.len() {
                for estimator in 0..self.estimators.len() {
                    for strategy in 0..self.strategies.len() {
                        let seed = self.seed.wrapping_add(trial);
                        jobs.push(Job { world, estimator, strategy, seed });
                    }
                }
            }
        }
        jobs
    }

    /// Runs trials on the threads of the present rayon pool, and gives them in the order of `jobs`.
    /// `watch` is told of every finished one, from any thread; trials that have not ended when
    /// `is_cancelled` is set are left out.
    ///
    /// # Errors
    ///
    /// When settings make no sense.
    pub fn run(
        &self,
        jobs: Vec<Job>,
        is_cancelled: &AtomicBool,
        watch: impl Fn(&Trial) + Sync,
    ) -> Result<Vec<Trial>, SettingsError> {
        let trial = |job| -> Result<Option<Trial>, SettingsError> {
            if is_cancelled.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let trial = self.trial(job, is_cancelled)?;
            trial.iter().for_each(&watch);
            Ok(trial)
        };
        let trials: Result<Vec<Option<Trial>>, SettingsError> = jobs.into_par_iter().map(trial).collect();
        Ok(trials?.into_iter().flatten().collect())
    }

    /// One trial; `None` if it was cancelled.
    fn trial(&self, job: Job, is_cancelled: &AtomicBool) -> Result<Option<Trial>, SettingsError> {
        let life = self.life(job);
        run_trial(&life, |_| !is_cancelled.load(Ordering::Relaxed))
    }

    /// What one trial is made of.
    pub fn life(&self, job: Job) -> TrialSettings<'_> {
        let mapper = MapperSettings { estimator: self.estimators[job.estimator], ..self.mapper.clone() };
        TrialSettings {
            world: &self.worlds[job.world],
            strategy: self.strategies[job.strategy].clone(),
            seed: job.seed,
            steps: self.steps,
            mapper,
            agent: &self.agent,
            controller: self.controller,
        }
    }
}

/// A setting that contradicts itself or another.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// One of the mapper's.
    #[error(transparent)]
    Mapper(#[from] mapper::SettingsError),
    /// One of the agent's or the controller's.
    #[error(transparent)]
    Other(#[from] interfaces::SettingsError),
}
