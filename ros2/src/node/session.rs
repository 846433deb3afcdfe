//! Sessions of the node: a state that goes on, and a clock that starts anew.

use super::CuriousNode;
use crate::link::Link;
use crate::message::Time;
use interfaces::LaserReading;

/// The time between two sessions whose clocks cannot be compared, s.
const RESTART_GAP_S: f64 = 1.0;
/// A longer time between two sessions is that between a simulated clock and one that counts from 1970, s: ten years.
const OTHER_CLOCK_S: f64 = 3.2e8;

impl<L: Link> CuriousNode<L> {
    /// Begins a session with a reading, where the clock of the robot or a state that was loaded demands it.
    pub(super) fn begin_session(&mut self, reading: &LaserReading, stamp: Time, is_restart: bool) {
        let gap_s = match self.continued.take() {
            Some(last) => Some(self.gap_s(last, stamp)),
            None => is_restart.then_some(RESTART_GAP_S),
        };
        if gap_s.is_some() {
            self.settle();
            self.robot.begin_session(reading.time_s, gap_s);
        } else if self.last.is_none() {
            self.robot.session_mut().offset_s = -reading.time_s;
        }
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
        if !self.robot.is_settled() {
            self.notes.say("waiting for the map that a closed loop has corrected");
            self.robot.settle();
            self.published.maps.repeat();
            self.say_switches();
        }
    }

    /// Says with which readings corrected maps have replaced the old ones.
    pub(super) fn say_switches(&mut self) {
        let switches = self.robot.localization().switches();
        if switches.len() > self.published.switches {
            self.published.switches = switches.len();
            let readings: Vec<String> = switches.iter().map(usize::to_string).collect();
            let readings = readings.join(",");
            self.notes
                .say(&format!("the same readings with `--switch-at {readings}` repeat this run so far"));
        }
    }
}
