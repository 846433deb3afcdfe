use crate::Localization;
use interfaces::LaserReading;
use mapper::Mapper;

/// The gap before a session whose distance in time is not known, s: none, but for the step to the next reading.
const UNKNOWN_GAP_S: f64 = 1.0;

/// The readings of one source in a row, and how their times continue those of the sessions before: the time of a map never
/// goes back, though the clock of every source may start anew.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Session {
    /// What is added to the times of the source, s.
    offset_s: f64,
}

impl Session {
    /// Begins another session in a place that was mapped before. The time between the sessions counts as not observed, and
    /// the localization begins without a pose, in the map that it has learned.
    ///
    /// `first_s` is the time of the first reading by the clock of its source. `gap_s` is the time since the last reading of
    /// the session before; `None`: as the clock says if it goes on, else about a second.
    pub fn next<L: Localization<LaserReading> + ?Sized>(
        localization: &mut L,
        mapper: &mut Mapper,
        first_s: f64,
        gap_s: Option<f64>,
    ) -> Self {
        let last_s = mapper.time();
        let start_s = match gap_s {
            Some(gap_s) => last_s + gap_s.max(0.0),
            None if first_s > last_s => first_s,
            None => last_s + UNKNOWN_GAP_S,
        };
        mapper.pause(start_s);
        localization.begin_session();
        Self { offset_s: start_s - first_s }
    }

    /// A session whose source counts its times from another begin: `offset_s` is added to them, s.
    pub fn with_offset(offset_s: f64) -> Self {
        Self { offset_s }
    }

    /// What is added to the times of the source, s.
    pub fn offset_s(&self) -> f64 {
        self.offset_s
    }

    /// A reading of the source, with its times as the map counts them.
    pub fn shifted(&self, mut reading: LaserReading) -> LaserReading {
        reading.time_s += self.offset_s;
        reading.velocities.iter_mut().for_each(|sample| sample.time_s += self.offset_s);
        reading
    }
}
