//! `report.json`. An undefined value is `null`; names are in the order of the experiment.

use super::Report;
use super::measure::Measure;
use super::run::Run;
use super::strategy::StrategyResult;
use evaluation::trials::Metric;
use robot::BUILD;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use std::io::{self, Write};

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

/// Writes `report.json`; `files` are the names of the other files.
pub(super) fn write_report(report: &Report, files: &[String], mut to: impl Write) -> io::Result<()> {
    let content = Content { schema: SCHEMA, build: BUILD, report, files };
    serde_json::to_writer(&mut to, &content)?;
    writeln!(to)
}

impl Serialize for Run {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut object = to.serialize_map(None)?;
        object.serialize_entry("world", &self.world)?;
        object.serialize_entry("estimator", &self.estimator)?;
        let strategies = self.strategies.iter().map(|strategy| (&strategy.name, strategy));
        object.serialize_entry("strategies", &Object(strategies))?;
        object.serialize_entry("comparisons", &self.comparisons)?;
        object.end()
    }
}

impl Serialize for StrategyResult {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut object = to.serialize_map(None)?;
        object.serialize_entry("trials", &self.trials)?;
        for measure in Metric::ALL.iter().flat_map(|&metric| [Measure::Final(metric), Measure::Area(metric)])
        {
            object.serialize_entry(&measure, &self.value(measure))?;
        }
        object.serialize_entry("false_change_events", &self.false_change_events)?;
        object.serialize_entry("false_map_changes", &self.false_map_changes)?;
        if let Some(collisions) = self.collisions {
            object.serialize_entry("collisions", &collisions)?;
        }
        object.serialize_entry("strategy_share", &Object(self.strategy_share.iter().cloned()))?;
        for metric in Metric::ALL {
            let curve = self.times.iter().zip(self.curve(metric));
            let points: Vec<_> = curve.map(|(time, at)| (time, at.mean, at.low, at.high)).collect();
            object.serialize_entry(metric.name(), &points)?;
        }
        object.end()
    }
}

impl Serialize for Measure {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&self.name())
    }
}

/// Pairs as an object, in their order.
struct Object<I>(I);

impl<K: Serialize, V: Serialize, I: Iterator<Item = (K, V)> + Clone> Serialize for Object<I> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(self.0.clone())
    }
}
