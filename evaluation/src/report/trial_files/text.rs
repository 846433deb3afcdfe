//! `trials.csv`. An undefined value is an empty field. A name that would begin a formula has an apostrophe before it.

use crate::output::OutputError;
use crate::report::length::Length;
use crate::report::metric::{Metric, Trial};
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

pub(super) struct CsvFile {
    path: PathBuf,
    rows: csv::Writer<File>,
    /// The text of a number.
    text: Vec<u8>,
}

impl CsvFile {
    pub(super) fn create(path: &Path, length: Length) -> Result<Self, OutputError> {
        let file = File::create(path).map_err(|why| OutputError::new(path, why))?;
        let mut rows = csv::WriterBuilder::new().buffer_capacity(1 << 16).from_writer(file);
        let names = Metric::ALL.map(Metric::name);
        let head = ["world", "estimator", "strategy", "seed", length.column()];
        let written = rows.write_record(head.iter().chain(&names).chain(&["map_hash"]));
        written.map_err(|why| OutputError::new(path, why))?;
        Ok(Self { path: path.to_owned(), rows, text: Vec::new() })
    }

    pub(super) fn add(&mut self, trial: &Trial) -> Result<(), OutputError> {
        self.write(trial).map_err(|why| OutputError::new(&self.path, why))
    }

    fn write(&mut self, trial: &Trial) -> io::Result<()> {
        let Self { rows, text, .. } = self;
        let names = [&trial.world, &trial.estimator, &trial.strategy].map(|name| no_formula(name));
        let seed = trial.seed.to_string();
        for sample in &trial.samples {
            for name in &names {
                rows.write_field(name.as_ref())?;
            }
            rows.write_field(&seed)?;
            let mut number = |value: &dyn std::fmt::Display| {
                text.clear();
                write!(text, "{value}")?;
                rows.write_field(&text).map_err(io::Error::from)
            };
            number(&sample.time)?;
            for value in Metric::ALL.map(|metric| metric.of(sample)) {
                if value.is_nan() { number(&"")? } else { number(&value)? }
            }
            rows.write_field(&trial.map_hash)?;
            rows.write_record(None::<&[u8]>)?;
        }
        Ok(())
    }

    pub(super) fn finish(mut self) -> Result<(), OutputError> {
        self.rows.flush().map_err(|why| OutputError::new(&self.path, why))
    }
}

/// A name that a spreadsheet shows as it is: with an apostrophe before what would begin a formula.
fn no_formula(name: &str) -> Cow<'_, str> {
    if name.starts_with(['=', '+', '-', '@', '\t', '\r']) { format!("'{name}").into() } else { name.into() }
}
