//! Sessions of the node: a state that goes on, and a clock that starts anew.

use super::CuriousNode;
use crate::link::Link;
use crate::message::Time;
use interfaces::LaserReading;
use robot::Session;

/// The time between two sessions whose clocks cannot be compared, s.
const RESTART_GAP_S: f64 = 1.0;
/// A longer time between two sessions is that between a simulated clock and one that counts from 1970, s: ten years.
const OTHER_CLOCK_S: f64 = 3.2e8;

impl<L: Link> CuriousNode<L> {
    /// The reading with the time that the map counts.
    pub(super) fn in_session(
        &mut self,
        mut reading: LaserReading,
        stamp: Time,
        is_restart: bool,
    ) -> LaserReading {
        let first_s = *self.first_s.get_or_insert(reading.time_s);
        reading.time_s -= first_s;
        reading.velocities.iter_mut().for_each(|sample| sample.time_s -= first_s);
        let gap_s = match self.continued.take() {
            Some(last) => Some(self.gap_s(last, stamp)),
            None => is_restart.then_some(RESTART_GAP_S),
        };
        if gap_s.is_some() {
            self.settle();
            let localization = self.localization.as_mut();
            self.session = Session::next(localization, &mut self.mapper, reading.time_s, gap_s);
        }
        self.session.shifted(reading)
    }

    /// The time since the last reading of the state that was loaded, s.
    fn gap_s(&mut self, last: Time, stamp: Time) -> f64 {
        let gap_s = stamp.ns().saturating_sub(last.ns()) as f64 * 1e-9;
        if gap_s > OTHER_CLOCK_S {
            self.notes.say(&format!(
                "the state ends at {:.0} s by its clock, and the scans begin at {:.0} s by theirs: one of the two is simulated, \
                 and the time between them counts as {RESTART_GAP_S} s",
                last.ns() as f64 * 1e-9,
                stamp.ns() as f64 * 1e-9
            ));
            return RESTART_GAP_S;
        }
        // A simulation that starts anew is earlier.
        gap_s.max(RESTART_GAP_S)
    }

    /// Waits for the map that is being learned again.
    pub(super) fn settle(&mut self) {
        if !self.localization.is_settled() {
            self.notes.say("waiting for the map that a closed loop has corrected");
            self.localization.settle(&mut self.mapper);
            self.maps.repeat();
            self.pilot.forget_map();
            self.say_switches();
        }
    }

    /// Says with which readings corrected maps have replaced the old ones.
    pub(super) fn say_switches(&mut self) {
        let switches = self.localization.switches();
        if switches.len() > self.switches {
            self.switches = switches.len();
            let readings: Vec<String> = switches.iter().map(usize::to_string).collect();
            let readings = readings.join(",");
            self.notes
                .say(&format!("the same readings with `--switch-at {readings}` repeat this run so far"));
        }
    }
}
