//! The results of one strategy: curves, areas, and the units of averages and pairs.

use super::statistics::{Estimate, Moments, Quantiles};
use evaluation::trials::{Metric, Trial};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// The results of one strategy.
#[derive(Clone, Debug, Default)]
pub struct StrategyResult {
    /// The name of the strategy.
    pub name: String,
    /// The number of trials of the strategy.
    pub trials: usize,
    /// For each strategy of the agent, the mean share of the goals that it selected.
    pub strategy_share: Vec<(String, f64)>,
    /// The number of change events on static cells, in all trials.
    pub false_change_events: u64,
    /// The number of changes of static cells in the map, in all trials.
    pub false_map_changes: u64,
    /// The number of collisions while the robot moved, in all trials; `None` in grid worlds.
    pub collisions: Option<u64>,
    /// The times of the samples: steps, or s in physics worlds.
    pub times: Vec<u64>,
    /// The trials (over all worlds: the worlds), in the order of their keys.
    pub(super) units: Vec<Unit>,
    /// One per metric and sample, in the order of [`Metric::ALL`].
    curves: Vec<Vec<Estimate>>,
    /// One per metric.
    areas: Vec<f64>,
}

/// The unit of averages and pairs: a trial, or a world averaged over its trials.
#[derive(Clone, Debug)]
pub(super) struct Unit {
    /// The seed, or the number of the world.
    pub(super) key: u64,
    /// One per measure of [`Measure::COMPARED`].
    values: [f64; Measure::COMPARED.len()],
}

impl Unit {
    /// The value of a measure that is compared; NaN for another measure.
    pub(super) fn value(&self, measure: Measure) -> f64 {
        let compared = Measure::COMPARED.iter().position(|compared| *compared == measure);
        compared.map_or(f64::NAN, |at| self.values[at])
    }
}

impl StrategyResult {
    /// The mean and its 95 % confidence interval at every sample, over the trials (in the run over all worlds: over
    /// the worlds).
    pub fn curve(&self, metric: Metric) -> &[Estimate] {
        &self.curves[metric as usize]
    }

    /// The mean over the trials (in the run over all worlds: over the worlds); NaN if the measure is undefined in
    /// all of them.
    pub fn value(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Final(metric) => self.curve(metric).last().map_or(f64::NAN, |last| last.mean),
            Measure::Area(metric) => self.areas[metric as usize],
        }
    }
}

/// The results of one strategy while its trials, or its results in single worlds, arrive in the order of their keys. The
/// memory for a trial is that of a [`Unit`].
pub(super) struct StrategySums {
    /// The results without curves and areas.
    result: StrategyResult,
    /// One per metric and sample.
    curves: Vec<Vec<Moments>>,
    /// One per metric.
    areas: Vec<Moments>,
}

impl StrategySums {
    /// No trial yet.
    pub(super) fn new(name: &str, times: &[u64]) -> Self {
        let (name, times) = (name.to_owned(), times.to_vec());
        Self {
            curves: vec![vec![Moments::default(); times.len()]; Metric::ALL.len()],
            areas: vec![Moments::default(); Metric::ALL.len()],
            result: StrategyResult { name, times, collisions: Some(0), ..StrategyResult::default() },
        }
    }

    /// Adds a trial.
    pub(super) fn add_trial(&mut self, trial: &Trial) {
        let curve = |metric: Metric| trial.samples.iter().map(|sample| metric.of(sample)).collect();
        let curves: Vec<Vec<f64>> = Metric::ALL.map(curve).into();
        let areas: Vec<f64> = curves.iter().map(|curve| area(&self.result.times, curve)).collect();
        self.add_unit(trial.seed, &curves, &areas);
        let Trial { strategy_share, false_change_events, false_map_changes, collisions, .. } = trial;
        self.add_counts(1, strategy_share, [*false_change_events, *false_map_changes], *collisions);
    }

    /// Adds the result in the world with a number.
    pub(super) fn add_world(&mut self, number: u64, world: &StrategyResult) {
        let means = |curve: &Vec<Estimate>| curve.iter().map(|at| at.mean).collect();
        let curves: Vec<Vec<f64>> = world.curves.iter().map(means).collect();
        self.add_unit(number, &curves, &world.areas);
        let false_changes = [world.false_change_events, world.false_map_changes];
        self.add_counts(world.trials, &world.strategy_share, false_changes, world.collisions);
    }

    fn add_unit(&mut self, key: u64, curves: &[Vec<f64>], areas: &[f64]) {
        for (sums, curve) in self.curves.iter_mut().zip(curves) {
            sums.iter_mut().zip(curve).for_each(|(sum, value)| sum.add(*value));
        }
        self.areas.iter_mut().zip(areas).for_each(|(sum, value)| sum.add(*value));
        let values = Measure::COMPARED.map(|measure| match measure {
            Measure::Final(metric) => curves[metric as usize].last().copied().unwrap_or(f64::NAN),
            Measure::Area(metric) => areas[metric as usize],
        });
        self.result.units.push(Unit { key, values });
    }

    /// Adds the counts of the newest unit, and takes its shares into their means, in the order of first occurrence; a share
    /// that a unit lacks is 0 in it.
    fn add_counts(
        &mut self,
        trials: usize,
        shares: &[(String, f64)],
        [change_events, map_changes]: [u64; 2],
        collisions: Option<u64>,
    ) {
        let result = &mut self.result;
        result.trials += trials;
        result.false_change_events += change_events;
        result.false_map_changes += map_changes;
        result.collisions = result.collisions.zip(collisions).map(|(sum, count)| sum + count);
        let (means, units) = (&mut result.strategy_share, result.units.len());
        for (name, _) in shares {
            if !means.iter().any(|(known, _)| known == name) {
                means.push((name.clone(), 0.0));
            }
        }
        for (name, mean) in means {
            let share: f64 = shares.iter().filter(|(of, _)| of == name).map(|(_, share)| share).sum();
            *mean += (share - *mean) / units as f64;
        }
    }

    /// The results of everything that was added.
    pub(super) fn finish(self, quantiles: &Quantiles) -> StrategyResult {
        let curve = |metric: Metric| {
            let sums = self.curves[metric as usize].iter();
            sums.map(|values| quantiles.estimate(values).within(metric.range())).collect()
        };
        let (curves, areas) = (Metric::ALL.map(curve).into(), self.areas.iter().map(Moments::mean).collect());
        StrategyResult { curves, areas, ..self.result }
    }
}

// The strategies of `report.json`. An undefined value is `null`; names are in the order of the experiment.

impl Serialize for StrategyResult {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut object = to.serialize_map(None)?;
        object.serialize_entry("trials", &self.trials)?;
        for measure in Metric::ALL.iter().flat_map(|&metric| [Measure::Final(metric), Measure::Area(metric)])
        {
            object.serialize_entry(&measure.name(), &self.value(measure))?;
        }
        object.serialize_entry("false_change_events", &self.false_change_events)?;
        object.serialize_entry("false_map_changes", &self.false_map_changes)?;
        if let Some(collisions) = self.collisions {
            object.serialize_entry("collisions", &collisions)?;
        }
        object.serialize_entry("strategy_share", &Shares(&self.strategy_share))?;
        for metric in Metric::ALL {
            let curve = self.times.iter().zip(self.curve(metric));
            let points: Vec<_> = curve.map(|(time, at)| (time, at.mean, at.low, at.high)).collect();
            object.serialize_entry(metric.name(), &points)?;
        }
        object.end()
    }
}

/// Pairs as an object, in their order.
struct Shares<'a>(&'a [(String, f64)]);

impl Serialize for Shares<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(self.0.iter().map(|(name, share)| (name, share)))
    }
}

// The measures in which strategies are compared.

/// One number per trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(into = "String")]
pub enum Measure {
    /// The value of a metric in the last sample.
    Final(Metric),
    /// The area under the curve of a metric divided by the length of the run, that is, the mean over the run, in
    /// the unit of the metric.
    Area(Metric),
}

impl Measure {
    /// The primary measure: the log error of the rates over the run.
    pub const PRIMARY: Self = Self::Area(Metric::LogError);

    /// The measures in which strategies are compared pair by pair.
    pub const COMPARED: [Self; 7] = [
        Self::PRIMARY,
        Self::Final(Metric::LogError),
        Self::Area(Metric::RateError),
        Self::Final(Metric::RateError),
        Self::Final(Metric::MapQuality),
        Self::Final(Metric::MapQualityChanging),
        Self::Final(Metric::Brier),
    ];

    /// The name in `report.json`, as `final_log_error` or `log_error_area`.
    pub fn name(self) -> String {
        match self {
            Self::Final(metric) => format!("final_{}", metric.name()),
            Self::Area(metric) => format!("{}_area", metric.name()),
        }
    }
}

impl From<Measure> for String {
    fn from(measure: Measure) -> Self {
        measure.name()
    }
}

/// The area under the curve through `values` at `times` (increasing), divided by its length.
///
/// Before the first time, the first value is used, so that a curve that begins at step 1 gives a mean over the
/// whole run. Segments with NaN are left out of area and length. The result is NaN if there is no value.
pub(super) fn area(times: &[u64], values: &[f64]) -> f64 {
    let (Some(&first_time), Some(&first)) = (times.first(), values.first()) else { return f64::NAN };
    let (mut area, mut length) = (0.0, 0.0);
    if !first.is_nan() {
        area = first * first_time as f64;
        length = first_time as f64;
    }
    for (times, values) in times.windows(2).zip(values.windows(2)) {
        let height = (values[0] + values[1]) / 2.0;
        if !height.is_nan() {
            let width = (times[1] - times[0]) as f64;
            area += height * width;
            length += width;
        }
    }
    if length > 0.0 {
        area / length
    } else {
        values.iter().copied().find(|value| !value.is_nan()).unwrap_or(f64::NAN)
    }
}
