//! Which free cells are connected.

use crate::flood::flood;
use interfaces::{Cell, Grid};
use std::mem::replace;

/// The maximum number of parts that are named one by one.
const MAX_NAMED: usize = 5;

/// For each cell, in row-major order, whether it is connected with `start` over the sides of cells that are not
/// walls. Blocks are ignored, since they move.
pub(crate) fn connected(walls: &Grid<bool>, start: Cell) -> Vec<bool> {
    let mut reached = vec![false; walls.frame().len()];
    flood(walls.frame(), start, |index| !walls.cells()[index] && !replace(&mut reached[index], true));
    reached
}

/// One sentence for every part of the map that the robot cannot reach.
pub(crate) fn warnings(walls: &Grid<bool>, start: Cell) -> Vec<String> {
    let frame = walls.frame();
    let mut reached = connected(walls, start);
    let mut parts: Vec<(Cell, usize)> = Vec::new();
    for index in 0..frame.len() {
        if !walls.cells()[index] && !reached[index] {
            let cell = frame.cell(index);
            let enter = |index: usize| !walls.cells()[index] && !replace(&mut reached[index], true);
            parts.push((cell, flood(frame, cell, enter)));
        }
    }
    let name = |(cell, count): &(Cell, usize)| {
        let (x, y) = (cell.x, cell.y);
        match count {
            1 => format!("the robot cannot reach the cell [{x}, {y}]"),
            _ => format!("the robot cannot reach the {count} cells around [{x}, {y}]"),
        }
    };
    let mut warnings: Vec<String> = parts.iter().take(MAX_NAMED).map(name).collect();
    if parts.len() > MAX_NAMED {
        let cells: usize = parts[MAX_NAMED..].iter().map(|(_, count)| count).sum();
        warnings.push(format!(
            "the robot cannot reach {} more parts of {cells} cells in all",
            parts.len() - MAX_NAMED
        ));
    }
    warnings
}
