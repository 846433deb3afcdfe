//! The report of an experiment: from trials to curves with confidence bands, paired comparisons,
//! the verdict on the paper's claim, files and a table.
//!
//! ```text
//! trials ──▶ runs: curves, areas, comparisons ──▶ report.json, trials.csv, figures, table, claim
//! ```

mod claim;
mod comparison;
mod figure;
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
use run::Lives;
use statistics::Quantiles;
use std::path::{Path, PathBuf};

/// Up to so many worlds are told one by one, in the table and in figures.
const ONE_BY_ONE: usize = 8;
/// A strategy that knows the truth: shown beside the others, but it cannot win.
const REFERENCE: &str = "oracle";

/// What an experiment was asked for.
#[derive(Clone, Debug, Default)]
pub struct ReportSettings {
    /// Of the program.
    pub version: String,
    /// The command line, without the program's name.
    pub arguments: Vec<String>,
    /// Steps of a trial.
    pub steps: u64,
    /// Trials of every strategy with every estimator in every world.
    pub trials: u64,
    /// How far the sensor reaches, in cells.
    pub sensor_radius: u32,
    /// Whether it was ended before all trials were finished.
    pub interrupted: bool,
    /// The worlds' names in the order in which they are to be told; those missing here come last,
    /// by name. The same for estimators and strategies.
    pub worlds: Vec<String>,
    /// The estimators' names in their order.
    pub estimators: Vec<String>,
    /// The strategies' names in their order.
    pub strategies: Vec<String>,
}

/// What came out of an experiment.
#[derive(Clone, Debug)]
pub struct Report {
    settings: ReportSettings,
    steps: Vec<u64>,
    trials: Vec<Trial>,
    runs: Vec<Run>,
}

impl Report {
    /// The statistics of `trials`, in whatever order they come.
    ///
    /// There is a run per world and estimator, and where there are several worlds one over all of
    /// them per estimator, at the end. In that one a world is what counts: it is the mean of its
    /// trials, bands span over worlds, and worlds are paired.
    ///
    /// # Panics
    ///
    /// When the trials were not looked at in the same steps.
    pub fn new(settings: ReportSettings, mut trials: Vec<Trial>) -> Self {
        let key = |trial: &Trial| {
            (
                place(&settings.estimators, &trial.estimator),
                place(&settings.worlds, &trial.world),
                place(&settings.strategies, &trial.strategy),
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
        runs.sort_by_cached_key(|run| (run.worlds > 1, place(&settings.worlds, &run.world)));
        Self { settings, steps, trials, runs }
    }

    /// What was asked for.
    pub fn settings(&self) -> &ReportSettings {
        &self.settings
    }

    /// The steps at which the trials were looked at.
    pub fn steps(&self) -> &[u64] {
        &self.steps
    }

    /// The trials, by estimator, world, strategy and seed.
    pub fn trials(&self) -> &[Trial] {
        &self.trials
    }

    /// One run per world and estimator, then those over all worlds.
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

    /// The table for a person, at most 100 columns wide.
    pub fn table(&self) -> String {
        table::table(self)
    }

    /// Writes `report.json`, `trials.csv` and the figures into `folder`, which is made unless it
    /// exists. Returns the files.
    ///
    /// `figure3` is the first run; the others are `figure3-<world>-<estimator>`, without the
    /// estimator where there is only one. Of more than eight worlds only the first is drawn, and
    /// all of them together. `pictures` are the worlds, in any order; one that is missing is left
    /// out of its figure.
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

/// Where a name belongs in a list: its position, or at the end by name.
fn place(names: &[String], name: &str) -> (usize, String) {
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
    // For the run over all worlds: what remains of a world is one unit per strategy.
    let mut in_worlds: Vec<Lives> = Vec::new();
    for (number, trials) in (0..).zip(trials.chunk_by(|a, b| a.world == b.world)) {
        let lives: Vec<Lives> = trials
            .chunk_by(|a, b| a.strategy == b.strategy)
            .map(|trials| Lives::in_world(trials, steps))
            .collect();
        in_worlds.extend(lives.iter().map(|lives| lives.as_one_world(number, steps.len())));
        runs.push(Run::new(trials[0].world.clone(), 1, estimator, lives, quantiles));
    }
    let worlds = runs.len();
    if worlds > 1 {
        // Stable: within a strategy the worlds keep their order.
        in_worlds.sort_by_cached_key(|lives| place(strategies, &lives.name));
        let lives = in_worlds.chunk_by(|a, b| a.name == b.name).map(Lives::in_all).collect();
        runs.push(Run::new(format!("all worlds ({worlds})"), worlds, estimator, lives, quantiles));
    }
    runs
}

#[cfg(test)]
mod synthetic;
#[cfg(test)]
mod tests;
