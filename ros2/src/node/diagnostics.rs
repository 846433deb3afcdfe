//! What the node says of itself once per second, for `rqt_robot_monitor` and monitors of fleets.

use super::{BLIND, CuriousNode, NodeReport};
use crate::link::Link;
use crate::message::{DiagnosticStatus, Diagnostics, Message, Time, Topic, header};
use localizer::PoseState;
use std::time::{Duration, Instant};

/// The time between two messages.
const EVERY: Duration = Duration::from_secs(1);
const OK: u8 = 0;
const WARNING: u8 = 1;
const ERROR: u8 = 2;

impl<L: Link> CuriousNode<L> {
    pub(super) fn publish_diagnostics(&mut self, now: Instant) {
        if now < self.published.next_diagnostics {
            return;
        }
        self.published.next_diagnostics = now + EVERY;
        let report = self.report();
        let stamp = self.last.map_or(Time::default(), |(stamp, _)| stamp);
        let is_blind = self.last.is_none_or(|(_, at)| now.duration_since(at) >= BLIND);
        let status = match self.is_active() {
            true => vec![localization(self.pose_state, is_blind), scans(&report, is_blind)],
            false => {
                let message = format!("{}: scans are not used", self.state.labelled().label);
                vec![
                    status("localization", OK, &message, Vec::new()),
                    status("scans", OK, &message, Vec::new()),
                ]
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
    let [invalid, unplaced, late, other] = report.unused;
    let left_out = invalid + unplaced + late + other;
    let (level, message) = match left_out {
        _ if is_blind => (ERROR, "no scans arrive".to_owned()),
        0 => (OK, "all scans are used".to_owned()),
        _ => (WARNING, format!("{left_out} of {} scans are left out", report.received)),
    };
    let values = [
        ("received", report.received),
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
