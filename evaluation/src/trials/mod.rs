//! Trials: every strategy with every estimator in every world, repeated with other seeds, in grid worlds or in
//! physics worlds.
//!
//! Trials with the same world and seed are paired: the random streams of the world do not depend on the robot. A
//! trial depends only on its own settings, so that the results are the same with any number of threads.

mod grid;
mod length;
mod metric;
mod physics;
mod run;
mod sampler;
mod strategy;
#[cfg(test)]
mod tests;
mod world;

pub use grid::GridRobot;
pub use length::Length;
pub use metric::{Metric, Sample, Trial};
pub use physics::PhysicsRobot;
pub use run::run_trial;
pub use strategy::TrialStrategy;
pub use world::{TrialRobot, TrialSettings, TrialWorld};

use crate::physics_trial::UnsupportedDrive;
use interfaces::SettingsError;
use mapper::{EstimatorChoice, ReadingError};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::sync::atomic::{AtomicBool, Ordering};

/// The trials of a comparison.
#[derive(Clone, Debug)]
pub struct Experiment<W: TrialWorld> {
    /// The worlds.
    pub worlds: Vec<W>,
    /// The estimators of rates.
    pub estimators: Vec<EstimatorChoice>,
    /// The strategies.
    pub strategies: Vec<TrialStrategy>,
    /// The number of trials of each combination.
    pub trials: u64,
    /// The seed of the first trial; each further trial has the next seed.
    pub seed: u64,
    /// The length of each trial: steps in a grid world, s in a physics world; at least one.
    pub length: u64,
    /// The settings of the robot.
    pub robot: W::Robot,
}

/// The error for a trial that cannot run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrialError {
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The controller cannot drive the robot of a physics world.
    #[error(transparent)]
    Drive(#[from] UnsupportedDrive),
    /// The mapper refuses a reading.
    #[error(transparent)]
    Reading(#[from] ReadingError),
}

impl<W: TrialWorld> Experiment<W> {
    /// All trials. Trials that are compared with each other are consecutive, so that after an interruption the
    /// finished trials can be compared.
    pub fn jobs(&self) -> Vec<TrialSettings<'_, W>> {
        let mut seeds: Vec<u64> = (0..self.trials).map(|trial| self.seed.wrapping_add(trial)).collect();
        seeds.sort_unstable();
        let strategies = |world, estimator| self.strategies.iter().map(move |it| (world, estimator, it));
        let estimators = |world| self.estimators.iter().flat_map(move |it| strategies(world, it));
        let mut jobs = Vec::new();
        for (trial, seed) in (1..).zip(seeds) {
            let groups = (0..).zip(self.worlds.iter().flat_map(estimators));
            jobs.extend(groups.map(|(group, (world, estimator, strategy))| {
                let number = group * self.trials + trial;
                TrialSettings { number, world, estimator, strategy, seed, experiment: self }
            }));
        }
        jobs
    }

    /// Runs trials on the threads of the present rayon pool. The results are in the order of `jobs`. `observe` is
    /// called with every finished trial, from any thread. If `is_canceled` is set, unfinished trials are left out.
    ///
    /// # Errors
    ///
    /// When a trial cannot run.
    pub fn run(
        &self,
        jobs: Vec<TrialSettings<W>>,
        is_canceled: &AtomicBool,
        observe: impl Fn(&Trial) + Sync,
    ) -> Result<Vec<Trial>, TrialError> {
        let goes_on = || !is_canceled.load(Ordering::Relaxed);
        let run = |job: TrialSettings<W>| -> Result<Option<Trial>, TrialError> {
            if !goes_on() {
                return Ok(None);
            }
            let trial = run_trial(&job, goes_on)?;
            Ok(trial.inspect(&observe))
        };
        let trials: Result<Vec<Option<Trial>>, TrialError> = jobs.into_par_iter().map(run).collect();
        Ok(trials?.into_iter().flatten().collect())
    }
}
