//! Readings that are read on a thread, some ahead: to unpack and to parse a log takes as long as to match its scans.

use crate::error::LogError;
use crate::log::RawReadings;
use interfaces::LaserReading;
use std::io;
use std::panic::resume_unwind;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread::{Builder, JoinHandle};

/// The number of readings that wait at most.
const AHEAD: usize = 64;

type Next = Result<LaserReading, LogError>;

/// The readings of a thread.
pub(crate) struct ReadAhead {
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
    pub(crate) fn of(mut raw: Box<dyn RawReadings + Send>) -> io::Result<Self> {
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
            let scan = interfaces::Scan {
                angle_min_rad: 0.0,
                angle_increment_rad: 0.1,
                range_min_m: 0.0,
                range_max_m: 10.0,
                sweep_s: 0.0,
                ranges_m: vec![1.0; 3],
            };
            Ok(Some(LaserReading {
                time_s: f64::from(self.0),
                pose: interfaces::pose(0.0, 0.0, 0.0),
                twist: interfaces::Twist::STOP,
                velocities: Vec::new(),
                mount: interfaces::pose(0.0, 0.0, 0.0),
                scan,
            }))
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
