use interfaces::{Event, Transition};
use mapper::{Growth, Mapper};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A time, short in a state file.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
struct Time(#[serde(with = "interfaces::serde_time")] f64);

/// The changes of the last update: the index of each cell, and what happened.
pub(crate) fn events(mapper: &Mapper) -> impl Iterator<Item = (usize, Event)> {
    let changed =
        move |transition: &Transition| mapper.frame().index(transition.cell).zip(transition.event());
    mapper.transitions().iter().filter_map(changed)
}

/// When the cells changed last, by index.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct ChangeLog {
    last_s: BTreeMap<usize, Time>,
    events: u64,
}

impl ChangeLog {
    /// Notes the changes of the last update.
    pub fn note(&mut self, mapper: &Mapper) {
        for (index, _) in events(mapper) {
            self.events += 1;
            self.last_s.insert(index, Time(mapper.time()));
        }
    }

    /// Moves all cells into a larger map.
    pub(crate) fn grow(&mut self, growth: &Growth) {
        let moved = std::mem::take(&mut self.last_s).into_iter();
        self.last_s = moved.map(|(index, time)| (growth.index(index), time)).collect();
    }

    /// The time of the last change of a cell, s; `None` if it never changed.
    pub fn last_s(&self, index: usize) -> Option<f64> {
        self.last_s.get(&index).map(|time| time.0)
    }

    /// The number of changes of all cells.
    pub fn events(&self) -> u64 {
        self.events
    }
}
