//! A log of any format.

use crate::checks::TimedLooks;
use crate::laser_check::LaserCheck;
use crate::summary::{LogError, LogSummary};
use interfaces::LaserReading;
use nalgebra::Isometry2;
use std::fmt::Debug;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread::{Builder, JoinHandle};

/// A log of any format.
#[derive(Clone, Debug)]
pub struct Log {
    source: Arc<dyn Source>,
    summary: LogSummary,
    /// With the times of the readings, repaired, s.
    looks: Arc<TimedLooks>,
    laser_check: Arc<LaserCheck>,
}

/// Readings with their times as written.
pub(crate) trait RawReadings {
    /// The next reading, `None` at the end.
    fn next_reading(&mut self) -> Result<Option<LaserReading>, LogError>;
}

type Raw = Box<dyn RawReadings + Send>;

/// A log of one format, after its inspection.
pub(crate) trait Source: Debug + Send + Sync {
    /// The readings with their times as written, from the first on.
    fn raw_readings(&self) -> Result<Raw, LogError>;
    /// As [`Log::content_hash`].
    fn content_hash(&self) -> Result<u128, LogError>;
    /// As [`Log::reference_poses`].
    fn reference_poses(&self) -> Result<Option<Vec<Option<Isometry2<f64>>>>, LogError> {
        Ok(None)
    }
}

impl Log {
    /// `laser_check` has learned from all readings.
    pub(crate) fn new(
        source: impl Source + 'static,
        looks: TimedLooks,
        mut laser_check: LaserCheck,
        mut summary: LogSummary,
    ) -> Self {
        summary.notes.extend(laser_check.judge());
        Self { source: Arc::new(source), summary, looks: looks.into(), laser_check: Arc::new(laser_check) }
    }

    /// What the log contains, and what was repaired.
    pub fn summary(&self) -> &LogSummary {
        &self.summary
    }

    /// The readings in the order of their times, from the first on. Times are since the first reading. The poses are those of
    /// the odometry, interpolated to the end of the scan, and begin at the origin. Ranges of [parts of the robot](LaserCheck) are
    /// invalid.
    ///
    /// # Errors
    ///
    /// When the file can no longer be opened, and when there can be no other thread.
    pub fn readings(&self) -> Result<Readings, LogError> {
        Readings::new(self.source.raw_readings()?, self.looks.clone(), self.laser_check.clone())
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
        Ok(self.source.reference_poses()?.map(|poses| self.looks.1.of_looks(poses)))
    }
}

/// The number of readings that wait at most.
const AHEAD: usize = 64;

type Next = Result<LaserReading, LogError>;

/// The readings of a log, one after the other. After an error, there are no more. They are read on a thread, some ahead: to
/// unpack and to parse a log takes as long as to match its scans.
pub struct Readings {
    waiting: Receiver<Next>,
    /// `None` after the last reading.
    thread: Option<JoinHandle<()>>,
    timed: Arc<TimedLooks>,
    laser_check: Arc<LaserCheck>,
    given: usize,
}

impl Readings {
    fn new(mut raw: Raw, looks: Arc<TimedLooks>, laser_check: Arc<LaserCheck>) -> Result<Self, LogError> {
        let (to, waiting) = sync_channel(AHEAD);
        let timed = looks.clone();
        // Ends with the last reading, and when nobody waits for the next one.
        let read = move || {
            let all = (0..).map_while(|number| Some((number, raw.next_reading().transpose()?)));
            for (_, next) in all.filter(|(number, next)| next.is_err() || looks.1.is_look(*number)) {
                let has_failed = next.is_err();
                if to.send(next).is_err() || has_failed {
                    break;
                }
            }
        };
        let failed = |why| LogError::Io { file: "the thread that reads a log".to_owned(), why };
        let thread = Some(Builder::new().name("log".to_owned()).spawn(read).map_err(failed)?);
        Ok(Self { waiting, thread, timed, laser_check, given: 0 })
    }
}

impl Iterator for Readings {
    type Item = Next;

    fn next(&mut self) -> Option<Self::Item> {
        let Ok(next) = self.waiting.recv() else {
            if let Some(Err(panic)) = self.thread.take().map(JoinHandle::join) {
                resume_unwind(panic);
            }
            return None;
        };
        let mut reading = match next {
            Ok(reading) => reading,
            failed => return Some(failed),
        };
        // The file can have grown since the inspection.
        let time_s = *self.timed.0.get(self.given)?;
        self.timed.1.clean(&mut reading.scan.ranges_m);
        self.given += 1;
        let shift_s = time_s - reading.time_s;
        reading.velocities.iter_mut().for_each(|sample| sample.time_s += shift_s);
        reading.time_s = time_s;
        self.laser_check.apply(&mut reading);
        Some(Ok(reading))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks::Looks;

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
        let mut readings = Readings::new(
            Box::new(Some3(0)),
            (vec![1.0, 2.0, 3.0, 4.0], Looks::default()).into(),
            Arc::default(),
        )
        .unwrap();
        let times_s: Vec<f64> = (0..3).map(|_| readings.next().unwrap().unwrap().time_s).collect();
        assert_eq!(times_s, [1.0, 2.0, 3.0]);
        assert_eq!(readings.next().unwrap().unwrap_err().to_string(), "a: it ends");
        assert!(readings.next().is_none());
    }
}
