//! What is kept of places over all sessions: their numbers, their names, and what is needed to compare sessions.

use super::Place;
use super::groups::Group;
use super::names::PlaceName;
use super::passages::{Key, Passages, cell_key};
use super::session::Session;
use mapper::Mapper;
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
