//! From trials that arrive in their order to the runs of a report, without keeping the trials.

use super::run::Run;
use super::statistics::Quantiles;
use super::strategy::{StrategyResult, StrategySums};
use super::{Report, ReportSettings, position};
use evaluation::trials::Trial;

/// The error for a trial that was not sampled at the times of the trials before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("trials are not sampled at the same times")]
pub struct UnequalTimes;

/// Makes a report from trials that arrive in the order of a report: by world, estimator, strategy and seed.
///
/// The memory is that of the report, and a few numbers per trial: single runs and merged shards have the same code and
/// the same sums.
#[derive(Default)]
pub struct ReportBuilder {
    settings: ReportSettings,
    quantiles: Quantiles,
    times: Vec<u64>,
    finished: u64,
    /// The world and the estimator of the newest trial, with the strategies before the newest one.
    group: Option<Group>,
    runs: Vec<Run>,
    /// Per estimator, in the order of first occurrence.
    all_worlds: Vec<AllWorlds>,
}

struct Group {
    world: String,
    estimator: String,
    results: Vec<StrategyResult>,
    newest: StrategySums,
}

struct AllWorlds {
    estimator: String,
    worlds: u64,
    strategies: Vec<StrategySums>,
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
        if self.finished == 0 {
            self.times = trial.samples.iter().map(|sample| sample.time).collect();
        }
        if !trial.samples.iter().map(|sample| sample.time).eq(self.times.iter().copied()) {
            return Err(UnequalTimes);
        }
        self.finished += 1;
        let is_same = |group: &Group| group.world == trial.world && group.estimator == trial.estimator;
        if !self.group.as_ref().is_some_and(is_same) {
            self.close_group();
        }
        let group = self.group.get_or_insert_with(|| Group {
            world: trial.world.clone(),
            estimator: trial.estimator.clone(),
            results: Vec::new(),
            newest: StrategySums::new(&trial.strategy, &self.times),
        });
        if group.newest.name() != trial.strategy {
            let next = StrategySums::new(&trial.strategy, &self.times);
            group.results.push(std::mem::replace(&mut group.newest, next).finish(&self.quantiles));
        }
        group.newest.add_trial(trial);
        Ok(())
    }

    /// Makes a run of the group, and adds it to the run over all worlds.
    fn close_group(&mut self) {
        let Some(Group { world, estimator, mut results, newest }) = self.group.take() else { return };
        results.push(newest.finish(&self.quantiles));
        let known = self.all_worlds.iter().position(|all| all.estimator == estimator);
        let at = known.unwrap_or_else(|| {
            let estimator = estimator.clone();
            self.all_worlds.push(AllWorlds { estimator, worlds: 0, strategies: Vec::new() });
            self.all_worlds.len() - 1
        });
        let all = &mut self.all_worlds[at];
        for result in &results {
            let known = all.strategies.iter().position(|sums| sums.name() == result.name);
            let at = known.unwrap_or_else(|| {
                all.strategies.push(StrategySums::new(&result.name, &self.times));
                all.strategies.len() - 1
            });
            all.strategies[at].add_world(all.worlds, result);
        }
        all.worlds += 1;
        self.runs.push(Run::new(world, 1, &estimator, results, &self.quantiles));
    }

    /// The report of all trials that were added.
    pub fn finish(mut self) -> Report {
        self.close_group();
        let Self { settings, quantiles, finished, mut runs, mut all_worlds, .. } = self;
        all_worlds.sort_by_cached_key(|all| position(&settings.estimators, &all.estimator));
        for mut all in all_worlds.into_iter().filter(|all| all.worlds > 1) {
            all.strategies.sort_by_cached_key(|sums| position(&settings.strategies, sums.name()));
            let results = all.strategies.into_iter().map(|sums| sums.finish(&quantiles)).collect();
            let name = format!("all worlds ({})", all.worlds);
            runs.push(Run::new(name, all.worlds as usize, &all.estimator, results, &quantiles));
        }
        Report { settings, finished, runs }
    }
}
