//! The files with every trial: one row per trial and sample, written while the trials arrive.

mod parquet;
mod text;

use self::parquet::ParquetFile;
use self::text::CsvFile;
use super::length::Length;
use super::metric::Trial;
use crate::output::OutputError;
use std::path::Path;

/// `trials.csv` and `trials.parquet`, which have the same columns and rows.
pub struct TrialFiles {
    csv: CsvFile,
    parquet: ParquetFile,
}

impl TrialFiles {
    /// Creates the files in a folder, for trials of a length.
    ///
    /// # Errors
    ///
    /// When a file cannot be written.
    pub fn create(folder: &Path, length: Length) -> Result<Self, OutputError> {
        Ok(Self {
            csv: CsvFile::create(&folder.join("trials.csv"), length)?,
            parquet: ParquetFile::create(&folder.join("trials.parquet"), length)?,
        })
    }

    /// Adds a trial.
    ///
    /// # Errors
    ///
    /// When a file cannot be written.
    pub fn add(&mut self, trial: &Trial) -> Result<(), OutputError> {
        self.csv.add(trial)?;
        self.parquet.add(trial)
    }

    /// Completes the files.
    ///
    /// # Errors
    ///
    /// When a file cannot be written.
    pub fn finish(self) -> Result<(), OutputError> {
        self.csv.finish()?;
        self.parquet.finish()
    }
}
