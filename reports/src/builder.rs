//! From trials in their order to the runs of a report.

use super::comparison::{Comparison, compare_all};
use super::statistics::Quantiles;
use super::strategy::{Measure, StrategyResult, StrategySums};
use super::{Report, ReportSettings, position};
use evaluation::trials::{Metric, Trial};
use files::{OutputError, UnfinishedFile};
use interfaces::printable;
use rayon::prelude::*;
use serde::{Serialize, Serializer};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// The error for a trial that was not sampled at the times of the trials before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("trials are not sampled at the same times")]
pub struct UnequalTimes;

/// The place of a name in a report, and the name.
type Place = (usize, String);

/// The report of trials in the order of a report: by world, estimator, strategy and seed.
///
/// # Errors
///
/// When the trials were not sampled at the same times.
pub(super) fn build(settings: ReportSettings, trials: &[Trial]) -> Result<Report, UnequalTimes> {
    let times_of = |trial: &Trial| trial.samples.iter().map(|sample| sample.time).collect::<Vec<u64>>();
    let times = trials.first().map(times_of).unwrap_or_default();
    // By world and estimator, then by strategy.
    let mut sums: BTreeMap<[Place; 2], BTreeMap<Place, StrategySums>> = BTreeMap::new();
    for trial in trials {
        if times_of(trial) != times {
            return Err(UnequalTimes);
        }
        let ReportSettings { worlds, estimators, strategies, .. } = &settings;
        let run = [position(worlds, &trial.world), position(estimators, &trial.estimator)];
        let sums = sums.entry(run).or_default().entry(position(strategies, &trial.strategy));
        sums.or_insert_with(|| StrategySums::new(&trial.strategy, &times)).add_trial(trial);
    }
    let quantiles = Quantiles::default();
    let mut runs = Vec::new();
    // By estimator: the number of worlds, and the sums over the worlds by strategy.
    let mut all_worlds: BTreeMap<Place, (u64, BTreeMap<Place, StrategySums>)> = BTreeMap::new();
    for ([(_, world), estimator], strategies) in sums {
        let (worlds, of_all) = all_worlds.entry(estimator.clone()).or_default();
        let result = |(place, sums): (Place, StrategySums)| {
            let result = sums.finish(&quantiles);
            let of_all = of_all.entry(place);
            let of_all = of_all.or_insert_with(|| StrategySums::new(&result.name, &times));
            of_all.add_world(*worlds, &result);
            result
        };
        let results: Vec<StrategyResult> = strategies.into_iter().map(result).collect();
        *worlds += 1;
        runs.push(Run::new(world, 1, &estimator.1, results, &quantiles));
    }
    for ((_, estimator), (worlds, strategies)) in all_worlds.into_iter().filter(|(_, all)| all.0 > 1) {
        let results = strategies.into_values().map(|sums| sums.finish(&quantiles)).collect();
        runs.push(Run::new(
            format!("all worlds ({worlds})"),
            worlds as usize,
            &estimator,
            results,
            &quantiles,
        ));
    }
    Ok(Report { settings, finished: trials.len() as u64, runs })
}

// All strategies with one estimator in one world, or over all worlds.

/// The strategies with one estimator in one world, or over all worlds.
#[derive(Clone, Debug, Serialize)]
pub struct Run {
    /// The name of the world; `all worlds (N)` for the run over all worlds.
    pub world: String,
    /// The number of worlds: 1, except in the run over all worlds.
    #[serde(skip)]
    pub worlds: usize,
    /// The name of the estimator.
    pub estimator: String,
    /// The strategies, in the order of the experiment.
    #[serde(serialize_with = "by_name")]
    pub strategies: Vec<StrategyResult>,
    /// Every pair of strategies in every measure of [`Measure::COMPARED`].
    pub comparisons: Vec<Comparison>,
}

impl Run {
    pub(super) fn new(
        world: String,
        worlds: usize,
        estimator: &str,
        strategies: Vec<StrategyResult>,
        quantiles: &Quantiles,
    ) -> Self {
        let comparisons = compare_all(&strategies, quantiles);
        Self { world, worlds, estimator: estimator.into(), strategies, comparisons }
    }

    /// The strategy with a name; `None` if the run does not have it.
    pub fn strategy(&self, name: &str) -> Option<&StrategyResult> {
        self.strategies.iter().find(|strategy| strategy.name == name)
    }

    /// The difference a − b between two strategies; `None` if there is no pair of trials.
    pub fn comparison(&self, a: &str, b: &str, measure: Measure) -> Option<Comparison> {
        let mut same = self.comparisons.iter().filter(|comparison| comparison.measure == measure);
        same.find_map(|comparison| match (comparison.a.as_str(), comparison.b.as_str()) {
            names if names == (a, b) => Some(comparison.clone()),
            names if names == (b, a) => Some(comparison.flipped()),
            _ => None,
        })
    }
}

fn by_name<S: Serializer>(strategies: &[StrategyResult], to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(strategies.iter().map(|strategy| (&strategy.name, strategy)))
}

/// The conditions of a run: `5 trials of 20,000 steps, estimator two-state, sensor radius 4`; `3 to 5 trials` where
/// strategies have different numbers of trials, as after an interruption.
pub(super) fn conditions(run: &Run, settings: &ReportSettings) -> String {
    let counts = run.strategies.iter().map(|strategy| strategy.trials);
    let trials = match (counts.clone().min().unwrap_or(0), counts.max().unwrap_or(0)) {
        (1, 1) => "1 trial".into(),
        (least, most) if least == most => format!("{most} trials"),
        (least, most) => format!("{least} to {most} trials"),
    };
    let ReportSettings { length, sensor_radius, interrupted, .. } = settings;
    let short = if *interrupted { " (interrupted)" } else { "" };
    let sensor = sensor_radius.map_or(String::new(), |radius| format!(", sensor radius {radius}"));
    format!("{trials} of {length}{short}, estimator {}{sensor}", run.estimator)
}

// `trials.csv`: one row per trial and sample. An undefined value is an empty field. A name that
// would begin a formula has an apostrophe before it.

/// The number of trials whose rows are made together, on all threads.
const BATCH: usize = 256;

/// Writes `trials.csv` into a folder, and makes the report. `trials` are in the order of the report.
///
/// # Errors
///
/// When the file cannot be written, or trials were not sampled at the same times.
pub fn collect<E: From<OutputError> + From<UnequalTimes>>(
    settings: ReportSettings,
    folder: &Path,
    trials: &[Trial],
) -> Result<Report, E> {
    let path = folder.join("trials.csv");
    let failed = |why: io::Error| OutputError::new(&path, why);
    let mut file = BufWriter::new(UnfinishedFile::create(&path)?);
    let names = Metric::ALL.map(Metric::name);
    let head = ["world", "estimator", "strategy", "seed", settings.length.column()];
    let head = csv::Writer::from_writer(&mut file)
        .write_record(head.iter().chain(&names).chain(&["map_hash"]))
        .map_err(io::Error::from);
    head.map_err(failed)?;
    for batch in trials.chunks(BATCH) {
        let texts: Vec<_> = batch.par_iter().map(rows).collect();
        texts.into_iter().try_for_each(|text| file.write_all(&text?)).map_err(failed)?;
    }
    file.into_inner().map_err(|error| failed(error.into_error()))?.finish()?;
    Ok(build(settings, trials)?)
}

/// The rows of a trial.
fn rows(trial: &Trial) -> io::Result<Vec<u8>> {
    let mut rows = csv::Writer::from_writer(Vec::new());
    let names = [&trial.world, &trial.estimator, &trial.strategy].map(|name| no_formula(name));
    let seed = trial.seed.to_string();
    for sample in &trial.samples {
        let values = Metric::ALL.map(|metric| metric.of(sample));
        let texts = values.map(|value| if value.is_nan() { String::new() } else { value.to_string() });
        let time = sample.time.to_string();
        let before = names.iter().map(AsRef::as_ref).chain([seed.as_str(), &time]);
        rows.write_record(before.chain(texts.iter().map(String::as_str)).chain([trial.map_hash.as_str()]))?;
    }
    rows.into_inner().map_err(|error| io::Error::other(error.to_string()))
}

/// A name that a spreadsheet shows as it is: printable, with an apostrophe before what would begin a formula.
fn no_formula(name: &str) -> Cow<'_, str> {
    let name = printable(name);
    if name.starts_with(['=', '+', '-', '@']) { format!("'{name}").into() } else { name }
}
