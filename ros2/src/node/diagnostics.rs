//! What the node says of itself: its sentences, for the log of all nodes (`/rosout`), and how it is.

use super::{BLIND, CuriousNode, NodeReport};
use crate::link::Link;
use crate::message::{DiagnosticStatus, Diagnostics, Log, Message, Time, Topic, header};
use crate::source::ScanCount;
use localizer::PoseState;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// The time between two messages.
const EVERY: Duration = Duration::from_secs(1);
const OK: u8 = 0;
const WARNING: u8 = 1;
const ERROR: u8 = 2;

impl<L: Link> CuriousNode<L> {
    /// The time by the clock of the robot: that of the last reading and the time since it. Before the first reading, it is that of the
    /// computer, or 0 if the clock is simulated.
    pub(super) fn stamp(&self, now: Instant) -> Time {
        let since_ns = |at: Instant| i64::try_from(now.duration_since(at).as_nanos()).unwrap_or(0);
        match self.last {
            Some((stamp, at)) => Time::from_ns(stamp.ns().saturating_add(since_ns(at))),
            None if self.parameters.use_sim_time => Time::default(),
            None => {
                let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
                Time::from_ns(i64::try_from(since_epoch.as_nanos()).unwrap_or(0))
            }
        }
    }

    /// Publishes what was said since the last call.
    pub(super) fn publish_log(&mut self, now: Instant) {
        let unsent = self.notes.take_unsent();
        if unsent.is_empty() {
            return;
        }
        // As rclcpp names a logger.
        let (stamp, name) = (self.stamp(now), self.link.node().trim_start_matches('/').replace('/', "."));
        for (level, msg) in unsent {
            let name = name.clone();
            let log = Log { stamp, level, name, msg, file: String::new(), function: String::new(), line: 0 };
            self.link.send(Topic::Log, Message::Log(log));
        }
    }

    /// Publishes once per second how the node is, for `rqt_robot_monitor` and monitors of fleets.
    pub(super) fn publish_diagnostics(&mut self, now: Instant) {
        if self.published.next_diagnostics.is_some_and(|next| now < next) {
            return;
        }
        self.published.next_diagnostics = Some(now + EVERY);
        let report = self.report();
        let stamp = self.last.map_or(Time::default(), |(stamp, _)| stamp);
        let is_blind = self.last.is_none_or(|(_, at)| now.duration_since(at) >= BLIND);
        let status = match self.is_active() {
            true => vec![localization(self.pose_state, is_blind), scans(&report, is_blind)],
            false => {
                let message = format!("{}: scans are not used", self.state.labelled().label);
                ["localization", "scans"].map(|name| status(name, OK, &message, Vec::new())).to_vec()
            }
        };
        let message = Diagnostics { header: header(stamp, ""), status };
        self.link.send(Topic::Diagnostics, Message::Diagnostics(message));
    }
}

fn status(name: &str, level: u8, message: &str, values: Vec<(String, String)>) -> DiagnosticStatus {
    let name = format!("curious_node: {name}");
    DiagnosticStatus { level, name, message: message.to_owned(), hardware_id: String::new(), values }
}

fn localization(state: PoseState, is_blind: bool) -> DiagnosticStatus {
    let (level, message) = match state {
        _ if is_blind => (WARNING, "no scans: the pose is not followed"),
        PoseState::Tracking => (OK, "tracking: the pose is certain"),
        PoseState::Uncertain => (WARNING, "uncertain: scans do not enter the map"),
        PoseState::Lost => (ERROR, "lost: the pose is searched for"),
    };
    status("localization", level, message, Vec::new())
}

fn scans(report: &NodeReport, is_blind: bool) -> DiagnosticStatus {
    let ScanCount { received, invalid, unplaced, late, other } = report.scans;
    let left_out = invalid + unplaced + late + other;
    let (level, message) = match left_out {
        _ if is_blind => (ERROR, "no scans arrive".to_owned()),
        0 => (OK, "all scans are used".to_owned()),
        _ => (WARNING, format!("{left_out} of {received} scans are left out")),
    };
    let values = [
        ("received", received),
        ("readings", report.readings),
        ("in the map", report.mapped),
        ("not valid", invalid),
        ("without a pose", unplaced),
        ("late", late),
        ("of another laser", other),
        ("longest turn (us)", report.longest_us),
    ];
    let values = values.map(|(name, value)| (name.to_owned(), value.to_string())).to_vec();
    status("scans", level, &message, values)
}
