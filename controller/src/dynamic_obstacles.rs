use crate::ControlInput;
use interfaces::{CellState, Grid, Value, cell_runs};
use nalgebra::Point2;

/// The time for which a cell counts as dynamic after a change in or beside it, s.
const MEMORY_S: f64 = 10.0;

/// Distinguishes dynamic obstacles from walls: a sensed point is dynamic if the map changed there recently, or if
/// the map has nothing at the point that it could belong to.
///
/// The time of an update is proportional to the number of changes; a query reads the cells around a point.
#[derive(Clone, Debug)]
pub struct DynamicObstacleFilter {
    /// For each cell the time of the last change in the cell or in a cell that touches it.
    changed_at: Grid<f64>,
}

impl DynamicObstacleFilter {
    /// A filter without any change yet.
    pub fn new<T>(map: &Grid<T>) -> Self {
        Self { changed_at: map.map(|_| f64::NEG_INFINITY) }
    }

    /// The times of the changes.
    pub(crate) fn value(&mut self) -> Box<dyn Value + '_> {
        cell_runs(self.changed_at.cells_mut(), usize::MAX)
    }

    /// Applies the changes of this update.
    pub fn update(&mut self, input: &ControlInput) {
        for changed in input.transitions.iter().filter(|transition| transition.event().is_some()) {
            for cell in changed.cell.square(1) {
                self.changed_at.set(cell, input.time);
            }
        }
    }

    /// Whether the obstacle sensed at `point` may move.
    pub fn is_dynamic(&self, input: &ControlInput, point: &Point2<f64>) -> bool {
        let cell = input.map.frame().cell_at(point);
        let changed_at = self.changed_at.get(cell).copied().unwrap_or(f64::NEG_INFINITY);
        let blocked = |cell| input.map.get(cell) == Some(&CellState::Blocked);
        input.time - changed_at < MEMORY_S || !cell.square(1).any(blocked)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{find, states};
    use interfaces::Transition;

    #[test]
    fn walls_are_still_and_what_changed_or_is_new_is_not() {
        let rows = ["#........", "#....C...", "#........", "W.......N"];
        let mut map = states(&rows, 1.0);
        let at = |mark| map.frame().center(find(&rows, mark));
        let (wall, changed, new) = (at('W'), at('C'), at('N'));
        let transition =
            Transition { cell: find(&rows, 'C'), before: CellState::Free, after: CellState::Blocked };
        *map.get_mut(transition.cell).unwrap() = transition.after;
        let pose = interfaces::pose(0.0, 0.0, 0.0);
        let mut dynamic = DynamicObstacleFilter::new(&map);
        let input = |time, transitions| ControlInput {
            time,
            pose: &pose,
            map: &map,
            transitions,
            points: &[],
            obstacles: None,
        };
        let transitions = [transition];
        let now = input(1.0, &transitions);
        dynamic.update(&now);
        assert!(!dynamic.is_dynamic(&now, &wall));
        assert!(dynamic.is_dynamic(&now, &changed));
        assert!(dynamic.is_dynamic(&now, &new));
        let later = input(1.0 + MEMORY_S, &[]);
        assert!(!dynamic.is_dynamic(&later, &changed));
        assert!(dynamic.is_dynamic(&later, &new));
    }
}
