//! The states that the walls alone give the cells, once, at the start.

use super::cover;
use super::open_share::{OpenShare, state_of};
use crate::flood::flood;
use crate::physics::shape::Rectangle;
use interfaces::{Cell, GridFrame, TrueState};
use std::mem::replace;

/// The state that the walls alone give every cell.
pub(crate) fn walls_cover(frame: &GridFrame, walls: &[Rectangle]) -> Vec<TrueState> {
    let mut states = vec![TrueState::Free; frame.len()];
    // Cells that no wall covers alone, with the walls that may together cover the cell.
    let mut shared = Vec::new();
    for (wall, shape) in walls.iter().enumerate() {
        cover::box_cells(frame, shape, |index, whole| match whole {
            true => states[index] = TrueState::Blocked,
            false if states[index] != TrueState::Blocked => shared.push((index, wall)),
            false => {}
        });
    }
    shared.sort_unstable();
    let mut share = OpenShare::default();
    for group in shared.chunk_by(|a, b| a.0 == b.0) {
        let index = group[0].0;
        if states[index] != TrueState::Blocked {
            let boxes = group.iter().map(|(_, wall)| &walls[*wall]);
            states[index] = state_of(share.of(frame, frame.cell(index), boxes));
        }
    }
    states
}

/// The free cells that are connected with `start` by their sides, and the partly covered cells that touch them:
/// along an oblique wall these lead to the cells inside of the wall.
pub(super) fn reachable(frame: &GridFrame, walls: &[TrueState], start: Cell) -> Vec<bool> {
    let mut reached = vec![false; frame.len()];
    flood(frame, start, |index| walls[index] == TrueState::Free && !replace(&mut reached[index], true));
    let is_fringe = |index: &usize| {
        let mut near = frame.cell(*index).neighbours8().into_iter().filter_map(|near| frame.index(near));
        walls[*index] == TrueState::PartlyCovered && near.any(|near| reached[near])
    };
    let fringe: Vec<usize> = (0..frame.len()).filter(is_fringe).collect();
    for index in fringe {
        reached[index] = true;
    }
    reached
}
