//! `report.json`. An undefined value is `null`; names are in the order of the experiment.

use super::Report;
use super::measure::Measure;
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
