//! The report of an experiment: from trials to curves with confidence bands, paired comparisons, files and a table; and
//! experiments in shards. It must not know the command line,
//! recordings or screens.
//!
//! ```text
//! trials ──▶ runs: curves, areas, comparisons ──▶ report.json, figures, table
//!   └──────▶ trials.csv
//! ```

mod builder;
mod comparison;
mod figure;
pub mod shards;
mod statistics;
mod strategy;
mod table;
#[cfg(feature = "programs")]
pub mod trials;

pub use builder::{Run, UnequalTimes, collect};
pub use comparison::Comparison;
pub use statistics::{Estimate, PairedTest, paired_test};
pub use strategy::{Measure, StrategyResult};

use draw::canvas::PictureError;
use draw::scene::Scene;
use evaluation::scenes::Displayed;
use evaluation::trials::{Experiment, Length, Trial, TrialError, TrialWorld};
use files::{RunFolder, write_file};
use robot::BUILD;
use serde::Serialize;
use std::sync::atomic::AtomicBool;

/// Up to this number of worlds, the table and the figures show single worlds.
const ONE_BY_ONE: usize = 8;
/// The name of the file with all results.
pub const REPORT: &str = "report.json";
/// Whether a strategy knows the ground truth: it is listed with the others, but cannot be the best one.
fn is_reference(strategy: &str) -> bool {
    strategy == "full-observation"
}

/// The settings of an experiment.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ReportSettings {
    /// The version of the program.
    pub version: String,
    /// The arguments that describe the experiment: those on output, threads and shards are left out.
    pub arguments: Vec<String>,
    /// The length of a trial.
    #[serde(flatten)]
    pub length: Length,
    /// The number of trials of every strategy with every estimator in every world.
    pub trials: u64,
    /// The range of the sensor of a grid world, in cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_radius: Option<u32>,
    /// Whether the experiment was interrupted before all trials were finished.
    pub interrupted: bool,
    /// The names of the worlds, in the order of the report; other worlds come last, sorted by name. Estimators and
    /// strategies are ordered in the same way.
    #[serde(skip)]
    pub worlds: Vec<String>,
    /// The names of the estimators in their order.
    #[serde(skip)]
    pub estimators: Vec<String>,
    /// The names of the strategies in their order.
    #[serde(skip)]
    pub strategies: Vec<String>,
}

impl ReportSettings {
    /// The settings of the report of an experiment, without version and arguments.
    pub fn of<W: TrialWorld>(experiment: &Experiment<W>) -> Self {
        Self {
            length: W::length(experiment.length),
            trials: experiment.trials,
            sensor_radius: experiment.worlds.first().and_then(W::sensor_radius),
            worlds: experiment.worlds.iter().map(|world| world.name().to_owned()).collect(),
            estimators: experiment.estimators.iter().map(|estimator| estimator.name().to_owned()).collect(),
            strategies: experiment.strategies.iter().map(|strategy| strategy.name().to_owned()).collect(),
            ..Self::default()
        }
    }

    /// The number of trials of the whole experiment.
    pub(crate) fn all_trials(&self) -> u64 {
        [&self.worlds, &self.estimators, &self.strategies]
            .iter()
            .fold(self.trials, |all, names| all * names.len() as u64)
    }

    /// Sorts trials into the order of the report: by world, estimator, strategy and seed.
    pub fn sort(&self, trials: &mut [Trial]) {
        trials.sort_by_cached_key(|trial| {
            (
                position(&self.worlds, &trial.world),
                position(&self.estimators, &trial.estimator),
                position(&self.strategies, &trial.strategy),
                trial.seed,
            )
        });
    }
}

/// The results of an experiment. Serialized, they are the content of `report.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// The settings of the experiment.
    #[serde(flatten)]
    pub settings: ReportSettings,
    /// The number of finished trials.
    #[serde(skip)]
    pub finished: u64,
    /// One run per world and estimator, then the runs over all worlds.
    pub runs: Vec<Run>,
}

/// The version of the layout of `report.json`; count up when a key is renamed, removed or changes its meaning.
const SCHEMA: u32 = 1;

/// The content of `report.json`.
#[derive(Serialize)]
struct Content<'a> {
    /// The version of the layout.
    schema: u32,
    /// The build of the program.
    build: &'static str,
    #[serde(flatten)]
    report: &'a Report,
    /// The names of the other files.
    files: &'a [String],
}

impl Report {
    /// Runs all trials of an experiment with the default rayon pool, and returns their report.
    ///
    /// # Errors
    ///
    /// When a trial cannot run.
    pub fn of<W: TrialWorld>(experiment: &Experiment<W>) -> Result<Self, TrialError> {
        let trials = experiment.run(experiment.jobs(), &AtomicBool::new(false), |_| ())?;
        Ok(Self::new(ReportSettings::of(experiment), trials))
    }

    /// The statistics of `trials`, which can be in any order.
    ///
    /// There is one run per world and estimator. With several worlds, there is also one run over all worlds per
    /// estimator, at the end. In that run a world is the unit: its value is the mean of its trials, bands span
    /// the worlds, and worlds are paired.
    ///
    /// # Panics
    ///
    /// When the trials were not sampled at the same times.
    pub fn new(settings: ReportSettings, mut trials: Vec<Trial>) -> Self {
        settings.sort(&mut trials);
        builder::build(settings, &trials).expect("trials are sampled at the same times")
    }

    /// The run with `estimator` in `world`, or over `all worlds (N)`.
    pub fn run(&self, world: &str, estimator: &str) -> Option<&Run> {
        self.runs.iter().find(|run| run.world == world && run.estimator == estimator)
    }

    /// Writes the figures, and `report.json`, which lists all files of the run, into the folder of the unfinished run.
    /// Returns the names of the files.
    ///
    /// `figure3` (in physics worlds: `curves`) shows the run over all worlds, or the only one, with the first estimator; the other figures
    /// are `figure3-<world>-<estimator>`, without the estimator if there is only one. With more than eight worlds, only all worlds
    /// together are drawn.
    /// The plan of a single world is drawn beside its curves, if it is among `worlds`.
    ///
    /// # Errors
    ///
    /// When something cannot be drawn or written.
    pub fn write(&self, folder: &RunFolder, worlds: &[impl Displayed]) -> Result<Vec<String>, PictureError> {
        let scenes: Vec<Scene> = worlds.iter().map(Displayed::scene).collect();
        let to = folder.unfinished();
        figure::write_all(to, self, &scenes)?;
        let mut names = folder.results()?;
        let content = Content { schema: SCHEMA, build: BUILD, report: self, files: &names };
        write_file(&to.join(REPORT), |file| {
            serde_json::to_writer(&mut *file, &content)?;
            writeln!(file)
        })?;
        names.insert(0, REPORT.to_owned());
        Ok(names)
    }
}

/// The sort key of a name: its position in the list; other names come last, by name.
fn position(names: &[String], name: &str) -> (usize, String) {
    (names.iter().position(|known| known == name).unwrap_or(names.len()), name.to_owned())
}

#[cfg(test)]
mod tests;
