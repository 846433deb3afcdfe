//! The report of an experiment: from trials to curves with confidence bands, paired comparisons,
//! the verdict on the paper's claim, files and a table.
//!
//! ```text
//! trials ──▶ runs: curves, areas, comparisons ──▶ report.json, trials.csv, figures, table, claim
//! ```

mod claim;
mod comparison;
mod figure;
mod group;
mod json;
mod metric;
mod run;
mod statistics;
mod table;
mod trial;
mod trials_csv;
mod wording;
mod world_picture;

pub use claim::{Claim, Verdict};
pub use comparison::Comparison;
pub use metric::{Measure, Metric, Part};
pub use run::{Run, StrategyResult};
pub use statistics::Estimate;
pub use trial::{Sample, Trial};
pub use world_picture::WorldPicture;

use crate::drawing::PictureError;
use crate::output::{make_folder, write_file};
use group::TrialGroup;
use statistics::Quantiles;
use std::path::{Path, PathBuf};

/// The table and the figures show single worlds up to this number of worlds.
const ONE_BY_ONE: usize = 8;
/// A strategy that knows the ground truth: it is shown beside the others, but it cannot win.
const REFERENCE: &str = "oracle";

/// The settings of an experiment.
#[derive(Clone, Debug, Default)]
pub struct ReportSettings {
    /// The version of the program.
    pub version: String,
    /// The command line, without the name of the program.
    pub arguments: Vec<String>,
    /// The length of a trial, in steps.
    pub steps: u64,
    /// The number of trials of every strategy with every estimator in every world.
    pub trials: u64,
    /// The range of the sensor, in cells.
    pub sensor_radius: u32,
    /// Whether the experiment was interrupted before all trials were finished.
    pub interrupted: bool,
    /// The names of the worlds in the order of the report; other worlds come last, by name. The same holds
    /// for estimators and strategies.
    pub worlds: Vec<String>,
    /// The names of the estimators in their order.
    pub estimators: Vec<String>,
    /// The names of the strategies in their order.
    pub strategies: Vec<String>,
}

/// The results of an experiment.
#[derive(Clone, Debug)]
pub struct Report {
    settings: ReportSettings,
    steps: Vec<u64>,
    trials: Vec<Trial>,
    runs: Vec<Run>,
}

impl Report {
    /// The statistics of `trials`, which can be in any order.
    ///
    /// There is one run per world and estimator. With several worlds, there is also one run over all worlds per
    /// estimator, at the end. In that run a world is the unit: its value is the mean of its trials, bands span
    /// the worlds, and worlds are paired.
    ///
    /// # Panics
    ///
    /// When the trials were not sampled at the same steps.
    pub fn new(settings: ReportSettings, mut trials: Vec<Trial>) -> Self {
        let key = |trial: &Trial| {
            (
                position(&settings.estimators, &trial.estimator),
                position(&settings.worlds, &trial.world),
                position(&settings.strategies, &trial.strategy),
                trial.seed,
            )
        };
        trials.sort_by_cached_key(key);
        let steps_of = |trial: &Trial| trial.samples.iter().map(|sample| sample.step).collect::<Vec<_>>();
        let steps = trials.first().map(steps_of).unwrap_or_default();
        assert!(trials.iter().all(|trial| steps_of(trial) == steps), "trials are sampled at the same steps");

        let quantiles = Quantiles::up_to(trials.len());
        let mut runs = Vec::new();
        for trials in trials.chunk_by(|a, b| a.estimator == b.estimator) {
            runs.extend(runs_of_estimator(trials, &settings.strategies, &steps, &quantiles));
        }
        // World by world, each with all estimators; the entries over all worlds stay at the end.
        runs.sort_by_cached_key(|run| (run.worlds > 1, position(&settings.worlds, &run.world)));
        Self { settings, steps, trials, runs }
    }

    /// The settings of the experiment.
    pub fn settings(&self) -> &ReportSettings {
        &self.settings
    }

    /// The steps at which the trials were sampled.
    pub fn steps(&self) -> &[u64] {
        &self.steps
    }

    /// The trials, by estimator, world, strategy and seed.
    pub fn trials(&self) -> &[Trial] {
        &self.trials
    }

    /// One run per world and estimator, then the runs over all worlds.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// The run with `estimator` in `world`, or over `all worlds (N)`.
    pub fn run(&self, world: &str, estimator: &str) -> Option<&Run> {
        self.runs.iter().find(|run| run.world == world && run.estimator == estimator)
    }

    /// The verdict on the paper's claim in one run; `None` unless `curious`, `recency` and
    /// `poisson` are in it.
    pub fn claim(&self, world: &str, estimator: &str) -> Option<Claim> {
        Claim::of(self.run(world, estimator)?)
    }

    /// The table for a terminal, at most 100 columns wide.
    pub fn table(&self) -> String {
        table::table(self)
    }

    /// Writes `report.json`, `trials.csv` and the figures into `folder`, which is made unless it
    /// exists. Returns the files.
    ///
    /// `figure3` shows the first run; the other figures are `figure3-<world>-<estimator>`, without the estimator
    /// if there is only one. With more than eight worlds, only the first world and all worlds together are drawn.
    /// `pictures` are the plans of the worlds, in any order; a world without a plan is left out of its figure.
    ///
    /// # Errors
    ///
    /// When something cannot be drawn or written.
    pub fn write(&self, folder: &Path, pictures: &[WorldPicture]) -> Result<Vec<PathBuf>, PictureError> {
        make_folder(folder)?;
        let report = folder.join("report.json");
        write_file(&report, |file| {
            json::write(self, &mut *file)?;
            file.write_all(b"\n")
        })?;
        let trials = folder.join("trials.csv");
        write_file(&trials, |file| trials_csv::write(&self.trials, file))?;
        let mut files = vec![report, trials];
        files.extend(figure::write_all(folder, self, pictures)?);
        Ok(files)
    }
}

/// The sort key of a name: its position in the list; other names come last, by name.
fn position(names: &[String], name: &str) -> (usize, String) {
    (names.iter().position(|known| known == name).unwrap_or(names.len()), name.to_owned())
}

/// One run per world, and one over all of them; `trials` are of one estimator, sorted.
fn runs_of_estimator(
    trials: &[Trial],
    strategies: &[String],
    steps: &[u64],
    quantiles: &Quantiles,
) -> Vec<Run> {
    let estimator = &trials[0].estimator;
    let mut runs = Vec::new();
    // For the run over all worlds: a world is one unit per strategy.
    let mut in_worlds: Vec<TrialGroup> = Vec::new();
    for (number, trials) in (0..).zip(trials.chunk_by(|a, b| a.world == b.world)) {
        let group: Vec<TrialGroup> = trials
            .chunk_by(|a, b| a.strategy == b.strategy)
            .map(|trials| TrialGroup::in_world(trials, steps))
            .collect();
        in_worlds.extend(group.iter().map(|group| group.as_one_world(number, steps.len())));
        runs.push(Run::new(trials[0].world.clone(), 1, estimator, group, quantiles));
    }
    let worlds = runs.len();
    if worlds > 1 {
        // Stable: within a strategy the worlds keep their order.
        in_worlds.sort_by_cached_key(|group| position(strategies, &group.name));
        let group = in_worlds.chunk_by(|a, b| a.name == b.name).map(TrialGroup::in_all).collect();
        runs.push(Run::new(format!("all worlds ({worlds})"), worlds, estimator, group, quantiles));
    }
    runs
}

#[cfg(test)]
mod synthetic;
#[cfg(test)]
mod tests;
