//! The states of the localizer and their transitions, in one table, which `docs/localization.md` shows. Events are raised in
//! `map_matcher.rs`, `map_matcher/relocalizing.rs` and `estimating.rs`.

use crate::estimate::PoseState;

/// What the localizer does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
pub(super) enum State {
    /// Follows a certain pose: scans enter the map.
    Tracking,
    /// Follows a pose that is not certain.
    Uncertain,
    /// Follows a pose that may be wrong, until enough viewpoints agree with it.
    Verifying,
    /// Compares found poses.
    Searching,
    /// Has no pose.
    Lost,
}

/// What a scan, or a reading without a useful scan, says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// The scan supports the pose, and fixes it well enough for the map.
    Certain,
    /// The scan supports the pose, but does not fix it well enough for the map.
    Imprecise,
    /// The scan does not support the pose, or the reading has a fault.
    Unsupported,
    /// Less than 70 % of the scan agrees with a map that may not contain the place.
    Contradicted,
    /// No scan has supported the pose for `lost_after_s`.
    TimedOut,
    /// A search has found poses.
    Found,
    /// One of the found poses is left.
    Decided,
    /// None of the found poses is left.
    Exhausted,
    /// Enough viewpoints agree with the pose, or the map is known to contain the place.
    Confirmed,
    /// Too many viewpoints contradict the pose.
    Refuted,
    /// A pose prior says where the robot is.
    Located,
}

use Event::{
    Certain, Confirmed, Contradicted, Decided, Exhausted, Found, Imprecise, Located, Refuted, TimedOut,
    Unsupported,
};
use State::{Lost, Searching, Tracking, Uncertain, Verifying};

/// All transitions. Of all other events, a state stays.
#[rustfmt::skip]
const TRANSITIONS: &[(State, Event, State)] = &[
    (Tracking,  Imprecise,    Uncertain),
    (Tracking,  Unsupported,  Uncertain),
    (Tracking,  Contradicted, Verifying),
    (Uncertain, Certain,      Tracking),
    (Uncertain, Contradicted, Verifying),
    (Uncertain, Found,        Searching),
    (Uncertain, TimedOut,     Lost),
    (Verifying, Confirmed,    Uncertain),
    (Verifying, Refuted,      Lost),
    (Verifying, Found,        Searching),
    (Verifying, TimedOut,     Lost),
    (Searching, Decided,      Verifying),
    (Searching, Exhausted,    Verifying),
    (Searching, Located,      Verifying),
    (Lost,      Found,        Searching),
    (Lost,      Located,      Verifying),
];

impl State {
    /// The state after an event.
    pub(super) fn after(self, event: Event) -> Self {
        let transition = TRANSITIONS.iter().find(|(from, on, _)| (*from, *on) == (self, event));
        transition.map_or(self, |(_, _, to)| *to)
    }

    /// The state that is reported. `is_timed_out`: no scan has supported a pose for `lost_after_s`.
    pub(super) fn reported(self, is_timed_out: bool) -> PoseState {
        match self {
            Tracking => PoseState::Tracking,
            Searching if is_timed_out => PoseState::Lost,
            Uncertain | Verifying | Searching => PoseState::Uncertain,
            Lost => PoseState::Lost,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_shows_the_table() {
        let page = include_str!("../../../docs/localization.md");
        let row = |(from, on, to): &_| format!("| {from:?} | {on:?} | {to:?} |\n");
        let rows: Vec<String> = TRANSITIONS.iter().map(row).collect();
        let table = format!("| state | event | next state |\n|---|---|---|\n{}\n", rows.concat());
        assert!(page.contains(&table), "docs/localization.md must have this table:\n\n{table}");
    }
}
