//! When a thing that appeared or went was noticed, and when the map was right about it.

use super::latency::Beams;
use interfaces::{CellState, Event, LaserReading};
use mapper::Mapper;
use nalgebra::Isometry2;
use serde::Serialize;
use sim::physics::{ObstacleEvent, Truth};

/// Cells that a beam shows this long after the first count for [`ThingReport::right_s`], s: the
/// side that the robot sees first, not the one it comes to see later.
const SHOWN_TOGETHER_S: f64 = 3.0;
/// The share of the shown cells that has to be right.
const RIGHT_SHARE: f64 = 0.9;

/// What became known of a thing that appeared or went. Times are simulated, s; `None`: not yet.
#[derive(Clone, Debug, Serialize)]
pub struct ThingReport {
    /// Its name in the world file.
    pub name: String,
    /// Whether it appeared; `false`: it went.
    pub appeared: bool,
    /// When that happened.
    pub happened_s: f64,
    /// When a beam first showed it.
    pub in_view_s: Option<f64>,
    /// When the map first had one of its cells right.
    pub noticed_s: Option<f64>,
    /// When the map had nine tenths of the cells right that were shown in the first three seconds.
    pub right_s: Option<f64>,
}

#[derive(Clone, Debug)]
struct Thing {
    report: ThingReport,
    /// Its cells that the map had the old way when it happened: when each was shown, and right.
    cells: Vec<(usize, Option<f64>, Option<f64>)>,
}

/// Watches every thing that appears or goes.
#[derive(Clone, Debug, Default)]
pub struct Things {
    things: Vec<Thing>,
    events_taken: usize,
    news: Vec<String>,
}

impl Things {
    /// Looks at one tick, as [`super::Latency::watch`]. `events` are all so far.
    pub fn watch(
        &mut self,
        events: &[ObstacleEvent],
        truth: &Truth,
        mapper: &Mapper,
        reading: &LaserReading,
        laser: &Isometry2<f64>,
    ) {
        let frame = truth.frame();
        for event in &events[self.events_taken..] {
            self.news.push(format!("{} {}", event.name, if event.appeared { "appeared" } else { "went" }));
            let old = if event.appeared { CellState::Free } else { CellState::Blocked };
            let cells = event.cells.iter().filter_map(|&cell| frame.index(cell));
            let has_old = |index: &usize| mapper.states().cells()[*index] == old;
            self.things.push(Thing {
                report: ThingReport {
                    name: event.name.clone(),
                    appeared: event.appeared,
                    happened_s: event.time_s,
                    in_view_s: None,
                    noticed_s: None,
                    right_s: None,
                },
                cells: cells.filter(has_old).map(|index| (index, None, None)).collect(),
            });
        }
        self.events_taken = events.len();
        let (beams, now_s) = (Beams { reading, laser, frame }, reading.time_s);
        for Thing { report, cells } in &mut self.things {
            if report.right_s.is_some() {
                continue;
            }
            let (event, new) = if report.appeared {
                (Event::Block, CellState::Blocked)
            } else {
                (Event::Free, CellState::Free)
            };
            for (index, shown_s, right_s) in cells.iter_mut() {
                let still_counts = report.in_view_s.is_none_or(|first_s| now_s <= first_s + SHOWN_TOGETHER_S);
                if shown_s.is_none() && still_counts && beams.shows(frame.cell(*index), event) {
                    *shown_s = Some(now_s);
                    report.in_view_s.get_or_insert(now_s);
                }
                if right_s.is_none() && mapper.states().cells()[*index] == new {
                    *right_s = Some(now_s);
                    if report.noticed_s.is_none() {
                        report.noticed_s = Some(now_s);
                        self.news.push(format!("noticed a change of {}", report.name));
                    }
                }
            }
            report.right_s = right_at(report.in_view_s, now_s, cells);
            if report.right_s.is_some() {
                self.news.push(format!("the map is right about {}", report.name));
            }
        }
    }

    /// What happened and became known since the last call, in sentences.
    pub fn take_news(&mut self) -> Vec<String> {
        std::mem::take(&mut self.news)
    }

    /// What became known, in the order in which things happened.
    pub fn reports(&self) -> impl Iterator<Item = &ThingReport> {
        self.things.iter().map(|thing| &thing.report)
    }
}

/// When the shown cells were right, once it is settled which cells count.
fn right_at(in_view_s: Option<f64>, now_s: f64, cells: &[(usize, Option<f64>, Option<f64>)]) -> Option<f64> {
    if now_s <= in_view_s? + SHOWN_TOGETHER_S {
        return None;
    }
    let mut right_s: Vec<f64> = Vec::new();
    let mut shown = 0;
    for (_, _, right) in cells.iter().filter(|(_, shown_s, _)| shown_s.is_some()) {
        shown += 1;
        right_s.extend(right);
    }
    right_s.sort_unstable_by(f64::total_cmp);
    let enough = (RIGHT_SHARE * f64::from(shown)).ceil() as usize;
    right_s.get(enough.checked_sub(1)?).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten cells, shown at 10 s and right a tenth of a second apart, but for the last.
    fn cells(shown: usize) -> Vec<(usize, Option<f64>, Option<f64>)> {
        let right_s = |cell: usize| (cell < 9).then(|| 10.0 + 0.1 * (cell + 1) as f64);
        (0..10).map(|cell| (cell, (cell < shown).then_some(10.0), right_s(cell))).collect()
    }

    #[test]
    fn nine_of_ten_shown_cells_make_a_thing_right() {
        assert_eq!(right_at(Some(10.0), 20.0, &cells(10)), Some(10.0 + 0.1 * 9.0));
    }

    #[test]
    fn cells_that_were_not_shown_do_not_count() {
        assert_eq!(right_at(Some(10.0), 20.0, &cells(5)), Some(10.0 + 0.1 * 5.0));
    }

    #[test]
    fn nothing_is_right_before_it_is_settled_which_cells_count() {
        assert_eq!(right_at(None, 20.0, &cells(10)), None);
        assert_eq!(right_at(Some(10.0), 12.0, &cells(10)), None);
        let wrong: Vec<_> = cells(10).into_iter().map(|(cell, shown, _)| (cell, shown, None)).collect();
        assert_eq!(right_at(Some(10.0), 20.0, &wrong), None);
    }
}
