//! A door, and what looks at it say.

use super::OfCell;
use super::presence::{Parts, Presence};
use super::segment::Segment;
use crate::change::{CellMap, Evidence, Waiting};
use crate::clock::{Clock, Dates, Look};
use interfaces::{CellState, GridFrame};
use nalgebra::Point2;
use std::cmp::Reverse;

/// A door is in view while at least this share of the cells of its closed leaf is.
const IN_VIEW: f64 = 0.4;
/// The share of the seen cells of the closed leaf that is blocked: at least this if the door is closed, and at most this if it
/// is open. A person in the doorway blocks about half of it.
const CLOSED_FROM: f64 = 0.75;
const OPEN_TO: f64 = 0.3;
/// The clock of a door gets a look after this time without a change, s.
const LOOK_S: f64 = 1.0;
/// A cell counts as free in this number of looks before the first one.
const FREE_LOOKS: f64 = 6.0;

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
    /// Its number among doors, which it keeps over all sessions.
    pub id: u32,
    /// The time at which it was found, s.
    pub found_s: f64,
    /// The cells that the leaf sweeps, as far as is known, by their index in ascending order.
    pub cells: Vec<u32>,
    /// The closed leaf, from wall to wall.
    pub closed: Segment,
    /// How it opens.
    pub leaf: Leaf,
    /// When it is open.
    pub clock: Clock,
    /// The cells of the closed leaf.
    closed_cells: Vec<u32>,
    /// Its cells, with the looks at them while the door was open, and while it was closed.
    pub(super) parts: Parts,
    /// The state "there": closed.
    pub(super) presence: Presence,
    /// The last look that the clock got, s.
    clock_s: Option<f64>,
}

impl Door {
    /// A door with this closed leaf. What was seen of it before is that of a cell of this leaf: the one with about as many changes as
    /// lines were found, since people change these cells as well; of several ones, the one with the fewest changes in view, since
    /// the ends of a leaf are seen to change late; and then the one that is known best.
    pub(super) fn new(id: u32, closed: Segment, lines: u32, map: &CellMap) -> Self {
        let closed_cells = closed.cells(map.frame());
        let known = closed_cells.iter().map(|&cell| (map.evidence(cell as usize), cell as usize));
        let best = known.min_by_key(|(evidence, _)| {
            let apart = evidence.changes().abs_diff(lines);
            (apart, evidence.events().iter().sum::<u32>(), Reverse(evidence.known_s() as u64))
        });
        let (evidence, cell) = best.unwrap_or_default();
        let presence =
            Presence::new(map.state(cell) == CellState::Blocked, map.last_seen(cell), evidence, false);
        let (leaf, clock, parts, cells) = (Leaf::Sliding, Clock::default(), Parts::default(), Vec::new());
        Self {
            id,
            found_s: map.time(),
            cells,
            closed,
            leaf,
            clock,
            closed_cells,
            parts,
            presence,
            clock_s: None,
        }
    }

    /// Whether it was open at the last look.
    pub fn is_open(&self) -> bool {
        !self.presence.last_look().0
    }

    /// The time of the last look, s.
    pub fn last_seen_s(&self) -> f64 {
        self.presence.last_look().1
    }

    /// What looks say of how long it stays open (the state "away"), and closed.
    pub fn evidence(&self) -> &Evidence {
        &self.presence.evidence
    }

    /// The number of openings per hour, by all looks: in view, and before and after gaps in the view; and its 90 % credible interval.
    pub fn openings_per_hour(&self) -> (f64, [f64; 2]) {
        self.presence.alone().per_hour()
    }

    /// How long it stays closed if it is closed at this time, s. The hours of the day do not count.
    pub fn waiting(&self, time_s: f64) -> Waiting {
        let (was_closed, last_s) = self.presence.last_look();
        self.presence.alone().waiting(true, was_closed, time_s - last_s)
    }

    /// Sets the place of the door, with the number of the hinge and the open leaf if they are known.
    pub(super) fn place(&mut self, closed: Segment, open: Option<(usize, Segment)>, frame: &GridFrame) {
        self.closed = closed;
        self.closed_cells = closed.cells(frame);
        self.cells = match open {
            Some(open) => self.sweep(open, frame),
            None => self.closed_cells.clone(),
        };
        self.parts.set(&self.cells);
    }

    /// Sets how the leaf opens, and returns the cells that it sweeps.
    fn sweep(&mut self, (hinge, open): (usize, Segment), frame: &GridFrame) -> Vec<u32> {
        let closed = self.closed;
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

    /// What it says of one of its cells; `None` unless the cell was seen with the door open, and with the door closed.
    pub(super) fn of_cell(&self, cell: u32) -> Option<OfCell<'_>> {
        let counts =
            self.parts.counts(cell).filter(|counts| counts.iter().all(|counts| !counts.is_empty()))?;
        let shares = counts.map(|counts| counts.share(0.0, FREE_LOOKS));
        let (presence, clock, cells) = (&self.presence, Some(&self.clock), self.parts.iter().len());
        Some(OfCell { presence, number: self.id, cells, population: None, clock, shares })
    }

    /// Learns from the open reading.
    pub(super) fn observe(&mut self, map: &CellMap, is_doubted: impl Fn(usize) -> bool, dates: Dates) {
        let now_s = map.time();
        let is_closed = match blocked_share(&self.closed_cells, map, &is_doubted) {
            Some(CLOSED_FROM..) => true,
            Some(..OPEN_TO) => false,
            _ => return,
        };
        let is_new = is_closed != self.presence.is_there;
        let is_due = is_new || self.clock_s.is_none_or(|last_s| now_s - last_s >= LOOK_S);
        if self.presence.see(now_s, is_closed) && is_due {
            self.clock_s = Some(now_s);
            dates.observe(&mut self.clock, Look { time_s: now_s, is_blocked: !is_closed });
            self.parts.learn(is_closed, map, is_doubted);
        }
    }

    pub(super) fn each_cell(&mut self, f: &mut dyn FnMut(&mut u32)) {
        self.closed_cells.iter_mut().chain(&mut self.cells).for_each(&mut *f);
        self.parts.each_cell(f);
    }
}

/// The share of the cells in view that are blocked; `None` if too few cells are in view.
fn blocked_share(leaf: &[u32], cells: &CellMap, is_doubted: impl Fn(usize) -> bool) -> Option<f64> {
    let (mut seen, mut blocked) = (0u32, 0u32);
    for index in leaf.iter().map(|&cell| cell as usize).filter(|&index| cells.is_seen_now(index)) {
        seen += 1;
        blocked += u32::from((cells.state(index) == CellState::Blocked) != is_doubted(index));
    }
    let is_in_view = seen > 0 && f64::from(seen) >= IN_VIEW * leaf.len() as f64;
    is_in_view.then(|| f64::from(blocked) / f64::from(seen))
}
