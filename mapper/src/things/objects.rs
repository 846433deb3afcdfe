//! The objects of a map: born, recognized, merged, and asked.

use super::is_mostly_in;
use super::lasting::Change;
use super::object::Object;
use super::of_cell::OfCell;
use crate::change::{CellMap, Evidence, Population};
use interfaces::{Cell, GridFrame};
use std::collections::BTreeMap;

/// The smallest number of cells that show an object, and its largest extent, m: more is several things, or a crowd.
const MIN_CELLS: usize = 2;
const MAX_EXTENT_M: f64 = 1.8;
/// Changes at most this far from an object that has come or gone alike are its own, m: it is seen from another side.
const NEAR_M: f64 = 0.1;
/// Changes are those of an object if this share of them, or of its cells, is common to both.
const COMMON: f64 = 0.3;
/// The largest number of objects; then the one that was not seen for the longest time is forgotten.
const MAX_OBJECTS: usize = 256;
/// The population is learned anew after a quarter more readings, at least and at most after these numbers of readings.
const RENEWAL_READINGS: [usize; 2] = [8, 100];

/// What is known of an object that comes and goes as a whole: a toy, a chair, a box.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectReport {
    /// Its number among objects, which it keeps over all sessions.
    pub id: u32,
    /// The time at which it was found, s.
    pub found_s: f64,
    /// The cells that it covers while it is there, by their index in ascending order.
    pub cells: Vec<u32>,
    /// Whether it was there at the last look.
    pub is_there: bool,
    /// The time of this look, s.
    pub last_seen_s: f64,
    /// What looks say of how long it stays away, and there.
    pub evidence: Evidence,
    /// How often it comes and goes, cycles per hour.
    pub cycles_per_hour: f64,
    /// The interval that contains this rate with a probability of 90 %.
    pub cycles_per_hour_90: [f64; 2],
}

/// All objects of a map.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct Objects {
    /// By their numbers.
    objects: BTreeMap<u32, Object>,
    /// The number of the object of each cell.
    of_cell: BTreeMap<u32, u32>,
    pub(crate) population: Population,
    due: usize,
    next_id: u32,
}

impl Objects {
    /// Learns from the open reading.
    pub(super) fn observe(&mut self, map: &CellMap, is_doubted: impl Fn(usize) -> bool) {
        self.objects.values_mut().for_each(|object| object.observe(map, &is_doubted));
        let readings = map.readings();
        if readings >= self.due {
            let [least, most] = RENEWAL_READINGS;
            self.due = readings + (readings / 4).clamp(least, most);
            self.objects.values_mut().for_each(|object| object.renew(map));
            let things = self.objects.values().filter(|object| object.is_thing);
            self.population = Population::of(things.map(|object| object.presence.alone()));
        }
    }

    /// Learns from changes that belong together, all of the same kind.
    pub(super) fn learn(&mut self, changes: &[Change], map: &CellMap) {
        let Some(Change { is_blocked, .. }) = changes.first().copied() else { return };
        let cells: Vec<u32> = changes.iter().map(|change| change.cell).collect();
        let mut same = self.same(&cells, is_blocked, map.frame()).into_iter();
        let free = |of_cell: &BTreeMap<u32, u32>| -> Vec<u32> {
            cells.iter().filter(|cell| !of_cell.contains_key(cell)).copied().collect()
        };
        let number = match same.next() {
            Some(number) => number,
            None => {
                let cells = free(&self.of_cell);
                if cells.len() < MIN_CELLS || extent_m(cells.iter().copied(), map.frame()) > MAX_EXTENT_M {
                    return;
                }
                self.make_room();
                let id = self.next_id;
                self.next_id += 1;
                self.objects.insert(id, Object::new(&cells, is_blocked, map));
                id
            }
        };
        for other in same {
            let both = [number, other].map(|number| self.objects.get(&number));
            let cells = both.into_iter().flatten().flat_map(Object::cells);
            let [is_there, other_is_there] = both.map(|object| object.map(|object| object.presence.is_there));
            if is_there == other_is_there
                && extent_m(cells, map.frame()) <= MAX_EXTENT_M
                && let Some(other) = self.objects.remove(&other)
            {
                self.of_cell.extend(other.cells().map(|cell| (cell, number)));
                self.objects.entry(number).and_modify(|object| object.join(other));
            }
        }
        let cells = free(&self.of_cell);
        if let Some(object) = self.objects.get_mut(&number) {
            let all = object.cells().chain(cells.iter().copied());
            if extent_m(all, map.frame()) <= MAX_EXTENT_M {
                object.add(&cells);
                self.of_cell.extend(cells.into_iter().map(|cell| (cell, number)));
            }
            object.presence.renew();
        }
    }

    /// The objects to which changes belong, the one with the most common cells first.
    fn same(&self, cells: &[u32], is_blocked: bool, frame: &GridFrame) -> Vec<u32> {
        let reach = (NEAR_M / frame.resolution_m()).round() as i32;
        // Of each object, the cells that are its own, and those near it.
        let mut votes = BTreeMap::<u32, [usize; 2]>::new();
        for &cell in cells {
            if let Some(number) = self.of_cell.get(&cell) {
                votes.entry(*number).or_default()[0] += 1;
                continue;
            }
            let Cell { x, y } = frame.cell(cell as usize);
            let around =
                (y - reach..=y + reach).flat_map(|y| (x - reach..=x + reach).map(move |x| Cell::new(x, y)));
            let near = around.filter_map(|cell| self.of_cell.get(&(frame.index(cell)? as u32)));
            if let Some(number) = near.min() {
                votes.entry(*number).or_default()[1] += 1;
            }
        }
        let is_same = |(number, [own, near]): &(u32, [usize; 2])| {
            self.objects.get(number).is_some_and(|object| {
                let smaller = cells.len().min(object.cells().len());
                *own as f64 >= COMMON * smaller as f64
                    || own + near > 0 && object.presence.is_there == is_blocked
            })
        };
        let mut same: Vec<_> = votes.into_iter().filter(is_same).collect();
        same.sort_by_key(|(number, [own, near])| (std::cmp::Reverse((*own, *near)), *number));
        same.into_iter().map(|(number, _)| number).collect()
    }

    fn make_room(&mut self) {
        let last_s = |object: &Object| object.presence.last_look().1;
        if self.objects.len() >= MAX_OBJECTS
            && let Some((&oldest, _)) =
                self.objects.iter().min_by(|(_, a), (_, b)| last_s(a).total_cmp(&last_s(b)))
        {
            self.remove(oldest);
        }
    }

    fn remove(&mut self, number: u32) {
        self.objects.remove(&number);
        self.of_cell.retain(|_, other| *other != number);
    }

    /// Forgets those with most of their cells among these, which are sorted.
    pub(super) fn forget(&mut self, cells: &[u32]) {
        let is_in = |object: &Object| is_mostly_in(&object.cells().collect::<Vec<_>>(), cells);
        let within = self.objects.iter().filter(|(_, object)| is_in(object)).map(|(number, _)| *number);
        within.collect::<Vec<_>>().into_iter().for_each(|number| self.remove(number));
    }

    /// What is known of those that are things.
    pub(crate) fn reports(&self) -> impl Iterator<Item = ObjectReport> {
        self.objects.iter().filter(|(_, object)| object.is_thing).map(|(id, object)| {
            let (cycles_per_hour, cycles_per_hour_90) =
                object.presence.posterior(&self.population).per_hour();
            let (is_there, last_seen_s) = object.presence.last_look();
            ObjectReport {
                id: *id,
                found_s: object.found_s,
                cells: object.cells().collect(),
                is_there,
                last_seen_s,
                evidence: object.presence.evidence.clone(),
                cycles_per_hour,
                cycles_per_hour_90,
            }
        })
    }

    /// What the object of a cell says of it; `None` if it belongs to none.
    pub(super) fn of_cell(&self, cell: u32) -> Option<OfCell<'_>> {
        let number = *self.of_cell.get(&cell)?;
        let object = self.objects.get(&number).filter(|object| object.is_thing)?;
        let (presence, population) = (&object.presence, Some(&self.population));
        let (shares, cells) = (object.shares(cell)?, object.cells().len());
        Some(OfCell { presence, number, cells, population, clock: None, shares })
    }

    /// The number of things.
    pub(super) fn count(&self) -> usize {
        self.objects.values().filter(|object| object.is_thing).count()
    }

    pub(super) fn each_cell(&mut self, f: &mut dyn FnMut(&mut u32)) {
        self.objects.values_mut().for_each(|object| object.parts.each_cell(f));
        let mut cells: Vec<(u32, u32)> = std::mem::take(&mut self.of_cell).into_iter().collect();
        cells.iter_mut().for_each(|(cell, _)| f(cell));
        self.of_cell = cells.into_iter().collect();
    }
}

/// The longer side of the box around cells, m.
fn extent_m(cells: impl Iterator<Item = u32>, frame: &GridFrame) -> f64 {
    let ends =
        cells.map(|cell| frame.cell(cell as usize)).fold(None, |ends: Option<[i32; 4]>, Cell { x, y }| {
            let [left, right, low, high] = ends.unwrap_or([x, x, y, y]);
            Some([left.min(x), right.max(x), low.min(y), high.max(y)])
        });
    ends.map_or(0.0, |[left, right, low, high]| {
        f64::from(1 + (right - left).max(high - low)) * frame.resolution_m()
    })
}
