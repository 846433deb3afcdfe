use interfaces::LaserReading;

/// The gap before a session whose distance in time is not known, s: none, but for the step to the next reading.
const UNKNOWN_GAP_S: f64 = 1.0;

/// The laser was silent between two scans that are farther apart than this number of usual steps: a log with one scan per meter has
/// irregular steps, and is one view nevertheless.
const SILENT_STEPS: f64 = 10.0;

/// The longest time between two readings during which things are in view, s: that for which a body can hide them, `hiding_s`, and
/// longer where readings are rare.
pub fn max_step_s(hiding_s: f64, usual_step_s: f64) -> f64 {
    hiding_s.max(SILENT_STEPS * usual_step_s)
}

/// The readings of one source in a row, and how their times continue those of the sessions before: the time of a map never
/// goes back, though the clock of every source may start anew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Session {
    /// What is added to the times of the source, s.
    pub offset_s: f64,
    /// Between readings that are farther apart, nothing was in view, s.
    pub max_step_s: f64,
}

impl Default for Session {
    fn default() -> Self {
        Self { offset_s: 0.0, max_step_s: f64::INFINITY }
    }
}

impl Session {
    /// The session after one whose last reading was at `last_s`. `first_s` is the time of its first reading by the clock of
    /// its source, `gap_s` the time between both readings; `None`: as the clock says if it goes on, else about a second.
    #[must_use]
    pub fn after(self, last_s: f64, first_s: f64, gap_s: Option<f64>) -> Self {
        let start_s = match gap_s {
            Some(gap_s) => last_s + gap_s.max(0.0),
            None if first_s > last_s => first_s,
            None => last_s + UNKNOWN_GAP_S,
        };
        Self { offset_s: start_s - first_s, ..self }
    }

    /// Gives a reading of the source the times of the map.
    pub fn shift(&self, reading: &mut LaserReading) {
        reading.time_s += self.offset_s;
        reading.velocities.iter_mut().for_each(|sample| sample.time_s += self.offset_s);
    }
}
