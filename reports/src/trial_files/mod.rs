//! The files with every trial: one row per trial and sample, written while the trials arrive.

mod parquet;
mod text;

use self::parquet::ParquetFile;
use self::text::CsvFile;
use super::{Report, ReportBuilder, ReportSettings, UnequalTimes};
use evaluation::trials::Trial;
use files::OutputError;
use std::io;
use std::iter::once;
use std::path::Path;
use std::sync::mpsc::sync_channel;
use std::thread;

/// The maximum number of trials that wait for being written: 2 MB.
const WAITING: usize = 256;

/// Takes trials in the order of the report one by one, writes the files of trials into a folder, and makes the report.
/// No trial is kept. The files are written on another thread, since their text takes as long as reading the trials.
///
/// # Errors
///
/// The first error of `trials`; when a file cannot be written, or trials were not sampled at the same times.
pub fn collect<E: From<OutputError> + From<UnequalTimes>>(
    settings: ReportSettings,
    folder: &Path,
    trials: impl Iterator<Item = Result<Trial, E>>,
) -> Result<Report, E> {
    // Both have the same columns and rows, which do not depend on how many are added at a time.
    let mut csv = CsvFile::create(&folder.join("trials.csv"), settings.length)?;
    let mut parquet = ParquetFile::create(&folder.join("trials.parquet"), settings.length)?;
    let mut report = ReportBuilder::new(settings);
    thread::scope(|scope| {
        let (send, receive) = sync_channel::<Trial>(WAITING);
        let writer = scope.spawn(move || {
            while let Ok(first) = receive.recv() {
                let batch: Vec<Trial> = once(first).chain(receive.try_iter().take(WAITING)).collect();
                let (text, typed) = rayon::join(|| csv.add(&batch), || parquet.add(&batch));
                text.and(typed)?;
            }
            csv.finish()?;
            parquet.finish()
        });
        for trial in trials {
            let trial = trial?;
            report.add(&trial)?;
            if send.send(trial).is_err() {
                break; // the writer has failed: its error follows
            }
        }
        drop(send);
        let ended = || OutputError::new(folder, io::Error::other("the thread that writes has ended"));
        writer.join().unwrap_or_else(|_| Err(ended()))?;
        Ok(report.finish())
    })
}
