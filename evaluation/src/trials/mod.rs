//! Trials in grid worlds: every strategy with every estimator in every world, repeated with other seeds.
//!
//! Trials with the same world and seed are paired: the random streams of the world do not depend on the robot. A
//! trial depends only on its own settings, so that the results are the same with any number of threads.

mod run;
mod strategy;

pub use run::{TrialSettings, TrialStep, run_trial};
pub use strategy::TrialStrategy;

use crate::report::{Report, ReportSettings, Trial};
use agent::AgentSettings;
use interfaces::SettingsError;
use mapper::{EstimatorChoice, MapperSettings};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use sim::grid::GridSpec;
use std::sync::atomic::{AtomicBool, Ordering};

/// The trials of a comparison.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The worlds.
    pub worlds: Vec<GridSpec>,
    /// The estimators of rates.
    pub estimators: Vec<EstimatorChoice>,
    /// The strategies.
    pub strategies: Vec<TrialStrategy>,
    /// The number of trials of each combination.
    pub trials: u64,
    /// The seed of the first trial; each further trial has the next seed.
    pub seed: u64,
    /// The length of each trial, in steps; at least one.
    pub steps: u64,
    /// The settings of the mapper; the estimator in these settings is not used.
    pub mapper: MapperSettings,
    /// The settings of the agent.
    pub agent: AgentSettings,
    /// The settings of the controller.
    pub controller: controller::Settings,
}

impl Experiment {
    /// All trials. Trials that are compared with each other are consecutive, so that after an interruption the
    /// finished trials can be compared.
    pub fn jobs(&self) -> Vec<TrialSettings<'_>> {
        let mut jobs = Vec::new();
        for trial in 0..self.trials {
            let seed = self.seed.wrapping_add(trial);
            for world in &self.worlds {
                for estimator in &self.estimators {
                    let job = |strategy| TrialSettings { world, estimator, strategy, seed, experiment: self };
                    jobs.extend(self.strategies.iter().map(job));
                }
            }
        }
        jobs
    }

    /// Runs trials on the threads of the present rayon pool. The results are in the order of `jobs`. `observe` is
    /// called with every finished trial, from any thread. If `is_canceled` is set, unfinished trials are left out.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn run(
        &self,
        jobs: Vec<TrialSettings>,
        is_canceled: &AtomicBool,
        observe: impl Fn(&Trial) + Sync,
    ) -> Result<Vec<Trial>, SettingsError> {
        let goes_on = || !is_canceled.load(Ordering::Relaxed);
        let run = |job: TrialSettings| -> Result<Option<Trial>, SettingsError> {
            if !goes_on() {
                return Ok(None);
            }
            let trial = run_trial(&job, |_| goes_on())?;
            trial.iter().for_each(&observe);
            Ok(trial)
        };
        let trials: Result<Vec<Option<Trial>>, SettingsError> = jobs.into_par_iter().map(run).collect();
        Ok(trials?.into_iter().flatten().collect())
    }

    /// The report of all trials, with the default rayon pool.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn report(&self) -> Result<Report, SettingsError> {
        let trials = self.run(self.jobs(), &AtomicBool::new(false), |_| ())?;
        Ok(Report::new(self.report_settings(), trials))
    }

    /// The settings of the report, without version and arguments.
    pub fn report_settings(&self) -> ReportSettings {
        ReportSettings {
            steps: self.steps,
            trials: self.trials,
            sensor_radius: self.worlds.first().map_or(0, |world| world.sensor_radius),
            worlds: self.worlds.iter().map(|world| world.name.clone()).collect(),
            estimators: self.estimators.iter().map(|estimator| estimator.name().to_owned()).collect(),
            strategies: self.strategies.iter().map(|strategy| strategy.name().to_owned()).collect(),
            ..ReportSettings::default()
        }
    }
}
