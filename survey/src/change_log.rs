use mapper::Mapper;
use std::collections::BTreeMap;

/// When the cells changed last, by index.
#[derive(Clone, Debug, Default)]
pub struct ChangeLog {
    last_s: BTreeMap<usize, f64>,
    events: u64,
}

impl ChangeLog {
    /// Notes the changes of the last update.
    pub fn note(&mut self, mapper: &Mapper) {
        for transition in mapper.transitions() {
            if transition.event().is_none() {
                continue;
            }
            self.events += 1;
            if let Some(index) = mapper.frame().index(transition.cell) {
                self.last_s.insert(index, mapper.time());
            }
        }
    }

    /// The time of the last change of a cell, s; `None` if it never changed.
    pub fn last_s(&self, index: usize) -> Option<f64> {
        self.last_s.get(&index).copied()
    }

    /// The number of changes of all cells.
    pub fn events(&self) -> u64 {
        self.events
    }
}
