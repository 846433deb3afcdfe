//! Maps drawn in ASCII, for tests: the first line is the highest row.

use crate::{Costmap, FREE, LETHAL};
use interfaces::{Cell, CellState, Grid, GridFrame};
use nalgebra::Point2;

fn frame(rows: &[&str], resolution_m: f64) -> GridFrame {
    GridFrame::new(Point2::origin(), resolution_m, rows[0].len(), rows.len()).unwrap()
}

fn characters<'a>(rows: &'a [&str]) -> impl Iterator<Item = (Cell, char)> + 'a {
    rows.iter()
        .rev()
        .enumerate()
        .flat_map(|(y, row)| row.chars().enumerate().map(move |(x, c)| (Cell::new(x as i32, y as i32), c)))
}

/// `#` is lethal, a digit is a cost, everything else is free. Cells of 1 m.
pub(crate) fn costmap(rows: &[&str]) -> Costmap {
    let mut map = Costmap::lethal(frame(rows, 1.0));
    for (cell, c) in characters(rows) {
        let cost = if c == '#' { LETHAL } else { c.to_digit(10).map_or(FREE, |digit| digit as u8) };
        map.set_cost(cell, cost);
    }
    map
}

/// `#` is blocked, `?` unknown, everything else free.
pub(crate) fn states(rows: &[&str], resolution_m: f64) -> Grid<CellState> {
    let mut map = Grid::filled(frame(rows, resolution_m), CellState::Free);
    for (cell, c) in characters(rows) {
        *map.get_mut(cell).unwrap() = match c {
            '#' => CellState::Blocked,
            '?' => CellState::Unknown,
            _ => CellState::Free,
        };
    }
    map
}

/// The cell where `mark` is drawn.
pub(crate) fn find(rows: &[&str], mark: char) -> Cell {
    characters(rows).find(|(_, c)| *c == mark).unwrap().0
}
