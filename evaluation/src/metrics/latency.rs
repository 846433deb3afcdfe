use super::beams::Beams;
use interfaces::{CellState, Event, GroundTruth, LaserReading, TrueState};
use mapper::Mapper;
use nalgebra::Isometry2;
use serde::Serialize;
use std::collections::BTreeMap;

/// The delays of one kind of change: the time until the map follows a true change that a beam has shown.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Delays {
    /// The number of changes that a beam showed while the map had the old state.
    pub shown: usize,
    /// The share of these changes that the map did not follow before the cell changed back. Changes that are still
    /// open at the end of the run are not counted.
    pub never_noticed: f64,
    /// The median time from the first beam that shows the change to the change of the map, s.
    pub median_s: Option<f64>,
    /// The time within which the map followed 95 % of these changes, s.
    pub p95_s: Option<f64>,
}

/// A true change of a cell. It begins with the end of the old state.
#[derive(Clone, Copy, Debug)]
struct Open {
    event: Event,
    /// Whether the new state was reached. A cell that becomes only partly covered does not count.
    is_complete: bool,
    /// Whether the new state is ending again: a beam now shows the end of the new state.
    is_ending: bool,
    /// The time at which a beam first showed the change, s.
    shown_s: Option<f64>,
    /// The time at which the map had the new state, s.
    noticed_s: Option<f64>,
}

/// Measures the delay between a change that a laser shows and the change of the map.
#[derive(Clone, Debug, Default)]
pub struct Latency {
    open: BTreeMap<usize, Open>,
    delays_s: [Vec<f64>; 2],
    missed: [usize; 2],
}

const EVENTS: [Event; 2] = [Event::Block, Event::Free];

impl Latency {
    /// Measures one tick: the true changes since the last tick, what `reading` shows from the true pose of the
    /// `laser`, and the present state of the map.
    pub fn observe(
        &mut self,
        truth: &impl GroundTruth,
        mapper: &Mapper,
        reading: &LaserReading,
        laser: &Isometry2<f64>,
    ) {
        let frame = truth.frame();
        for change in truth.changes() {
            let Some(index) = frame.index(change.cell) else { continue };
            let mapped = mapper.states().cells()[index];
            match (change.before, change.after) {
                // A body arrives; the cell can be partly covered at first.
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
        // A free event is finished when the map has followed it; a block event must also become complete.
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

    /// Counts the change of a cell whose new state has ended, or is known.
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
