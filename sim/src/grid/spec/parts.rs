//! Which free cells hang together.

use interfaces::{Cell, Grid};

/// The maximum number of parts that are named one by one.
const MAX_NAMED: usize = 5;

/// Whether each cell is connected with `start` over the sides of cells that are not walls.
/// Row-major. What moves does not part cells for good, so blocks do not count.
pub(in crate::grid) fn connected(walls: &Grid<bool>, start: Cell) -> Vec<bool> {
    let mut reached = vec![false; walls.frame().len()];
    flood(walls, start, &mut reached);
    reached
}

/// Marks the part that holds `start`; returns the number of cells it adds.
fn flood(walls: &Grid<bool>, start: Cell, reached: &mut [bool]) -> usize {
    let frame = walls.frame();
    let mut open: Vec<Cell> = Vec::new();
    let mut count = 0;
    let mut visit = |cell: Cell, open: &mut Vec<Cell>| {
        if let Some(index) = frame.index(cell)
            && !walls.cells()[index]
            && !std::mem::replace(&mut reached[index], true)
        {
            count += 1;
            open.push(cell);
        }
    };
    visit(start, &mut open);
    while let Some(cell) = open.pop() {
        for side in cell.neighbours4() {
            visit(side, &mut open);
        }
    }
    count
}

/// A sentence for every part of the map that the robot cannot get to.
pub(in crate::grid) fn warnings(walls: &Grid<bool>, start: Cell) -> Vec<String> {
    let frame = walls.frame();
    let mut reached = connected(walls, start);
    let mut parts: Vec<(Cell, usize)> = Vec::new();
    for index in 0..frame.len() {
        if !walls.cells()[index] && !reached[index] {
            let cell = frame.cell(index);
            parts.push((cell, flood(walls, cell, &mut reached)));
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
