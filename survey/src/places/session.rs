use super::passages::{Key, cell_key, spot_key};
use crate::change_log::events;
use interfaces::Event;
use mapper::Mapper;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// What is known of the present session.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub(super) struct Session {
    /// Its first log.
    pub(super) log: usize,
    /// The largest number of a place before it.
    pub(super) last: u32,
    /// The doors before it.
    pub(super) doors: BTreeSet<u32>,
    /// For how long each spot was in view before it, s.
    pub(super) looked: BTreeMap<Key, f32>,
    /// The cells that changed in it: whether each was blocked before.
    pub(super) touched: BTreeMap<Key, bool>,
}

/// For how long each spot was in view: its cell that was in view for the longest time, s.
pub(super) fn looked(mapper: &Mapper) -> BTreeMap<Key, f32> {
    let mut looked: BTreeMap<Key, f32> = BTreeMap::new();
    for index in (0..mapper.frame().len()).filter(|index| mapper.was_ever_seen(*index)) {
        let longest_s = looked.entry(spot_key(mapper.frame(), index)).or_default();
        *longest_s = longest_s.max(mapper.statistics(index).observed() as f32);
    }
    looked
}

impl Session {
    pub(super) fn begin(mapper: &Mapper, log: usize, last: u32) -> Self {
        Self {
            log,
            last,
            doors: mapper.doors().iter().map(|door| door.id).collect(),
            looked: looked(mapper),
            touched: BTreeMap::new(),
        }
    }

    pub(super) fn note(&mut self, mapper: &Mapper) {
        if self.log == 0 {
            return; // there is nothing to compare with
        }
        for (index, event) in events(mapper) {
            let entry = self.touched.entry(cell_key(mapper.frame(), index));
            entry.or_insert(event == Event::Free);
        }
    }
}
