use geometry::{Cell, CellState, Grid};
use nalgebra::Point2;

use crate::Situation;

/// How long a cell counts as restless after a change in or beside it, s.
const MEMORY_S: f64 = 10.0;

/// Tells things that may move from walls: a sensed point is restless where the map changed lately,
/// or where it knows nothing that the point could belong to.
///
/// An update costs in proportion to the changes, a question is a look at the cells around a point.
#[derive(Clone, Debug)]
pub struct Restless {
    /// When each cell, or one that touches it, last changed.
    changed_at: Grid<f64>,
}

impl Restless {
    /// Nothing has changed yet.
    pub fn new<T>(map: &Grid<T>) -> Self {
        Self { changed_at: map.map(|_| f64::NEG_INFINITY) }
    }

    /// Takes note of this update's changes.
    pub fn update(&mut self, situation: &Situation) {
        for changed in situation.transitions.iter().filter(|transition| transition.event().is_some()) {
            for cell in around(changed.cell) {
                if let Some(changed_at) = self.changed_at.get_mut(cell) {
                    *changed_at = situation.time;
                }
            }
        }
    }

    /// Whether what was sensed at `point` may move.
    pub fn is_restless(&self, situation: &Situation, point: &Point2<f64>) -> bool {
        let cell = situation.map.frame().cell_at(point);
        let changed_at = self.changed_at.get(cell).copied().unwrap_or(f64::NEG_INFINITY);
        let blocked = |cell| situation.map.get(cell) == Some(&CellState::Blocked);
        situation.time - changed_at < MEMORY_S || !around(cell).any(blocked)
    }
}

/// A cell and the eight that touch it.
fn around(cell: Cell) -> impl Iterator<Item = Cell> {
    std::iter::once(cell).chain(cell.neighbours8())
}
