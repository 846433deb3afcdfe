//! `trials.csv`. An undefined value is an empty field. A name that would begin a formula has an apostrophe before it.

use evaluation::trials::Length;
use evaluation::trials::{Metric, Trial};
use files::OutputError;
use rayon::prelude::*;
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

pub(super) struct CsvFile {
    path: PathBuf,
    file: BufWriter<File>,
}

impl CsvFile {
    pub(super) fn create(path: &Path, length: Length) -> Result<Self, OutputError> {
        let names = Metric::ALL.map(Metric::name);
        let head = ["world", "estimator", "strategy", "seed", length.column()];
        let create = || {
            let mut file = BufWriter::new(File::create(path)?);
            csv::Writer::from_writer(&mut file)
                .write_record(head.iter().chain(&names).chain(&["map_hash"]))?;
            Ok(file)
        };
        let file = create().map_err(|why: io::Error| OutputError::new(path, why))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Adds the rows of trials; their text is made on all threads.
    pub(super) fn add(&mut self, trials: &[Trial]) -> Result<(), OutputError> {
        let texts: Vec<_> = trials.par_iter().map(rows).collect();
        let written = texts.into_iter().try_for_each(|text| self.file.write_all(&text?));
        written.map_err(|why| OutputError::new(&self.path, why))
    }

    pub(super) fn finish(mut self) -> Result<(), OutputError> {
        self.file.flush().map_err(|why| OutputError::new(&self.path, why))
    }
}

/// The rows of a trial.
fn rows(trial: &Trial) -> io::Result<Vec<u8>> {
    let mut rows = csv::Writer::from_writer(Vec::new());
    let names = [&trial.world, &trial.estimator, &trial.strategy].map(|name| no_formula(name));
    let seed = trial.seed.to_string();
    let mut text = Vec::new();
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
    rows.into_inner().map_err(|error| io::Error::other(error.to_string()))
}

/// A name that a spreadsheet shows as it is: with an apostrophe before what would begin a formula.
fn no_formula(name: &str) -> Cow<'_, str> {
    if name.starts_with(['=', '+', '-', '@', '\t', '\r']) { format!("'{name}").into() } else { name.into() }
}
