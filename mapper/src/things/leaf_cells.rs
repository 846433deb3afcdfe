//! The cells that the leaves of doors sweep. A look at a part of a door shows where its leaf is, and thereby what all of its
//! cells are; and the motions of the door are passages over its cells.

use super::{Door, Thing, ThingKind};
use crate::Growth;
use crate::change::{CellMap, RateDistribution};
use crate::clock::Dates;
use crate::look_counts::LookCounts;
use crate::tiles::{ByClock, HALF_HOURS};
use interfaces::CellState;
use std::collections::BTreeMap;

/// A cell counts as free in this number of looks before the first one.
const FREE_LOOKS: f64 = 6.0;
/// The passages of the leaf count as much as this number of cycles of the cell in view.
const CYCLES: f64 = 3.0;

/// A cell of a door.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
struct LeafCell {
    /// The number of the thing.
    door: u32,
    /// The looks while the door was closed, and while it was open.
    counts: [LookCounts; 2],
}

impl LeafCell {
    /// The share of the looks in which the cell is blocked, while the door is closed, and while it is open.
    fn shares(&self) -> [f64; 2] {
        self.counts.map(|counts| counts.share(0.0, FREE_LOOKS))
    }
}

/// What the last look at a door says of one of its cells.
pub(crate) struct LeafLook {
    pub(crate) time_s: f64,
    /// The probability that the cell was blocked then.
    pub(crate) blocked: f64,
}

/// The cells of all doors, by their index.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct LeafCells(BTreeMap<u32, LeafCell>);

impl LeafCells {
    /// Counts what the open reading shows of the doors in view.
    pub(crate) fn note(&mut self, things: &[Thing], cells: &CellMap) {
        for thing in things {
            let ThingKind::Door(door) = &thing.kind else { continue };
            let Some((time_s, is_open)) = door.last_look() else { continue };
            if time_s < cells.time() {
                continue;
            }
            for &index in thing.cells.iter().filter(|&&index| cells.is_seen_now(index as usize)) {
                let cell = self.0.entry(index).or_default();
                cell.door = thing.id;
                let is_blocked = cells.state(index as usize) == CellState::Blocked;
                cell.counts[usize::from(is_open)].add(is_blocked);
            }
        }
    }

    /// What the last look at the door of a cell says; `None` if the cell was never seen with the door in this state.
    pub(crate) fn look(&self, index: usize, things: &[Thing]) -> Option<LeafLook> {
        let (cell, door) = self.find(index, things)?;
        let (time_s, is_open) = door.last_look()?;
        let state = usize::from(is_open);
        (!cell.counts[state].is_empty()).then(|| LeafLook { time_s, blocked: cell.shares()[state] })
    }

    /// What the clock of the door of a cell says of it at a time, s; `None` if the cell was never seen with the door closed, or
    /// never with the door open.
    pub(crate) fn forecast(
        &self,
        index: usize,
        things: &[Thing],
        time_s: f64,
        dates: Dates,
    ) -> Option<ByClock> {
        let (cell, door) = self.find(index, things)?;
        let (_, was_open) = door.last_look()?;
        if cell.counts.iter().any(|counts| counts.is_empty()) {
            return None;
        }
        let [closed, open] = cell.shares();
        let is_open = door.clock.probability(dates.epoch_s + time_s, dates.calendar);
        let later = closed + (open - closed) * is_open;
        let weight = door.clock.half_hours();
        let weight = weight / (weight + HALF_HOURS);
        Some(ByClock { later, then: if was_open { open } else { closed }, weight })
    }

    /// The rate of a cell by the motions of its door, as a prior: the leaf passes over it when the door opens and when it closes,
    /// but comes only once per opening to where it rests.
    pub(crate) fn rate_prior(&self, index: usize, things: &[Thing]) -> Option<RateDistribution> {
        let (cell, door) = self.find(index, things)?;
        let [closed, open] = cell.shares();
        let rate = (2.0 - closed - open) * door.statistics.openings_per_s()?;
        Some(RateDistribution { events: CYCLES, time: CYCLES / rate })
    }

    fn find<'a>(&self, index: usize, things: &'a [Thing]) -> Option<(&LeafCell, &'a Door)> {
        let cell = self.0.get(&(index as u32))?;
        let thing = things.iter().find(|thing| thing.id == cell.door)?;
        match &thing.kind {
            ThingKind::Door(door) => Some((cell, door)),
            ThingKind::Furniture(_) => None,
        }
    }

    /// Moves all cells into a larger map.
    pub(crate) fn grow(&mut self, growth: &Growth) {
        let cells = std::mem::take(&mut self.0).into_iter();
        self.0 = cells.map(|(index, cell)| (growth.index(index as usize) as u32, cell)).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::things::{DoorStatistics, Segment};
    use nalgebra::Point2;

    /// The counts of a cell that was always blocked, or always free.
    fn counts(is_blocked: bool) -> LookCounts {
        let mut counts = LookCounts::default();
        (0..594).for_each(|_| counts.add(is_blocked));
        counts
    }

    #[test]
    fn a_leaf_passes_twice_per_opening_but_where_it_rests() {
        let mut door = Door::new(Segment::from(Point2::origin(), 0.0, 1.0), 0.0);
        door.statistics = DoorStatistics { opened: 9, closed: 10, in_view_s: 3600.0, ..Default::default() };
        let things =
            [Thing { id: 7, kind: ThingKind::Door(Box::new(door)), cells: vec![0, 1, 2], found_s: 0.0 }];
        let rests = [[true, false], [false, true], [false, false]];
        let cell = |rests: [bool; 2]| LeafCell { door: 7, counts: rests.map(counts) };
        let cells = LeafCells((0..).zip(rests.map(cell)).collect());
        for (index, per_opening) in [1.01, 1.01, 2.0].into_iter().enumerate() {
            let per_hour = 3600.0 * cells.rate_prior(index, &things).unwrap().mean();
            assert!((per_hour - 10.0 * per_opening).abs() < 1e-9, "cell {index}: {per_hour} per hour");
        }
        assert_eq!(cells.rate_prior(3, &things), None);
        assert_eq!(cells.rate_prior(0, &[]), None);
    }
}
