use super::beams::Beams;
use super::statistics::Counts;
use interfaces::{CellState, Event, GridFrame, GroundTruth, LaserReading, TrueState};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};
use serde::Serialize;
use std::collections::BTreeMap;

/// The delays of one kind of change: the time until the map follows a true change that a beam has shown.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Delays {
    /// The number of changes that a beam showed while the map had the old state.
    pub shown: usize,
    /// The share of these changes that the map did not follow before the cell changed back. A change that the map has not
    /// followed yet, of a cell that has not changed back yet, is not counted.
    pub never_noticed: f64,
    /// The time within which the map followed half of these changes, from the first beam that shows the change, s. A delay
    /// of more than an hour counts as an hour. `None` if the map did not follow half of them.
    pub median_s: Option<f64>,
    /// The time within which the map followed 95 % of these changes, s, with the same limit. `None` if the map did not
    /// follow 95 % of them.
    pub p95_s: Option<f64>,
}

/// A true change of a cell. It begins with the end of the old state.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
struct Open {
    /// The center of the cell, m.
    center: Point2<f64>,
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

impl Open {
    /// Whether nothing that follows changes the result: the map has followed a free event; a block event is complete, and a
    /// beam has shown it, too.
    fn is_finished(&self) -> bool {
        let is_counted = self.is_complete && self.shown_s.is_some();
        self.noticed_s.is_some() && (self.event == Event::Free || is_counted)
    }
}

/// Measures the delay between a change that a laser shows and the change of the map.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub struct Latency {
    /// By the index of the cell.
    open: BTreeMap<usize, Open>,
    noticed: [DelayCounts; 2],
    missed: [usize; 2],
}

/// Delays longer than this count as this long, s: the number of different delays is bounded.
const MAX_DELAY_S: u32 = 3600;

/// How often each delay occurred, s. Delays are multiples of the time between two readings, so that few of them differ; in
/// whole microseconds, since the differences of two times are not exact.
type DelayCounts = Counts<1_000_000, MAX_DELAY_S>;

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
                    self.start(frame, index, Event::Block, is_complete, mapped == CellState::Free);
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
                    self.start(frame, index, Event::Free, true, mapped == CellState::Blocked);
                }
            }
        }
        let beams = Beams::new(reading, laser, frame);
        for open in self.open.values_mut().filter(|open| open.shown_s.is_none() && !open.is_ending) {
            if beams.shows(&open.center, open.event) {
                open.shown_s = Some(reading.time_s);
            }
        }
        // A change is open only if the map had the old state: it is noticed when the map changes.
        for index in mapper.transitions().iter().filter_map(|transition| frame.index(transition.cell)) {
            let Some(open) = self.open.get_mut(&index) else { continue };
            let after = if open.event == Event::Block { CellState::Blocked } else { CellState::Free };
            if open.noticed_s.is_none() && mapper.states().cells()[index] == after {
                open.noticed_s = Some(reading.time_s);
            }
        }
        // Not only when the cell changes back: a body that stays counts too.
        let finished = self.open.iter().filter(|(_, open)| open.is_finished()).map(|(index, _)| *index);
        for index in finished.collect::<Vec<_>>() {
            self.close(index);
        }
    }

    fn start(&mut self, frame: &GridFrame, index: usize, event: Event, is_complete: bool, map_is_old: bool) {
        if map_is_old {
            let (center, shown_s, noticed_s) = (frame.center(frame.cell(index)), None, None);
            let open = Open { center, event, is_complete, is_ending: false, shown_s, noticed_s };
            self.open.insert(index, open);
        }
    }

    /// Counts the change of a cell whose new state has ended, or is known.
    fn close(&mut self, index: usize) {
        let closed = self.open.remove(&index);
        if let Some(Open { event, is_complete: true, shown_s: Some(shown_s), noticed_s, .. }) = closed {
            match noticed_s {
                Some(noticed_s) => self.noticed[event as usize].add(noticed_s - shown_s),
                None => self.missed[event as usize] += 1,
            }
        }
    }

    /// The delays of block events and of free events so far.
    pub fn delays(&self) -> [Delays; 2] {
        EVENTS.map(|event| {
            let (noticed, missed) = (&self.noticed[event as usize], self.missed[event as usize]);
            let shown = noticed.count() + missed;
            Delays {
                shown,
                never_noticed: missed as f64 / shown.max(1) as f64,
                median_s: noticed.quantile_with(missed, 0.5),
                p95_s: noticed.quantile_with(missed, 0.95),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_counts_are_those_of_the_list() {
        let mut counts = DelayCounts::default();
        assert_eq!((counts.count(), counts.quantile(0.5)), (0, None));
        let mut delays_s: Vec<f64> =
            (0..1001).map(|event: u32| 0.1 * f64::from(event * event % 97)).collect();
        delays_s.iter().for_each(|&delay_s| counts.add(delay_s));
        delays_s.sort_unstable_by(f64::total_cmp);
        for (share, rank) in [(0.0, 0), (0.5, 500), (0.95, 950), (1.0, 1000)] {
            assert!((counts.quantile(share).unwrap() - delays_s[rank]).abs() < 1e-9, "{share}");
        }
        assert_eq!(counts.count(), 1001);
    }

    #[test]
    fn changes_that_were_missed_have_no_end() {
        let mut latency = Latency::default();
        let delays = |latency: &Latency| latency.delays().map(|of| (of.median_s, of.p95_s));
        (1..=19).for_each(|delay_s| latency.noticed[Event::Free as usize].add(f64::from(delay_s)));
        assert_eq!(delays(&latency), [(None, None), (Some(10.0), Some(19.0))]);
        // 19 of 20 are 95 %; of 21, the map followed no 95 %.
        for (missed, expected) in [
            (1, (Some(10.0), Some(19.0))),
            (2, (Some(11.0), None)),
            (19, (Some(19.0), None)),
            (20, (None, None)),
        ] {
            latency.missed[Event::Free as usize] = missed;
            assert_eq!(delays(&latency)[1], expected, "{missed} missed");
        }
    }

    #[test]
    fn many_delays_take_little_memory() {
        let mut counts = DelayCounts::default();
        for reading in 0..1_000_000_u32 {
            let shown_s = 0.05 * f64::from(reading * 2);
            counts.add(0.05 * f64::from(reading * 2 + reading % 7 * 2) - shown_s);
        }
        assert_eq!(counts.len(), 7);
        (0..100_000).for_each(|delay_s| counts.add(f64::from(delay_s)));
        assert!(counts.len() <= 3608 && counts.quantile(1.0) == Some(f64::from(MAX_DELAY_S)));
    }
}
