//! How soon the map follows a change that a beam has shown.

use interfaces::TrueState;
use interfaces::{Cell, CellState, Event, GridFrame, LaserReading};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};
use serde::Serialize;
use sim::physics::Truth;
use std::collections::BTreeMap;

/// The delays of one kind of change.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Delays {
    /// Changes that were shown, and whose cell the map had the old way.
    pub shown: usize,
    /// Of these, the share that the map never followed before the cell changed back. Changes that
    /// are still open when the run ends are not counted.
    pub never_noticed: f64,
    /// Median time from the first beam that shows the change to the map's, s.
    pub median_s: Option<f64>,
    /// The time within which 95 % were followed, s.
    pub p95_s: Option<f64>,
}

/// A true change of a cell, from when the old state ends.
#[derive(Clone, Copy, Debug)]
struct Open {
    event: Event,
    /// Whether the new state is complete: a cell that is only ever covered in part counts for nothing.
    is_complete: bool,
    /// Whether the new state is ending again: what is shown now shows the end.
    is_ending: bool,
    /// When a beam first showed it, s.
    shown_s: Option<f64>,
    /// When the map had it, s.
    noticed_s: Option<f64>,
}

/// Watches the truth and the map side by side.
#[derive(Clone, Debug, Default)]
pub struct Latency {
    open: BTreeMap<usize, Open>,
    delays_s: [Vec<f64>; 2],
    missed: [usize; 2],
}

const EVENTS: [Event; 2] = [Event::Block, Event::Free];

impl Latency {
    /// Looks at one tick: what truly changed since the last, what `reading` shows from the laser's
    /// true pose, and what the map says now.
    pub fn watch(&mut self, truth: &Truth, mapper: &Mapper, reading: &LaserReading, laser: &Isometry2<f64>) {
        let frame = truth.frame();
        for change in truth.changes() {
            let Some(index) = frame.index(change.cell) else { continue };
            let mapped = mapper.states().cells()[index];
            match (change.before, change.after) {
                // Something comes; the cell is covered in part at first.
                (TrueState::Free, _) => {
                    self.close(index);
                    let is_complete = change.after == TrueState::Blocked;
                    self.start(index, Event::Block, is_complete, mapped == CellState::Free);
                }
                (_, TrueState::Blocked) => {
                    if let Some(open) = self.open.get_mut(&index).filter(|open| open.event == Event::Block) {
                        (open.is_complete, open.is_ending) = (true, false);
                    }
                }
                (_, TrueState::PartlyCovered) => {
                    if let Some(open) = self.open.get_mut(&index) {
                        open.is_ending = true;
                    }
                }
                (_, TrueState::Free) => {
                    self.close(index);
                    self.start(index, Event::Free, true, mapped == CellState::Blocked);
                }
            }
        }
        let beams = Beams { reading, laser, frame };
        for (&index, open) in &mut self.open {
            let can_show = open.shown_s.is_none() && !open.is_ending;
            if can_show && beams.shows(frame.cell(index), open.event) {
                open.shown_s = Some(reading.time_s);
            }
            let after = if open.event == Event::Block { CellState::Blocked } else { CellState::Free };
            if open.noticed_s.is_none() && mapper.states().cells()[index] == after {
                open.noticed_s = Some(reading.time_s);
            }
        }
        // A free event that the map has is done with; a block event still has to prove complete.
        let done = |open: &Open| open.noticed_s.is_some() && open.event == Event::Free;
        let noticed: Vec<usize> = self.open.iter().filter(|(_, open)| done(open)).map(|(&i, _)| i).collect();
        noticed.into_iter().for_each(|index| self.close(index));
    }

    fn start(&mut self, index: usize, event: Event, is_complete: bool, map_is_old: bool) {
        if map_is_old {
            let (shown_s, noticed_s) = (None, None);
            self.open.insert(index, Open { event, is_complete, is_ending: false, shown_s, noticed_s });
        }
    }

    /// The new state of a cell is over, or known: counts it.
    fn close(&mut self, index: usize) {
        if let Some(Open { event, is_complete: true, shown_s: Some(shown_s), noticed_s, .. }) =
            self.open.remove(&index)
        {
            match noticed_s {
                Some(noticed_s) => self.delays_s[event as usize].push((noticed_s - shown_s).max(0.0)),
                None => self.missed[event as usize] += 1,
            }
        }
    }

    /// The delays of block events and of free events so far.
    pub fn delays(&self) -> [Delays; 2] {
        EVENTS.map(|event| {
            let mut delays_s = self.delays_s[event as usize].clone();
            delays_s.sort_unstable_by(f64::total_cmp);
            let missed = self.missed[event as usize];
            let shown = delays_s.len() + missed;
            let quantile = |share: f64| {
                delays_s.get((share * delays_s.len().saturating_sub(1) as f64) as usize).copied()
            };
            Delays {
                shown,
                never_noticed: missed as f64 / shown.max(1) as f64,
                median_s: quantile(0.5),
                p95_s: quantile(0.95),
            }
        })
    }
}

/// A scan, to ask what it shows of a cell.
pub(super) struct Beams<'a> {
    pub(super) reading: &'a LaserReading,
    pub(super) laser: &'a Isometry2<f64>,
    pub(super) frame: &'a GridFrame,
}

impl Beams<'_> {
    /// Whether a beam shows the event: it ends in the cell (block), or passes through the middle
    /// half of the cell and beyond it (free).
    pub(super) fn shows(&self, cell: Cell, event: Event) -> bool {
        let scan = &self.reading.scan;
        let (middle, side_m) = (self.frame.center(cell), self.frame.resolution_m());
        let toward = self.laser.inverse_transform_point(&middle);
        let distance_m = toward.coords.norm();
        // The beams that can touch the cell lie around the direction to its middle.
        let half_rad = (side_m / distance_m.max(side_m)).min(1.0);
        let beam = interfaces::wrap_rad(libm::atan2(toward.y, toward.x) - scan.angle_min_rad);
        let (first, last) = (beam - half_rad, beam + half_rad);
        let place = |angle_rad: f64| (angle_rad / scan.angle_increment_rad).ceil() as i64;
        (place(first)..place(last)).any(|beam| {
            let index = if scan.is_full_turn() {
                beam.rem_euclid(scan.ranges_m.len() as i64) as usize
            } else {
                beam as usize
            };
            scan.ranges_m.get(index).is_some_and(|&range_m| {
                let along = self.laser.rotation * interfaces::rotation(scan.angle_rad(index));
                match event {
                    Event::Block => {
                        // A hair behind the surface: one on a border belongs to the solid cell.
                        let end = Point2::from(self.laser.translation.vector)
                            + along * nalgebra::Vector2::new(f64::from(range_m) + 1e-3, 0.0);
                        range_m.is_finite() && self.frame.cell_at(&end) == cell
                    }
                    Event::Free => {
                        let to = middle - Point2::from(self.laser.translation.vector);
                        let off_m = (along.inverse() * to).y.abs();
                        off_m < side_m / 4.0 && f64::from(range_m) > distance_m + side_m
                    }
                }
            })
        })
    }
}
