//! A log of any format.

use crate::bag::{self, Bag, BagFile};
use crate::bytes::Bytes;
use crate::carmen::{self, CarmenLog};
use crate::choice::TopicChoice;
use crate::error::LogError;
use crate::summary::LogSummary;
use interfaces::LaserReading;
use nalgebra::Isometry2;
use std::path::Path;

/// A log of any format.
#[derive(Clone, Debug)]
pub struct Log {
    format: Format,
}

#[derive(Clone, Debug)]
enum Format {
    Carmen(CarmenLog),
    Bag(Bag),
}

impl Log {
    /// Opens a log, and surveys it: it is read once or twice as a whole. `path` is
    ///
    /// - a CARMEN log, plain or compressed with gzip,
    /// - a file of a bag of ROS 2: MCAP, an SQLite database, or one of them compressed with zstd,
    /// - a folder with such files, in the order of its `metadata.yaml`, or of their names where it is missing.
    ///
    /// The format follows from the content, not from the name. `choice` is for bags; see [`TopicChoice`].
    ///
    /// # Errors
    ///
    /// When a file cannot be read or is damaged, when it has no usable scan, or when several topics are odometry and
    /// `choice` names no topic of odometry. What can be repaired or left out is no error but a note, see
    /// [`LogSummary::notes`].
    pub fn open(path: &Path, choice: &TopicChoice) -> Result<Self, LogError> {
        let name = path.display().to_string();
        if path.is_dir() {
            let (files, note) = bag::in_folder(path)?;
            let bag = Bag::open(&name, files, choice, note.into_iter().collect())?;
            return Ok(Self { format: Format::Bag(bag) });
        }
        if path.metadata().is_ok_and(|known| !known.is_file()) {
            // A pipe would wait for ever.
            let why =
                "it is not a regular file, and a log is read several times: write it into a file".to_owned();
            return Err(LogError::Unusable { file: name, why });
        }
        match BagFile::open(path)? {
            Some(file) => {
                let bag = Bag::open(&name, vec![file], choice, Vec::new())?;
                Ok(Self { format: Format::Bag(bag) })
            }
            None => {
                let log = CarmenLog::open(&name, Bytes::File(path.to_owned()))?;
                Ok(Self { format: Format::Carmen(log) })
            }
        }
    }

    /// What the log contains, and what was repaired.
    pub fn summary(&self) -> &LogSummary {
        match &self.format {
            Format::Carmen(log) => log.summary(),
            Format::Bag(bag) => bag.summary(),
        }
    }

    /// The readings in the order of their times, from the first on. Times are since the first reading. The poses are those of
    /// the odometry, interpolated to the end of the scan, and begin at the origin.
    ///
    /// # Errors
    ///
    /// When the file can no longer be opened.
    pub fn readings(&self) -> Result<Readings, LogError> {
        let source = match &self.format {
            Format::Carmen(log) => Source::Carmen(log.readings()?),
            Format::Bag(bag) => Source::Bag(bag.readings()),
        };
        Ok(Readings { source })
    }

    /// A number that is another one for another content, and the same for the same content under another name or with another
    /// compression of the file: XXH3 with 128 bits. The log is read once for it.
    ///
    /// # Errors
    ///
    /// When the file can no longer be read.
    pub fn content_hash(&self) -> Result<u128, LogError> {
        match &self.format {
            Format::Carmen(log) => log.content_hash(),
            Format::Bag(bag) => bag.content_hash(),
        }
    }

    /// The poses of the laser of an earlier estimation, one per reading, for comparison only: those in the FLASER lines
    /// of a CARMEN log (in a log that is not *corrected*, they are those of the odometry). `None` for bags.
    ///
    /// # Errors
    ///
    /// As for [`Log::open`].
    pub fn reference_poses(&self) -> Result<Option<Vec<Option<Isometry2<f64>>>>, LogError> {
        match &self.format {
            Format::Carmen(log) => log.reference_poses().map(Some),
            Format::Bag(_) => Ok(None),
        }
    }
}

/// The readings of a log, one after the other. After an error, there are no more.
pub struct Readings {
    source: Source,
}

enum Source {
    Carmen(carmen::Readings),
    Bag(bag::Readings),
}

impl Iterator for Readings {
    type Item = Result<LaserReading, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        match &mut self.source {
            Source::Carmen(readings) => readings.next(),
            Source::Bag(readings) => readings.next(),
        }
    }
}
