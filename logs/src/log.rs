//! A log of any format.

use crate::error::LogError;
use crate::summary::LogSummary;
use interfaces::LaserReading;
use nalgebra::Isometry2;
use std::fmt::Debug;
use std::sync::Arc;

/// A log of any format.
#[derive(Clone, Debug)]
pub struct Log {
    source: Arc<dyn Source>,
    summary: LogSummary,
    /// The times of the readings, repaired, s.
    times_s: Arc<[f64]>,
}

/// Readings with their times as written.
pub(crate) trait RawReadings {
    /// The next reading, `None` at the end.
    fn next_reading(&mut self) -> Result<Option<LaserReading>, LogError>;
}

/// A log of one format, after its inspection.
pub(crate) trait Source: Debug + Send + Sync {
    /// The readings with their times as written, from the first on.
    fn raw_readings(&self) -> Result<Box<dyn RawReadings + Send>, LogError>;
    /// As [`Log::content_hash`].
    fn content_hash(&self) -> Result<u128, LogError>;
    /// As [`Log::reference_poses`].
    fn reference_poses(&self) -> Result<Option<Vec<Option<Isometry2<f64>>>>, LogError> {
        Ok(None)
    }
}

impl Log {
    pub(crate) fn new(source: impl Source + 'static, times_s: Vec<f64>, summary: LogSummary) -> Self {
        Self { source: Arc::new(source), summary, times_s: times_s.into() }
    }

    /// What the log contains, and what was repaired.
    pub fn summary(&self) -> &LogSummary {
        &self.summary
    }

    /// The readings in the order of their times, from the first on. Times are since the first reading. The poses are those of
    /// the odometry, interpolated to the end of the scan, and begin at the origin.
    ///
    /// # Errors
    ///
    /// When the file can no longer be opened.
    pub fn readings(&self) -> Result<Readings, LogError> {
        let raw = Some(self.source.raw_readings()?);
        Ok(Readings { raw, times_s: self.times_s.clone(), given: 0 })
    }

    /// Content hash (XXH3-128): it depends neither on the name nor on the compression of the file. The log is read once for it.
    ///
    /// # Errors
    ///
    /// When the file can no longer be read.
    pub fn content_hash(&self) -> Result<u128, LogError> {
        self.source.content_hash()
    }

    /// The poses of the laser of an earlier estimation, one per reading, for comparison only: those in the FLASER lines
    /// of a CARMEN log (in a log that is not *corrected*, they are those of the odometry). `None` for bags.
    ///
    /// # Errors
    ///
    /// As for [`Log::open`].
    pub fn reference_poses(&self) -> Result<Option<Vec<Option<Isometry2<f64>>>>, LogError> {
        self.source.reference_poses()
    }
}

/// The readings of a log, one after the other. After an error, there are no more.
pub struct Readings {
    /// `None` after an error.
    raw: Option<Box<dyn RawReadings + Send>>,
    times_s: Arc<[f64]>,
    given: usize,
}

impl Iterator for Readings {
    type Item = Result<LaserReading, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        let mut reading = match self.raw.as_mut()?.next_reading().transpose()? {
            Ok(reading) => reading,
            failed => {
                self.raw = None;
                return Some(failed);
            }
        };
        // The file can have grown since the inspection.
        let time_s = *self.times_s.get(self.given)?;
        self.given += 1;
        let shift_s = time_s - reading.time_s;
        reading.velocities.iter_mut().for_each(|sample| sample.time_s += shift_s);
        reading.time_s = time_s;
        Some(Ok(reading))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings at these times, then an error.
    struct Some3(u8);

    impl RawReadings for Some3 {
        fn next_reading(&mut self) -> Result<Option<LaserReading>, LogError> {
            self.0 += 1;
            if self.0 > 3 {
                return Err(LogError::Unusable { file: "a".to_owned(), why: "it ends".to_owned() });
            }
            Ok(Some(LaserReading { time_s: f64::from(self.0), ..LaserReading::default() }))
        }
    }

    #[test]
    fn readings_come_in_their_order_and_end_with_an_error() {
        let times_s = vec![1.0, 2.0, 3.0, 4.0].into();
        let mut readings = Readings { raw: Some(Box::new(Some3(0))), times_s, given: 0 };
        let times_s: Vec<f64> = (0..3).map(|_| readings.next().unwrap().unwrap().time_s).collect();
        assert_eq!(times_s, [1.0, 2.0, 3.0]);
        assert_eq!(readings.next().unwrap().unwrap_err().to_string(), "a: it ends");
        assert!(readings.next().is_none());
    }
}
