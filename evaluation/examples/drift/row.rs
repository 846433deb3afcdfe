//! A run, or several together, as a row of a CSV file: `docs/localization.md` has its tables from such rows.

use crate::options::Options;
use crate::score::{Score, quantile};
use serde::Serialize;
use std::error::Error;

/// The results of a row.
#[derive(Debug, Serialize)]
pub(crate) struct Row {
    table: String,
    variant: String,
    trials: u64,
    minutes: f64,
    scans: usize,
    median_mm: f64,
    p95_mm: f64,
    max_mm: f64,
    heading_p95_deg: f64,
    /// Shares of the scans.
    uncertain: f64,
    lost: f64,
    /// The scans with a certain pose that is wrong.
    wrong: usize,
    false_changes: u32,
    exact_false_changes: u32,
    /// The displacements, and the times until the pose was found again; empty without displacements.
    displacements: usize,
    not_recovered: usize,
    recovered_median_s: Option<f64>,
    recovered_p95_s: Option<f64>,
    recovered_max_s: Option<f64>,
}

impl Row {
    pub(crate) fn of(options: &Options, score: &Score) -> Self {
        let mm = |share| quantile(&score.errors_m, share) * 1e3;
        let share = |count: usize| count as f64 / score.scans.max(1) as f64;
        let recovery = &score.recovery;
        let recovered_s =
            |share| Some(quantile(&recovery.times_s, share)).filter(|time_s| time_s.is_finite());
        let [estimated, exact] = [1, 0].map(|which| score.false_changes[which]);
        Self {
            table: options.table.clone(),
            variant: options.variant.clone(),
            trials: options.trials,
            minutes: options.minutes,
            scans: score.scans,
            median_mm: mm(0.5),
            p95_mm: mm(0.95),
            max_mm: mm(1.0),
            heading_p95_deg: quantile(&score.headings_rad, 0.95).to_degrees(),
            uncertain: share(score.uncertain),
            lost: share(score.lost),
            wrong: recovery.wrong,
            false_changes: estimated,
            exact_false_changes: exact,
            displacements: recovery.displacements(),
            not_recovered: recovery.not_recovered,
            recovered_median_s: recovered_s(0.5),
            recovered_p95_s: recovered_s(0.95),
            recovered_max_s: recovered_s(1.0),
        }
    }
}

/// Prints a row, after the names of the columns.
pub(crate) fn print(row: &Row) -> Result<(), Box<dyn Error>> {
    let mut writer = csv::Writer::from_writer(std::io::stdout());
    writer.serialize(row)?;
    Ok(writer.flush()?)
}
