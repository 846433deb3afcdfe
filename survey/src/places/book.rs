//! What is kept of places over all sessions: their numbers, their names, and what is needed to compare sessions.

use super::groups::Group;
use super::passages::{Key, Passages, Session, cell_key};
use super::{Place, PlaceKind};
use mapper::Mapper;
use nalgebra::Point2;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// The numbers and the names of places, and how often something passed.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub(crate) struct PlaceBook {
    /// The number of the place of each cell that changes.
    cells: BTreeMap<Key, u32>,
    /// The largest number that was given.
    last: u32,
    /// The names that the user has given.
    pub(crate) names: Vec<PlaceName>,
    pub(super) passages: Passages,
    pub(super) session: Session,
}

impl PlaceBook {
    /// The book of a map that was learned without one.
    pub(crate) fn of_map(mapper: &Mapper) -> Self {
        Self { passages: Passages::of_map(mapper), ..Self::default() }
    }

    /// Counts the changes of the last reading.
    pub(crate) fn note(&mut self, mapper: &Mapper) {
        self.passages.note(mapper);
        self.session.note(mapper);
    }

    /// A new session begins with this log.
    pub(crate) fn begin_session(&mut self, mapper: &Mapper, log: usize) {
        self.passages.begin_session();
        self.session = Session::begin(mapper, log, self.last);
    }

    /// The numbers of places. A place has the number of most of its cells, if no other place has more cells of this number; a
    /// place without a number gets a new one, in the order of the places.
    pub(super) fn numbers(&self, mapper: &Mapper, groups: &[Group]) -> Vec<u32> {
        let mut shared: BTreeMap<(u32, usize), usize> = BTreeMap::new();
        for (group, Group { cells, .. }) in groups.iter().enumerate() {
            for index in cells {
                if let Some(number) = self.cells.get(&cell_key(mapper.frame(), *index)) {
                    *shared.entry((*number, group)).or_default() += 1;
                }
            }
        }
        let mut shared: Vec<((u32, usize), usize)> = shared.into_iter().collect();
        shared.sort_by_key(|(_, cells)| std::cmp::Reverse(*cells)); // stable: of equal ones, the lower number
        let (mut numbers, mut taken) = (vec![0; groups.len()], BTreeSet::new());
        for ((number, group), _) in shared {
            if numbers[group] == 0 && taken.insert(number) {
                numbers[group] = number;
            }
        }
        let mut last = self.last;
        for number in numbers.iter_mut().filter(|number| **number == 0) {
            last += 1;
            *number = last;
        }
        numbers
    }

    /// Keeps the numbers of places.
    pub(crate) fn keep(&mut self, mapper: &Mapper, places: &[Place]) {
        for Place { number, cells, .. } in places {
            self.last = self.last.max(*number);
            let keys = cells.iter().map(|index| cell_key(mapper.frame(), *index));
            self.cells.extend(keys.map(|key| (key, *number)));
        }
    }
}

/// A name that the user gives to what is at a point.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct PlaceName {
    /// The name.
    pub name: String,
    /// The point, m.
    pub x_m: f64,
    /// The point, m.
    pub y_m: f64,
    /// The largest distance of a place that can have the name, m.
    pub radius_m: f64,
}

impl PlaceName {
    /// The distance of the point from the rectangle around a place, m.
    fn distance_m(&self, place: &Place) -> f64 {
        let beyond = |at_m: f64, low_m: f64, high_m: f64| (low_m - at_m).max(at_m - high_m).max(0.0);
        let [x_m, y_m] = [
            beyond(self.x_m, place.low_m[0], place.high_m[0]),
            beyond(self.y_m, place.low_m[1], place.high_m[1]),
        ];
        x_m.hypot(y_m)
    }

    /// The distance of the point from the middle of a place, m.
    fn middle_m(&self, place: &Place) -> f64 {
        (self.x_m - place.x_m).hypot(self.y_m - place.y_m)
    }
}

/// Gives each name to the place nearest to its point that has none: to a door, if there is one within the radius.
pub(super) fn give(places: &mut [Place], names: &[PlaceName]) {
    for name in names {
        let is_free = |place: &&mut Place| place.name.is_none() && name.distance_m(place) <= name.radius_m;
        let is_door = |place: &Place| matches!(place.kind, PlaceKind::Door { .. });
        let nearest = |a: &&mut Place, b: &&mut Place| {
            let apart_m = name.distance_m(a).total_cmp(&name.distance_m(b));
            let middle_m = name.middle_m(a).total_cmp(&name.middle_m(b));
            is_door(b).cmp(&is_door(a)).then(apart_m).then(middle_m)
        };
        if let Some(place) = places.iter_mut().filter(is_free).min_by(nearest) {
            place.name = Some(name.name.clone());
        }
    }
}

/// A name without a place: nothing changes there, as far as it was seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StillName {
    /// The name, and where it is.
    #[serde(flatten)]
    pub name: PlaceName,
    /// For how long the cells within its radius were in view, mean, s; `null` if none was ever seen.
    pub observed_s: Option<f64>,
}

/// Those of these names that none of the places has.
pub(crate) fn still_names(mapper: &Mapper, names: &[PlaceName], places: &[Place]) -> Vec<StillName> {
    let is_free = |name: &&PlaceName| places.iter().all(|place| place.name.as_ref() != Some(&name.name));
    let still = |name: &PlaceName| StillName { name: name.clone(), observed_s: observed_s(mapper, name) };
    names.iter().filter(is_free).map(still).collect()
}

fn observed_s(mapper: &Mapper, name: &PlaceName) -> Option<f64> {
    let (frame, at) = (mapper.frame(), Point2::new(name.x_m, name.y_m));
    let is_near = |index: &usize| (frame.center(frame.cell(*index)) - at).norm() <= name.radius_m;
    let seen = (0..frame.len()).filter(|index| mapper.was_ever_seen(*index)).filter(is_near);
    let times_s: Vec<f64> = seen.map(|index| mapper.statistics(index).observed()).collect();
    (!times_s.is_empty()).then(|| times_s.iter().sum::<f64>() / times_s.len() as f64)
}
