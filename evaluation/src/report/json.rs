//! `report.json`. What is not a number is `null`; names keep the order in which they were asked
//! for.

use super::Report;
use super::claim::Claim;
use super::comparison::Comparison;
use super::metric::{Measure, Metric, Part};
use super::run::{Run, StrategyResult};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use serde_json::ser::Formatter;
use std::io::{self, Write};

/// Writes the report.
pub(super) fn write(report: &Report, to: impl Write) -> io::Result<()> {
    let settings = &report.settings;
    let file = ReportFile {
        version: &settings.version,
        arguments: &settings.arguments,
        steps: settings.steps,
        trials: settings.trials,
        sensor_radius: settings.sensor_radius,
        interrupted: settings.interrupted,
        runs: report.runs.iter().map(|run| RunEntry::new(run, &report.steps)).collect(),
    };
    Ok(file.serialize(&mut serde_json::Serializer::with_formatter(to, Layout::default()))?)
}

#[derive(Serialize)]
struct ReportFile<'a> {
    version: &'a str,
    arguments: &'a [String],
    steps: u64,
    trials: u64,
    sensor_radius: u32,
    interrupted: bool,
    runs: Vec<RunEntry<'a>>,
}

#[derive(Serialize)]
struct RunEntry<'a> {
    world: &'a str,
    estimator: &'a str,
    claim: Option<&'static str>,
    strategies: Object<&'a str, StrategyEntry<'a>>,
    comparisons: &'a [Comparison],
}

impl<'a> RunEntry<'a> {
    fn new(run: &'a Run, steps: &'a [u64]) -> Self {
        let entry =
            |strategy: &'a StrategyResult| (strategy.name.as_str(), StrategyEntry { strategy, steps });
        Self {
            world: &run.world,
            estimator: &run.estimator,
            claim: Claim::of(run).map(|claim| claim.verdict.name()),
            strategies: Object(run.strategies.iter().map(entry).collect()),
            comparisons: &run.comparisons,
        }
    }
}

struct StrategyEntry<'a> {
    strategy: &'a StrategyResult,
    steps: &'a [u64],
}

impl Serialize for StrategyEntry<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Self { strategy, steps } = self;
        let mut object = to.serialize_map(None)?;
        object.serialize_entry("trials", &strategy.trials)?;
        for metric in Metric::ALL {
            for part in [Part::Final, Part::Area] {
                let measure = Measure { metric, part };
                object.serialize_entry(&measure.name(), &strategy.value(measure))?;
            }
        }
        object.serialize_entry("false_change_events", &strategy.false_change_events)?;
        let shares = strategy.strategy_share.iter();
        object.serialize_entry(
            "strategy_share",
            &Object(shares.map(|(name, share)| (name, *share)).collect()),
        )?;
        for metric in Metric::ALL {
            let curve = steps.iter().zip(strategy.curve(metric));
            let points: Vec<_> = curve.map(|(step, at)| (step, at.mean, at.low, at.high)).collect();
            object.serialize_entry(metric.name(), &points)?;
        }
        let hashes = strategy.map_hashes.iter();
        object.serialize_entry("map_hashes", &Object(hashes.map(|(seed, hash)| (*seed, hash)).collect()))?;
        object.end()
    }
}

/// Pairs as an object, in their order.
struct Object<K, V>(Vec<(K, V)>);

impl<K: Serialize, V: Serialize> Serialize for Object<K, V> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

impl Serialize for Measure {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&self.name())
    }
}

/// Every key on a line of its own, but a curve, which is an array of arrays, on one.
#[derive(Default)]
struct Layout {
    depth: usize,
    is_empty: bool,
    is_in_array: bool,
}

impl Layout {
    fn new_line<W: ?Sized + Write>(&self, to: &mut W) -> io::Result<()> {
        write!(to, "\n{:1$}", "", 2 * self.depth)
    }
}

impl Formatter for Layout {
    fn begin_array<W: ?Sized + Write>(&mut self, to: &mut W) -> io::Result<()> {
        self.is_in_array = false;
        to.write_all(b"[")
    }

    fn begin_array_value<W: ?Sized + Write>(&mut self, to: &mut W, is_first: bool) -> io::Result<()> {
        self.is_in_array = true;
        if is_first { Ok(()) } else { to.write_all(b",") }
    }

    fn begin_object<W: ?Sized + Write>(&mut self, to: &mut W) -> io::Result<()> {
        if self.is_in_array {
            self.new_line(to)?;
        }
        self.depth += 1;
        self.is_empty = true;
        to.write_all(b"{")
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, to: &mut W, is_first: bool) -> io::Result<()> {
        self.is_empty = false;
        if !is_first {
            to.write_all(b",")?;
        }
        self.new_line(to)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, to: &mut W) -> io::Result<()> {
        self.is_in_array = false;
        to.write_all(b": ")
    }

    fn end_object<W: ?Sized + Write>(&mut self, to: &mut W) -> io::Result<()> {
        self.depth -= 1;
        if !self.is_empty {
            self.new_line(to)?;
        }
        self.is_empty = false;
        to.write_all(b"}")
    }
}
