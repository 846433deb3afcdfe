//! Whether a map has openings: places where the known space goes on into space that was never seen.

use interfaces::{Cell, CellState, Grid};

/// A narrower gap is no opening, m; cells so near to a surface are part of it.
const OPENING_M: f64 = 0.5;
const OPENING_CELLS: i32 = 2;

/// Whether free space goes on into unknown space somewhere, over a width of half a meter: then there is more to explore
/// (frontiers: Yamauchi 1997).
pub(crate) fn has_opening(states: &Grid<CellState>) -> bool {
    let frame = states.frame();
    let width = (OPENING_M / frame.resolution_m()).ceil() as i32;
    let mut is_left: Vec<bool> = (0..frame.len()).map(|index| is_frontier(states, index)).collect();
    for index in 0..frame.len() {
        if !std::mem::take(&mut is_left[index]) {
            continue;
        }
        // All frontier cells that are connected with this one.
        let first = frame.cell(index);
        let (mut low, mut high, mut open) = (first, first, vec![first]);
        while let Some(cell) = open.pop() {
            (low, high) = (
                Cell::new(low.x.min(cell.x), low.y.min(cell.y)),
                Cell::new(high.x.max(cell.x), high.y.max(cell.y)),
            );
            for next in cell.square(1) {
                let is_new = frame.index(next).is_some_and(|next| std::mem::take(&mut is_left[next]));
                open.extend(is_new.then_some(next));
            }
        }
        if (high.x - low.x).max(high.y - low.y) + 1 >= width {
            return true;
        }
    }
    false
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
