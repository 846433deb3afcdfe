//! The walls of a random world: rooms are divided repeatedly by walls with openings, so that all rooms stay
//! connected.

use super::{GenerateSettings, between, stands_free};
use interfaces::{Cell, Grid, GridFrame, RandomStream};
use rand::RngExt;

/// The smallest width of a room, cells.
const MIN_ROOM: i32 = 4;
/// The largest number of draws until a wall or a pillar has room.
const MAX_TRIES: usize = 50;
/// The length of pillars, cells.
const PILLAR: [u32; 2] = [1, 4];

/// A room: its lower left and its upper right cell.
type Room = (Cell, Cell);

pub(super) fn walls(
    settings: &GenerateSettings,
    frame: GridFrame,
    start: Cell,
    rng: &mut RandomStream,
) -> Grid<bool> {
    let mut walls = Grid::filled(frame, true);
    let (right, top) = (frame.width() as i32 - 2, frame.height() as i32 - 2);
    let mut rooms = vec![(Cell::new(1, 1), Cell::new(right, top))];
    for cell in cells(rooms[0]) {
        walls.set(cell, false);
    }
    for _ in 0..between(rng, settings.walls) {
        (0..MAX_TRIES).any(|_| divide(settings, &mut walls, &mut rooms, start, rng));
    }
    for _ in 0..between(rng, settings.pillars) {
        (0..MAX_TRIES).any(|_| pillar(&mut walls, start, rng));
    }
    walls
}

/// Divides a random room at a random position by a wall with one or two openings, if there is room. The wall must
/// end on walls, so that it closes no opening of another wall.
fn divide(
    settings: &GenerateSettings,
    walls: &mut Grid<bool>,
    rooms: &mut Vec<Room>,
    start: Cell,
    rng: &mut RandomStream,
) -> bool {
    let index = rng.random_range(0..rooms.len());
    let (low, high) = rooms[index];
    let is_upright = rng.random();
    // Along the wall, and across it.
    let (along, across) =
        if is_upright { ((low.y, high.y), (low.x, high.x)) } else { ((low.x, high.x), (low.y, high.y)) };
    if across.1 - across.0 < 2 * MIN_ROOM {
        return false;
    }
    let at = rng.random_range(across.0 + MIN_ROOM..=across.1 - MIN_ROOM);
    let cell = |along: i32| if is_upright { Cell::new(at, along) } else { Cell::new(along, at) };
    let ends_on_walls = [along.0 - 1, along.1 + 1].into_iter().all(|end| walls.get(cell(end)) == Some(&true));
    let mut wall: Vec<Cell> = (along.0..=along.1).map(cell).collect();
    if !ends_on_walls || wall.contains(&start) {
        return false;
    }
    for _ in 0..rng.random_range(1..=2) {
        let width = between(rng, settings.opening) as usize;
        let width = width.min(wall.len());
        let first = rng.random_range(0..=wall.len() - width);
        // The second opening may overlap the first one.
        wall.drain(first..first + width);
        if wall.is_empty() {
            break;
        }
    }
    for &cell in &wall {
        walls.set(cell, true);
    }
    let (left_high, right_low) = if is_upright {
        (Cell::new(at - 1, high.y), Cell::new(at + 1, low.y))
    } else {
        (Cell::new(high.x, at - 1), Cell::new(low.x, at + 1))
    };
    rooms[index] = (low, left_high);
    rooms.push((right_low, high));
    true
}

/// Adds a short straight wall that touches nothing, if there is room at a random position.
fn pillar(walls: &mut Grid<bool>, start: Cell, rng: &mut RandomStream) -> bool {
    let length = between(rng, PILLAR);
    let frame = *walls.frame();
    let first = frame.cell(rng.random_range(0..frame.len()));
    let (dx, dy) = if rng.random() { (1, 0) } else { (0, 1) };
    let pillar: Vec<Cell> =
        (0..length).map(|step| Cell::new(first.x + step * dx, first.y + step * dy)).collect();
    let is_clear =
        |cell: &Cell| stands_free(walls, *cell) && (cell.x - start.x).abs().max((cell.y - start.y).abs()) > 1;
    if !pillar.iter().all(is_clear) {
        return false;
    }
    for cell in pillar {
        walls.set(cell, true);
    }
    true
}

fn cells((low, high): Room) -> impl Iterator<Item = Cell> {
    (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| Cell::new(x, y)))
}
