//! A log of any format.

use crate::error::LogError;
use crate::summary::LogSummary;
use interfaces::LaserReading;
use nalgebra::Isometry2;
use std::fmt::Debug;
use std::io;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread::{Builder, JoinHandle};

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
        let times_s = self.times_s.clone();
        let raw: Box<dyn RawReadings + Send> = match ReadAhead::of(self.source.raw_readings()?) {
            Ok(ahead) => Box::new(ahead),
            Err(_) => self.source.raw_readings()?,
        };
        Ok(Readings { raw, times_s, given: 0, has_failed: false })
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
    raw: Box<dyn RawReadings + Send>,
    times_s: Arc<[f64]>,
    given: usize,
    has_failed: bool,
}

impl Iterator for Readings {
    type Item = Result<LaserReading, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.has_failed {
            return None;
        }
        let next = self.raw.next_reading();
        self.has_failed = next.is_err();
        let mut reading = match next.transpose()? {
            Ok(reading) => reading,
            failed => return Some(failed),
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

/// The number of readings that wait at most.
const AHEAD: usize = 64;

type Next = Result<LaserReading, LogError>;

/// Readings that are read on a thread, some ahead: to unpack and to parse a log takes as long as to match its scans.
struct ReadAhead {
    waiting: Receiver<Next>,
    /// `None` after the last reading.
    thread: Option<JoinHandle<()>>,
}

impl ReadAhead {
    /// Begins to read. The thread ends with the last reading, and when nobody waits for the next one.
    ///
    /// # Errors
    ///
    /// When there can be no other thread.
    fn of(mut raw: Box<dyn RawReadings + Send>) -> io::Result<Self> {
        let (to, waiting) = sync_channel(AHEAD);
        let read = move || {
            while let Some(next) = raw.next_reading().transpose() {
                let has_failed = next.is_err();
                if to.send(next).is_err() || has_failed {
                    break;
                }
            }
        };
        let thread = Builder::new().name("log".to_owned()).spawn(read)?;
        Ok(Self { waiting, thread: Some(thread) })
    }
}

impl RawReadings for ReadAhead {
    fn next_reading(&mut self) -> Result<Option<LaserReading>, LogError> {
        if let Ok(next) = self.waiting.recv() {
            return next.map(Some);
        }
        match self.thread.take().map(JoinHandle::join) {
            Some(Err(panic)) => resume_unwind(panic),
            _ => Ok(None),
        }
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
        let mut ahead = ReadAhead::of(Box::new(Some3(0))).unwrap();
        let mut next = || ahead.next_reading().map(|reading| reading.map(|reading| reading.time_s));
        let times_s = [(); 3].map(|()| next().unwrap().unwrap());
        assert_eq!(times_s, [1.0, 2.0, 3.0]);
        assert_eq!(next().unwrap_err().to_string(), "a: it ends");
        assert_eq!(next().unwrap(), None);
    }
}
