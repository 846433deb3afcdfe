use super::*;
use interfaces::GridFrame;
use nalgebra::Point2;
use proptest::prelude::*;

fn look(walls: &Grid<bool>, robot: Cell, radius: u32) -> Vec<(Cell, bool)> {
    LineOfSight::new(radius).look(walls, robot)
}

/// Whether the segment between the centers of two cells is free, computed for every cell and every corner on the
/// way in fractions. Slow, and directly from the definition.
fn is_in_sight(walls: &Grid<bool>, from: Cell, to: Cell) -> bool {
    let (dx, dy) = (i64::from(to.x - from.x), i64::from(to.y - from.y));
    let blocked =
        |x: i64, y: i64| walls.get(Cell::new(from.x + x as i32, from.y + y as i32)).is_some_and(|wall| *wall);
    for y in dy.min(0)..=dy.max(0) {
        for x in dx.min(0)..=dx.max(0) {
            let is_end = (x, y) == (0, 0) || (x, y) == (dx, dy);
            if !is_end && blocked(x, y) && crosses((dx, dy), (x, y)) {
                return false;
            }
        }
    }
    // The corner on the upper right of the cell [x, y] of the box around the segment.
    for y in dy.min(0)..dy.max(0) {
        for x in dx.min(0)..dx.max(0) {
            if (2 * x + 1) * dy != (2 * y + 1) * dx {
                continue;
            }
            let around = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
            let beside: Vec<(i64, i64)> =
                around.into_iter().filter(|&cell| !crosses((dx, dy), cell)).collect();
            assert_eq!(beside.len(), 2);
            if beside.into_iter().all(|(x, y)| blocked(x, y)) {
                return false;
            }
        }
    }
    true
}

/// Whether the segment from the middle of the cell [0, 0] to that of `to` meets the inside of a
/// cell: whether there is a share of the way at which it is in the cell's columns and in its rows.
fn crosses(to: (i64, i64), cell: (i64, i64)) -> bool {
    // Open intervals of the share, as fractions with positive denominators.
    let mut low = (0_i64, 1_i64);
    let mut high = (1_i64, 1_i64);
    for (length, at) in [(to.0, cell.0), (to.1, cell.1)] {
        if length == 0 {
            if at != 0 {
                return false;
            }
            continue;
        }
        let sign = length.signum();
        let (near, far) = (2 * at * sign - 1, 2 * at * sign + 1);
        let whole = 2 * length.abs();
        if near * low.1 > low.0 * whole {
            low = (near, whole);
        }
        if far * high.1 < high.0 * whole {
            high = (far, whole);
        }
    }
    low.0 * high.1 < high.0 * low.1
}

/// The view of the robot by the definition, row by row.
fn oracle(walls: &Grid<bool>, robot: Cell, radius: u32) -> Vec<(Cell, bool)> {
    let frame = walls.frame();
    let cells = (0..frame.len()).map(|index| (frame.cell(index), walls.cells()[index]));
    let is_near = |cell: Cell| (cell.x - robot.x).pow(2) + (cell.y - robot.y).pow(2) <= radius.pow(2) as i32;
    cells.filter(|&(cell, _)| is_near(cell) && is_in_sight(walls, robot, cell)).collect()
}

fn sorted(mut cells: Vec<(Cell, bool)>) -> Vec<(Cell, bool)> {
    cells.sort_by_key(|(cell, _)| (cell.y, cell.x));
    cells
}

/// A random map, a free place in it and a radius.
fn scene(
    sides: std::ops::Range<usize>,
    radii: std::ops::RangeInclusive<u32>,
) -> impl Strategy<Value = (Grid<bool>, Cell, u32)> {
    (sides.clone(), sides, 0.0..0.7, radii).prop_flat_map(|(width, height, density, radius)| {
        let frame = GridFrame::new(Point2::origin(), 1.0, width, height).unwrap();
        let cells = prop::collection::vec(prop::bool::weighted(density), frame.len());
        (cells, 0..frame.len()).prop_map(move |(mut cells, robot)| {
            cells[robot] = false;
            (Grid::from_cells(frame, cells).unwrap(), frame.cell(robot), radius)
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn sight_agrees_with_the_definition((walls, robot, radius) in scene(1..28, 1..=12)) {
        prop_assert_eq!(sorted(look(&walls, robot, radius)), oracle(&walls, robot, radius));
    }

    #[test]
    fn sight_is_mutual((walls, robot, radius) in scene(2..20, 1..=12)) {
        for (cell, _) in look(&walls, robot, radius).into_iter().filter(|(_, is_blocked)| !is_blocked) {
            prop_assert!(look(&walls, cell, radius).contains(&(robot, false)), "{cell:?}");
        }
    }

    /// The order does not depend on the blocks: it is that of the empty map.
    #[test]
    fn the_order_is_fixed((walls, robot, radius) in scene(1..28, 1..=12)) {
        let open = look(&Grid::filled(*walls.frame(), false), robot, radius);
        let seen = look(&walls, robot, radius);
        prop_assert_eq!(seen[0], (robot, false));
        let mut all = open.iter();
        for (cell, _) in seen {
            prop_assert!(all.any(|(other, _)| *other == cell), "{cell:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    /// Where a row of the view takes more than one word.
    #[test]
    fn sight_agrees_with_the_definition_far_away((walls, robot, radius) in scene(60..150, 31..=100)) {
        // Few walls; otherwise nothing is seen from far away.
        let sparse = Grid::from_cells(
            *walls.frame(),
            walls.cells().iter().enumerate().map(|(index, wall)| *wall && index % 16 == 0).collect(),
        ).unwrap();
        for walls in [&walls, &sparse] {
            prop_assert_eq!(sorted(look(walls, robot, radius)), oracle(walls, robot, radius));
        }
    }
}
