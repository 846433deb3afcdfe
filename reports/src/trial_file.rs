//! `trials.csv`: one row per trial and sample, written while the trials arrive. An undefined value is an empty field. A name that
//! would begin a formula has an apostrophe before it.

use super::{Report, ReportBuilder, ReportSettings, UnequalTimes};
use evaluation::trials::{Metric, Trial};
use files::OutputError;
use rayon::prelude::*;
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// The number of trials whose rows are made together, on all threads.
const BATCH: usize = 256;

/// Takes trials in the order of the report one by one, writes `trials.csv` into a folder, and makes the report. No trial is kept.
///
/// # Errors
///
/// The first error of `trials`; when the file cannot be written, or trials were not sampled at the same times.
pub fn collect<E: From<OutputError> + From<UnequalTimes>>(
    settings: ReportSettings,
    folder: &Path,
    mut trials: impl Iterator<Item = Result<Trial, E>>,
) -> Result<Report, E> {
    let path = folder.join("trials.csv");
    let failed = |why: io::Error| OutputError::new(&path, why);
    let mut file = BufWriter::new(File::create(&path).map_err(failed)?);
    let names = Metric::ALL.map(Metric::name);
    let head = ["world", "estimator", "strategy", "seed", settings.length.column()];
    let head = csv::Writer::from_writer(&mut file)
        .write_record(head.iter().chain(&names).chain(&["map_hash"]))
        .map_err(io::Error::from);
    head.map_err(failed)?;
    let mut report = ReportBuilder::new(settings);
    loop {
        let batch: Vec<Trial> = trials.by_ref().take(BATCH).collect::<Result<_, E>>()?;
        if batch.is_empty() {
            break;
        }
        let texts: Vec<_> = batch.par_iter().map(rows).collect();
        texts.into_iter().try_for_each(|text| file.write_all(&text?)).map_err(failed)?;
        batch.iter().try_for_each(|trial| report.add(trial))?;
    }
    file.flush().map_err(failed)?;
    Ok(report.finish())
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

/// A name that a spreadsheet shows as it is: with an apostrophe before what would begin a formula.
fn no_formula(name: &str) -> Cow<'_, str> {
    if name.starts_with(['=', '+', '-', '@', '\t', '\r']) { format!("'{name}").into() } else { name.into() }
}
