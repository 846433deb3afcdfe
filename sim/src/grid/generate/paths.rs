//! The paths of the blocks of a random world. Between two paths, and between a path and the start of the robot,
//! there is at least one cell.

use super::super::spec::Course;
use super::GenerateSettings;
use interfaces::{Cell, Grid, RandomStream};
use rand::RngExt;

/// The largest number of draws until a path has room.
const MAX_TRIES: usize = 400;
/// The probability that a winding path goes straight on.
const STRAIGHT_ON: f64 = 0.7;

pub(super) struct BlockPath {
    pub(super) cells: Vec<Cell>,
    pub(super) course: Course,
}

/// Paths for the `wanted` number of blocks, or for as many as there is room for.
pub(super) fn paths(
    settings: &GenerateSettings,
    walls: &Grid<bool>,
    start: Cell,
    wanted: usize,
    rng: &mut RandomStream,
) -> Vec<BlockPath> {
    let mut open = walls.map(|wall| !wall);
    close_around(&mut open, start);
    let mut paths = Vec::new();
    for _ in 0..wanted {
        let Some(path) = (0..MAX_TRIES).find_map(|_| path(settings, &open, rng)) else { break };
        for &cell in &path.cells {
            close_around(&mut open, cell);
        }
        paths.push(path);
    }
    paths
}

/// A random path, if all of its cells are open: a straight line, the border of a rectangle, or a path with random
/// bends that never crosses itself.
fn path(settings: &GenerateSettings, open: &Grid<bool>, rng: &mut RandomStream) -> Option<BlockPath> {
    let kind = rng.random_range(0..3_usize);
    let [low, high] = settings.path_cells;
    let first = open.frame().cell(rng.random_range(0..open.frame().len()));
    let (cells, course) = match kind {
        0 => (line(first, rng.random_range(low..=high), rng), Course::BackAndForth),
        1 => (ring(first, low, high, rng)?, Course::Loop),
        _ => (winding(first, rng.random_range(low..=high), open, rng)?, Course::BackAndForth),
    };
    cells.iter().all(|cell| open.get(*cell) == Some(&true)).then_some(BlockPath { cells, course })
}

fn line(first: Cell, length: u32, rng: &mut RandomStream) -> Vec<Cell> {
    let toward = first.neighbours4()[rng.random_range(0..4)];
    let (dx, dy) = (toward.x - first.x, toward.y - first.y);
    (0..length as i32).map(|step| Cell::new(first.x + step * dx, first.y + step * dy)).collect()
}

/// The border of a rectangle, in either direction; `None` where no rectangle has a border of `low` to `high` cells.
fn ring(first: Cell, low: u32, high: u32, rng: &mut RandomStream) -> Option<Vec<Cell>> {
    // A border of c cells belongs to sides of c / 2 + 2 cells together, each of two or more.
    let (low, high) = (low.max(4).div_ceil(2), high / 2);
    if low > high {
        return None;
    }
    let both = rng.random_range(low..=high) as i32 + 2;
    let width = rng.random_range(2..=both - 2);
    let (right, up) = (width - 1, both - width - 1);
    let sides = [(1, 0, right), (0, 1, up), (-1, 0, right), (0, -1, up)];
    let mut cells = vec![first];
    let mut at = first;
    for (dx, dy, length) in sides {
        for _ in 0..length {
            at = Cell::new(at.x + dx, at.y + dy);
            cells.push(at);
        }
    }
    // The last cell is the same as the first.
    cells.pop();
    if rng.random() {
        cells.reverse();
    }
    Some(cells)
}

fn winding(first: Cell, length: u32, open: &Grid<bool>, rng: &mut RandomStream) -> Option<Vec<Cell>> {
    let mut cells = vec![first];
    let mut side = rng.random_range(0..4);
    while cells.len() < length as usize {
        if rng.random::<f64>() >= STRAIGHT_ON {
            side = (side + if rng.random() { 1 } else { 3 }) % 4;
        }
        let at = cells[cells.len() - 1];
        let is_open = |cell: &Cell| open.get(*cell) == Some(&true) && !cells.contains(cell);
        let next = (0..4).map(|turn| (side + turn) % 4).find(|side| is_open(&at.neighbours4()[*side]))?;
        side = next;
        cells.push(at.neighbours4()[side]);
    }
    Some(cells)
}

/// Closes a cell and the eight cells around it.
fn close_around(open: &mut Grid<bool>, cell: Cell) {
    for near in cell.neighbours8().into_iter().chain([cell]) {
        open.set(near, false);
    }
}
