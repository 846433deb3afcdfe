//! Whether a map has openings: places where the known space goes on into space that was never seen.

use interfaces::{Cell, CellState, Grid};
use std::collections::BTreeSet;

/// A narrower gap is no opening, m; cells so near to a surface are part of it.
const OPENING_M: f64 = 0.5;
const OPENING_CELLS: i32 = 2;

/// Whether free space goes on into unknown space somewhere, over a width of half a meter: then there is more to explore
/// (frontiers: Yamauchi 1997).
pub(crate) fn has_opening(states: &Grid<CellState>) -> bool {
    let frame = states.frame();
    let width = (OPENING_M / frame.resolution_m()).ceil() as i32;
    let mut frontier: BTreeSet<usize> =
        (0..frame.len()).filter(|index| is_frontier(states, *index)).collect();
    let mut parts = std::iter::from_fn(|| frame.take_connected(&mut frontier, 1));
    parts.any(|cells| frame.longer_side(&cells) >= width)
}

/// Whether a cell was never seen, and is beside a free one and away from surfaces.
fn is_frontier(states: &Grid<CellState>, index: usize) -> bool {
    let (frame, cells) = (states.frame(), states.cells());
    let is_blocked = |cell: Cell| states.get(cell) == Some(&CellState::Blocked);
    cells[index] == CellState::Unknown
        && frame.beside(index).any(|beside| cells[beside] == CellState::Free)
        && !frame.cell(index).square(OPENING_CELLS).any(is_blocked)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::GridFrame;
    use nalgebra::Point2;

    /// A map with cells of 10 cm: `#` is blocked, `.` free, everything else was never seen.
    fn map(rows: &[&str]) -> Grid<CellState> {
        let frame = GridFrame::new(Point2::origin(), 0.1, rows[0].len(), rows.len()).unwrap();
        let state = |character: char| match character {
            '#' => CellState::Blocked,
            '.' => CellState::Free,
            _ => CellState::Unknown,
        };
        Grid::from_cells(frame, rows.iter().flat_map(|row| row.chars().map(state)).collect()).unwrap()
    }

    #[test]
    fn a_room_with_a_door_that_was_never_passed_has_an_opening() {
        let closed =
            ["##############", "#............#", "#............#", "#............#", "##############"];
        assert!(!has_opening(&map(&closed)));
        // The same room, of which a wall is missing over 4 and over 10 cells.
        let narrow =
            ["#####    #####", "#............#", "#............#", "#............#", "##############"];
        assert!(!has_opening(&map(&narrow)));
        let wide = ["##          ##", "#............#", "#............#", "#............#", "##############"];
        assert!(has_opening(&map(&wide)));
    }

    #[test]
    fn cells_of_a_wall_that_were_never_hit_are_no_opening() {
        let rows = ["################", "                ", "................", "################"];
        assert!(!has_opening(&map(&rows)));
    }
}
