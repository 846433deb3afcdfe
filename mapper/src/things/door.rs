//! A door, and what looks at it say.

use super::segment::Segment;
use crate::Growth;
use crate::change::{CellMap, CellStatistics, RateDistribution};
use crate::clock::{Clock, Dates, Look};
use crate::derived::CredibleInterval;
use interfaces::{CellState, GridFrame};
use nalgebra::Point2;

/// A door is in view while at least this share of the cells of its closed leaf is.
const IN_VIEW: f64 = 0.4;
/// The share of the seen cells of the closed leaf that is blocked: at least this if the door is closed, and at most this if it
/// is open. A person in the doorway blocks about half of it.
const CLOSED_FROM: f64 = 0.75;
const OPEN_TO: f64 = 0.3;
/// Looks say that a door has moved when they have agreed for this time, s.
const SURE_S: f64 = 1.0;
/// A door stays in view between two looks that are at most this far apart, s: people pass between robot and door.
const MAX_GAP_S: f64 = 2.5;
/// The clock of a door gets a look after this time without a change, s.
const LOOK_S: f64 = 1.0;
/// The number of openings before any look: Jeffreys' prior of a rate.
const PRIOR_OPENINGS: f64 = 0.5;
const HOUR_S: f64 = 3600.0;

/// How a leaf opens.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub enum Leaf {
    /// The leaf turns about a hinge.
    Hinged {
        /// The hinge, m: the end of the closed leaf that stays.
        hinge: Point2<f64>,
        /// The length of the leaf, m.
        length_m: f64,
        /// The heading from the hinge along the closed leaf, rad.
        closed_rad: f64,
        /// The heading from the hinge along the open leaf, rad.
        open_rad: f64,
    },
    /// The open leaf was never seen: the leaf slides into the wall, or turns to where the robot does not look.
    Sliding,
}

/// A door.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Door {
    /// The closed leaf, from wall to wall.
    pub closed: Segment,
    /// How it opens.
    pub leaf: Leaf,
    /// Whether it was open at the last look; `None` before any look.
    pub is_open: Option<bool>,
    /// The time of the last look, s.
    pub last_seen_s: f64,
    /// What was counted so far.
    pub statistics: DoorStatistics,
    /// When it is open.
    pub clock: Clock,
    watch: Watch,
}

/// What was counted of a door.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct DoorStatistics {
    /// Openings in view.
    pub opened: u32,
    /// Closings in view.
    pub closed: u32,
    /// Openings that were found after a gap in the view.
    pub opened_after_gap: u32,
    /// Closings that were found after a gap in the view.
    pub closed_after_gap: u32,
    /// The time in view, s.
    pub in_view_s: f64,
}

impl DoorStatistics {
    /// The distribution of the number of openings per hour; `None` if it was never in view. A door closes as often as it opens:
    /// both count.
    pub fn openings_per_hour(&self) -> Option<RateDistribution> {
        let events = PRIOR_OPENINGS + 0.5 * f64::from(self.opened + self.closed);
        let time = self.in_view_s / HOUR_S;
        (time > 0.0).then_some(RateDistribution { events, time })
    }

    /// The mean number of openings per second.
    pub(super) fn openings_per_s(&self) -> Option<f64> {
        Some(self.openings_per_hour()?.mean() / HOUR_S)
    }

    /// The interval that contains the number of openings per hour with the probability `mass`.
    pub fn interval_of_openings_per_hour(&self, mass: f64) -> Option<(f64, f64)> {
        Some(CredibleInterval::new(mass).of_gamma(self.openings_per_hour()?))
    }
}

/// What is needed to count.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
struct Watch {
    /// The cells of the closed leaf.
    closed: Vec<u32>,
    /// Since when looks say that the door has moved, s.
    moved_s: Option<f64>,
    /// Whether the door has been in view since the last look that showed `is_open`.
    is_unbroken: bool,
    /// The last look that the clock got, s.
    clock_s: Option<f64>,
}

impl Door {
    pub(super) fn new(closed: Segment, found_s: f64) -> Self {
        Self {
            closed,
            leaf: Leaf::Sliding,
            is_open: None,
            last_seen_s: found_s,
            statistics: DoorStatistics::default(),
            clock: Clock::default(),
            watch: Watch::default(),
        }
    }

    /// Sets the place of the door, with the number of the hinge and the open leaf if they are known. Returns its cells.
    pub(super) fn place(
        &mut self,
        closed: Segment,
        open: Option<(usize, Segment)>,
        frame: &GridFrame,
    ) -> Vec<u32> {
        self.closed = closed;
        self.watch.closed = closed.cells(frame);
        let Some((hinge, open)) = open else { return self.watch.closed.clone() };
        let [hinge, end] = [hinge, 1 - hinge].map(|end| closed.ends[end]);
        let [closed_rad, open_rad] = [end - hinge, open.along()].map(|along| libm::atan2(along.y, along.x));
        let length_m = closed.length_m();
        self.leaf = Leaf::Hinged { hinge, length_m, closed_rad, open_rad };
        let turn_rad = interfaces::wrap_rad(open_rad - closed_rad);
        let steps = (2.0 * length_m * turn_rad.abs() / frame.resolution_m()).ceil();
        let heading_rad = |step: usize| closed_rad + turn_rad * step as f64 / steps;
        let leaves = (0..=steps as usize).map(|step| Segment::from(hinge, heading_rad(step), length_m));
        let mut cells: Vec<u32> = leaves.flat_map(|leaf| leaf.cells(frame)).collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    }

    /// Counts what was in view before the door was found, as the median over the cells of the closed leaf. People change these
    /// cells as well, so that the lines found so far bound the numbers.
    pub(super) fn count_earlier(&mut self, lines: [u32; 2], cells: &CellMap) {
        let seen: Vec<_> = self.watch.closed.iter().map(|&cell| cells.statistics(cell as usize)).collect();
        let median = |of: fn(&CellStatistics) -> u32| median(seen.iter().map(of).collect());
        let [opened, closed] = [median(|cell| cell.free_events), median(|cell| cell.block_events)];
        let [opened, closed] = [opened.min(lines[0]), closed.min(lines[1])];
        self.statistics = DoorStatistics {
            opened,
            closed,
            opened_after_gap: median(|cell| cell.free_events_after_gap).min(lines[0] - opened),
            closed_after_gap: median(|cell| cell.block_events_after_gap).min(lines[1] - closed),
            in_view_s: f64::from(median(|cell| cell.observed() as u32)),
        };
    }

    /// Counts, from what the open reading shows of the door.
    pub(super) fn observe(&mut self, cells: &CellMap, dates: Dates) {
        let Some(blocked) = blocked_share(&self.watch.closed, cells) else { return };
        let now_s = cells.time();
        self.pass_to(now_s);
        let is_open = match blocked {
            CLOSED_FROM.. => false,
            ..OPEN_TO => true,
            _ => return,
        };
        if self.is_open.is_none_or(|was_open| was_open == is_open) {
            self.confirm(now_s, is_open, dates);
        } else {
            let moved_s = *self.watch.moved_s.get_or_insert(now_s);
            if now_s - moved_s >= SURE_S {
                self.count(is_open);
                self.tell_clock(moved_s, is_open, dates);
            }
        }
    }

    /// The door is in view.
    fn pass_to(&mut self, now_s: f64) {
        let gap_s = now_s - self.last_seen_s;
        let is_unbroken = gap_s <= MAX_GAP_S;
        self.statistics.in_view_s += if is_unbroken { gap_s } else { 0.0 };
        self.watch.is_unbroken &= is_unbroken;
        self.last_seen_s = now_s;
    }

    /// The door is as it was.
    fn confirm(&mut self, now_s: f64, is_open: bool, dates: Dates) {
        self.is_open = Some(is_open);
        (self.watch.is_unbroken, self.watch.moved_s) = (true, None);
        if self.watch.clock_s.is_none_or(|last_s| now_s - last_s >= LOOK_S) {
            self.tell_clock(now_s, is_open, dates);
        }
    }

    /// The time of the last look that showed whether the door was open, and whether it was, to [`LOOK_S`].
    pub(super) fn last_look(&self) -> Option<(f64, bool)> {
        self.watch.clock_s.zip(self.is_open)
    }

    pub(super) fn grow(&mut self, growth: &Growth) {
        self.watch.closed.iter_mut().for_each(|cell| *cell = growth.index(*cell as usize) as u32);
    }

    fn tell_clock(&mut self, time_s: f64, is_open: bool, dates: Dates) {
        self.watch.clock_s = Some(time_s);
        dates.observe(&mut self.clock, Look { time_s, is_blocked: is_open });
    }

    fn count(&mut self, is_open: bool) {
        let statistics = &mut self.statistics;
        let count = match (is_open, self.watch.is_unbroken) {
            (true, true) => &mut statistics.opened,
            (false, true) => &mut statistics.closed,
            (true, false) => &mut statistics.opened_after_gap,
            (false, false) => &mut statistics.closed_after_gap,
        };
        *count += 1;
        self.is_open = Some(is_open);
        (self.watch.is_unbroken, self.watch.moved_s) = (true, None);
    }
}

fn median(mut values: Vec<u32>) -> u32 {
    values.sort_unstable();
    values.get(values.len() / 2).copied().unwrap_or(0)
}

/// The share of the cells in view that are blocked; `None` if too few cells are in view.
fn blocked_share(leaf: &[u32], cells: &CellMap) -> Option<f64> {
    let (mut seen, mut blocked) = (0u32, 0u32);
    for index in leaf.iter().map(|&cell| cell as usize).filter(|&index| cells.is_seen_now(index)) {
        seen += 1;
        blocked += u32::from(cells.state(index) == CellState::Blocked);
    }
    let is_in_view = seen > 0 && f64::from(seen) >= IN_VIEW * leaf.len() as f64;
    is_in_view.then(|| f64::from(blocked) / f64::from(seen))
}
