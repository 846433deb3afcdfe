use super::beams::Beams;
use interfaces::{CellState, Event, GridFrame, LaserReading};
use mapper::Mapper;
use nalgebra::Isometry2;
use serde::Serialize;
use sim::physics::ObstacleEvent;
use std::collections::BTreeSet;

/// A cell counts for [`ThingReport::right_s`] if a beam shows it at most this long after the first cell, s: the
/// side that the robot sees first.
const SHOWN_TOGETHER_S: f64 = 3.0;
/// The share of the shown cells that must be correct in the map.
const RIGHT_SHARE: f64 = 0.9;

/// The detection of a thing that appeared or disappeared. Times are simulated, s; `None` before the event has
/// happened.
#[derive(Clone, Debug, serde::Deserialize, Serialize)]
pub struct ThingReport {
    /// The name of the thing in the world file.
    pub name: String,
    /// Whether the thing appeared; `false`: it disappeared.
    pub appeared: bool,
    /// The time of the event, s.
    pub happened_s: f64,
    /// The time at which a beam first showed the event, s.
    pub in_view_s: Option<f64>,
    /// The time at which the first cell of the thing was correct in the map, s.
    pub noticed_s: Option<f64>,
    /// The time at which nine tenths of the cells that were shown in the first three seconds were correct, s.
    pub right_s: Option<f64>,
}

#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
struct Thing {
    report: ThingReport,
    cells: Vec<ThingCell>,
}

/// A cell of a thing that the map had to change at the event.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
struct ThingCell {
    index: usize,
    shown_s: Option<f64>,
    correct_s: Option<f64>,
}

/// Measures how soon each thing that appears or disappears is detected.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub struct Things {
    things: Vec<Thing>,
    events_taken: usize,
    messages: Vec<String>,
}

impl Things {
    /// Measures one tick, like [`super::Latency::observe`]. `events` are all events since the start.
    pub fn observe(
        &mut self,
        events: &[ObstacleEvent],
        frame: &GridFrame,
        mapper: &Mapper,
        reading: &LaserReading,
        laser: &Isometry2<f64>,
    ) {
        for event in &events[self.events_taken..] {
            self.messages.push(format!(
                "{} {}",
                event.name,
                if event.appeared { "appeared" } else { "disappeared" }
            ));
            self.things.push(Thing {
                report: ThingReport {
                    name: event.name.clone(),
                    appeared: event.appeared,
                    happened_s: event.time_s,
                    in_view_s: None,
                    noticed_s: None,
                    right_s: None,
                },
                cells: changing_cells(event, frame, mapper),
            });
        }
        self.events_taken = events.len();
        let (beams, now_s) = (Beams::new(reading, laser, frame), reading.time_s);
        for Thing { report, cells } in &mut self.things {
            if report.right_s.is_some() {
                continue;
            }
            let (event, new) = kind(report.appeared);
            for ThingCell { index, shown_s, correct_s } in cells.iter_mut() {
                let still_counts = report.in_view_s.is_none_or(|first_s| now_s <= first_s + SHOWN_TOGETHER_S);
                if shown_s.is_none() && still_counts && beams.shows(&frame.center(frame.cell(*index)), event)
                {
                    *shown_s = Some(now_s);
                    report.in_view_s.get_or_insert(now_s);
                }
                if correct_s.is_none() && mapper.states().cells()[*index] == new {
                    *correct_s = Some(now_s);
                    if report.noticed_s.is_none() {
                        report.noticed_s = Some(now_s);
                        self.messages.push(format!("the map shows the first change of {}", report.name));
                    }
                }
            }
            report.right_s = right_at(report.in_view_s, now_s, cells);
            if report.right_s.is_some() {
                self.messages.push(format!("the map shows {} correctly", report.name));
            }
        }
    }

    /// One sentence per event and detection since the last call.
    pub fn take_messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.messages)
    }

    /// The reports, in the order of the events.
    pub fn reports(&self) -> impl Iterator<Item = &ThingReport> {
        self.things.iter().map(|thing| &thing.report)
    }
}

/// The event of the cells of a thing, and their state after it.
fn kind(appeared: bool) -> (Event, CellState) {
    if appeared { (Event::Block, CellState::Blocked) } else { (Event::Free, CellState::Free) }
}

/// The cells of an event that the map has to change. The map can have changed some of them in this very update, whose scan shows
/// the event already. Where none of them was known, they are the unknown ones: the first look shows the event.
fn changing_cells(event: &ObstacleEvent, frame: &GridFrame, mapper: &Mapper) -> Vec<ThingCell> {
    let (change, new) = kind(event.appeared);
    let just_now = mapper.transitions().iter().filter(|transition| transition.event() == Some(change));
    let just_now: BTreeSet<usize> = just_now.filter_map(|transition| frame.index(transition.cell)).collect();
    let state = |index: &usize| mapper.states().cells()[*index];
    let indices: Vec<usize> = event.cells.iter().filter_map(|&cell| frame.index(cell)).collect();
    let (unknown, known): (Vec<usize>, Vec<usize>) =
        indices.into_iter().partition(|index| state(index) == CellState::Unknown);
    let known: Vec<usize> =
        known.into_iter().filter(|index| state(index) != new || just_now.contains(index)).collect();
    let chosen = if known.is_empty() { unknown } else { known };
    chosen.into_iter().map(|index| ThingCell { index, shown_s: None, correct_s: None }).collect()
}

/// The time when enough of the shown cells were correct; `None` while the set of shown cells can still grow.
fn right_at(in_view_s: Option<f64>, now_s: f64, cells: &[ThingCell]) -> Option<f64> {
    if now_s <= in_view_s? + SHOWN_TOGETHER_S {
        return None;
    }
    let shown: Vec<&ThingCell> = cells.iter().filter(|cell| cell.shown_s.is_some()).collect();
    let mut correct_s: Vec<f64> = shown.iter().filter_map(|cell| cell.correct_s).collect();
    correct_s.sort_unstable_by(f64::total_cmp);
    let enough = (RIGHT_SHARE * shown.len() as f64).ceil() as usize;
    correct_s.get(enough.checked_sub(1)?).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten cells, shown at 10 s and correct a tenth of a second apart, except the last.
    fn cells(shown: usize) -> Vec<ThingCell> {
        let correct_s = |cell: usize| (cell < 9).then(|| 10.0 + 0.1 * (cell + 1) as f64);
        let cell = |index: usize| ThingCell {
            index,
            shown_s: (index < shown).then_some(10.0),
            correct_s: correct_s(index),
        };
        (0..10).map(cell).collect()
    }

    #[test]
    fn nine_of_ten_shown_cells_make_a_thing_correct() {
        assert_eq!(right_at(Some(10.0), 20.0, &cells(10)), Some(10.0 + 0.1 * 9.0));
        // Cells that were not shown do not count.
        assert_eq!(right_at(Some(10.0), 20.0, &cells(5)), Some(10.0 + 0.1 * 5.0));
    }

    #[test]
    fn nothing_is_correct_while_the_set_of_cells_can_grow() {
        assert_eq!(right_at(None, 20.0, &cells(10)), None);
        assert_eq!(right_at(Some(10.0), 12.0, &cells(10)), None);
        let incorrect: Vec<_> =
            cells(10).into_iter().map(|cell| ThingCell { correct_s: None, ..cell }).collect();
        assert_eq!(right_at(Some(10.0), 20.0, &incorrect), None);
    }
}
