//! From trials that arrive in their order to the runs of a report, without keeping the trials.

use super::run::Run;
use super::statistics::Quantiles;
use super::strategy::{StrategyResult, StrategySums};
use super::{Report, ReportSettings, position};
use evaluation::trials::Trial;
use std::collections::BTreeMap;

/// The error for a trial that was not sampled at the times of the trials before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("trials are not sampled at the same times")]
pub struct UnequalTimes;

/// The place of a name in a report, and the name.
type Place = (usize, String);

/// Makes a report from trials that arrive in the order of a report: by world, estimator, strategy and seed.
///
/// The memory is that of the report, and a few numbers per trial: single runs and merged shards have the same code and
/// the same sums.
#[derive(Default)]
pub struct ReportBuilder {
    settings: ReportSettings,
    times: Vec<u64>,
    finished: u64,
    /// By world and estimator, then by strategy.
    sums: BTreeMap<[Place; 2], BTreeMap<Place, StrategySums>>,
}

impl ReportBuilder {
    /// A report without trials.
    pub fn new(settings: ReportSettings) -> Self {
        Self { settings, ..Self::default() }
    }

    /// Adds a trial.
    ///
    /// # Errors
    ///
    /// When the trial was not sampled at the times of the first trial.
    pub fn add(&mut self, trial: &Trial) -> Result<(), UnequalTimes> {
        let times = trial.samples.iter().map(|sample| sample.time);
        if self.finished == 0 {
            self.times = times.clone().collect();
        }
        if !times.eq(self.times.iter().copied()) {
            return Err(UnequalTimes);
        }
        self.finished += 1;
        let ReportSettings { worlds, estimators, strategies, .. } = &self.settings;
        let run = [position(worlds, &trial.world), position(estimators, &trial.estimator)];
        let sums = self.sums.entry(run).or_default().entry(position(strategies, &trial.strategy));
        sums.or_insert_with(|| StrategySums::new(&trial.strategy, &self.times)).add_trial(trial);
        Ok(())
    }

    /// The report of all trials that were added.
    pub fn finish(self) -> Report {
        let Self { settings, times, finished, sums } = self;
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
        Report { settings, finished, runs }
    }
}
