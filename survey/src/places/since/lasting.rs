use crate::ChangeLog;
use crate::masks::cells_of_doors;
use crate::places::passages::{Key, cell_key};
use interfaces::CellState;
use mapper::Mapper;
use nalgebra::Vector2;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Cells are those of one thing if they are at most this far apart, m.
const APART_M: f64 = 0.15;
/// The smallest area of a thing, m².
const MIN_M2: f64 = 0.04;
/// What stays so was still so this time after its last change, s, and was in view for this time where it is or was.
const STAYS_S: f64 = 10.0;
/// A cell that changed more often, in all sessions, belongs to something that moves.
const MAX_CHANGES: u32 = 4;

/// Something that came or went since the last session, and was still so at the end.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Lasting {
    /// Whether something is where nothing was before; otherwise something is gone.
    pub is_new: bool,
    /// Its middle, m.
    pub x_m: f64,
    /// Its middle, m.
    pub y_m: f64,
    /// The area of its cells, m².
    pub area_m2: f64,
}

/// What has come or gone, the largest first. `touched`: cells that changed in the session, and whether each was blocked before.
pub(super) fn lasting(mapper: &Mapper, log: &ChangeLog, touched: &BTreeMap<Key, bool>) -> Vec<Lasting> {
    let frame = mapper.frame();
    let stays = |index: &usize| {
        let (seen, last_s) = (mapper.statistics(*index), log.last_s(*index));
        let is_still = last_s.is_some_and(|last_s| seen.last_seen - last_s >= STAYS_S);
        is_still && seen.watched_blocked >= STAYS_S && seen.events() <= MAX_CHANGES
    };
    let of_doors = cells_of_doors(mapper);
    let lasts = |index: &usize| stays(index) && of_doors.binary_search(&(*index as u32)).is_err();
    let [mut gone, mut new] = [BTreeSet::new(), BTreeSet::new()];
    for index in mapper.changed().filter(lasts) {
        match (touched.get(&cell_key(frame, index)), mapper.states().cells()[index]) {
            (Some(true), CellState::Free) => gone.insert(index),
            (Some(false), CellState::Blocked) => new.insert(index),
            _ => false,
        };
    }
    let reach = (APART_M / frame.resolution_m()).round().max(1.0) as i32;
    let mut found = Vec::new();
    for (is_new, mut left) in [(false, gone), (true, new)] {
        while let Some(cells) = frame.take_connected(&mut left, reach) {
            let centers = cells.iter().map(|index| frame.center(frame.cell(*index)).coords);
            let middle = centers.sum::<Vector2<f64>>() / cells.len() as f64;
            let area_m2 = cells.len() as f64 * frame.resolution_m().powi(2);
            found.push(Lasting { is_new, x_m: middle.x, y_m: middle.y, area_m2 });
        }
    }
    found.retain(|lasting| lasting.area_m2 >= MIN_M2);
    found.sort_by(|a, b| b.area_m2.total_cmp(&a.area_m2));
    found
}
