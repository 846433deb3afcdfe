use super::*;
use crate::tests::{find, states};
use interfaces::GridFrame;
use proptest::prelude::*;

fn planner(map: &Grid<CellState>, moves: Moves) -> Planner {
    let point = InflationSettings { footprint_padding_m: 0.0, inflation_m: 0.0, inflation_cost: 1 };
    Planner::new(&point, 0.0, moves, map)
}

fn transition(map: &mut Grid<CellState>, cell: Cell, after: CellState) -> [Transition; 1] {
    let before = std::mem::replace(map.get_mut(cell).unwrap(), after);
    [Transition { cell, before, after }]
}

/// The cells that can be reached from `from`, by flood.
fn reachable(map: &Costmap, from: Cell) -> Vec<Cell> {
    let mut found = vec![from];
    let mut next = 0;
    while next < found.len() {
        for cell in found[next].neighbours4() {
            if map.is_traversable(cell) && !found.contains(&cell) {
                found.push(cell);
            }
        }
        next += 1;
    }
    found
}

proptest! {
    #[test]
    fn a_path_ends_at_the_reachable_cell_nearest_to_the_goal(
        cells in prop::collection::vec(0..5_u8, 20 * 15),
        robot in (0..20_i32, 0..15_i32),
        goal in (0..20_i32, 0..15_i32),
        four in any::<bool>(),
    ) {
        let frame = GridFrame::new(Point2::new(-3.0, 1.0), 0.5, 20, 15).unwrap();
        let state = |n: u8| if n < 2 { CellState::Blocked } else { CellState::Free };
        let mut map = Grid::from_cells(frame, cells.into_iter().map(state).collect()).unwrap();
        let (robot, goal) = (Cell::new(robot.0, robot.1), Cell::new(goal.0, goal.1));
        *map.get_mut(robot).unwrap() = CellState::Free;
        let moves = if four { Moves::Four } else { Moves::Eight };
        let (mut planner, mut path) = (planner(&map, moves), Path::default());
        let (from, to) = (frame.center(robot), frame.center(goal));
        let end = planner.plan(&map, &from, &to, &mut path).unwrap();
        let square = |cell: &Cell| (cell.x - goal.x).pow(2) + (cell.y - goal.y).pow(2);
        let order = |cell: &Cell| (square(cell), cell.y, cell.x);
        let nearest = reachable(planner.costmap(), robot).into_iter().min_by_key(order).unwrap();
        prop_assert_eq!(frame.cell_at(path.end().unwrap()), nearest);
        prop_assert_eq!(end.is_goal, nearest == goal);
        prop_assert!((end.distance_to_goal_m - 0.5 * f64::from(square(&nearest)).sqrt()).abs() < 1e-12);
        prop_assert_eq!(path.points()[0], from);
        let mut cost = 0;
        for leg in path.points().windows(2) {
            let (a, b) = (frame.cell_at(&leg[0]), frame.cell_at(&leg[1]));
            cost += planner.costmap().line_cost(a, b).unwrap();
            prop_assert!(!four || (a.x - b.x).abs() + (a.y - b.y).abs() <= 1);
        }
        // The shortened path costs no more than the field says.
        prop_assert!(cost <= planner.wavefront.path_cost(robot).unwrap());
    }
}

#[test]
fn only_what_closes_on_the_path_concerns_it() {
    let rows = ["......", "R....G", "......"];
    let mut map = states(&rows, 1.0);
    let (mut planner, mut path) = (planner(&map, Moves::Eight), Path::default());
    let (from, to) = (map.frame().center(find(&rows, 'R')), map.frame().center(find(&rows, 'G')));
    planner.plan(&map, &from, &to, &mut path);
    let beside = transition(&mut map, Cell::new(3, 0), CellState::Blocked);
    planner.update(&beside);
    assert!(!planner.path_blocked());
    let on_it = transition(&mut map, Cell::new(3, 1), CellState::Blocked);
    planner.update(&on_it);
    assert!(planner.path_blocked());
    planner.plan(&map, &from, &to, &mut path);
    assert!(!planner.path_blocked() && path.points().len() > 2);
}

#[test]
fn an_opening_concerns_a_path_that_falls_short() {
    let rows = ["..#...", "R.#..G", "..#..."];
    let mut map = states(&rows, 1.0);
    let (mut planner, mut path) = (planner(&map, Moves::Eight), Path::default());
    let (from, to) = (map.frame().center(find(&rows, 'R')), map.frame().center(find(&rows, 'G')));
    let end = planner.plan(&map, &from, &to, &mut path);
    assert_eq!(end, Some(PlanEnd { is_goal: false, distance_to_goal_m: 4.0, is_cut_off: true }));
    assert!(!planner.goal_cleared());
    let door = transition(&mut map, Cell::new(2, 0), CellState::Free);
    planner.update(&door);
    assert!(planner.goal_cleared());
    assert!(planner.plan(&map, &from, &to, &mut path).unwrap().is_goal);
}

#[test]
fn a_robot_in_a_closed_cell_leaves_it_on_its_own_side_of_the_wall() {
    let rows = ["......#......", "......#......", ".....R#....G.", "......#......", "......#......"];
    let map = states(&rows, 0.2);
    let inflation = InflationSettings { footprint_padding_m: 0.01, inflation_m: 0.01, inflation_cost: 1 };
    let mut planner = Planner::new(&inflation, 0.2, Moves::Eight, &map);
    let mut path = Path::default();
    let (robot, goal) = (find(&rows, 'R'), find(&rows, 'G'));
    assert!(!planner.costmap().is_traversable(robot));
    let (from, to) = (map.frame().center(robot), map.frame().center(goal));
    let end = planner.plan(&map, &from, &to, &mut path).unwrap();
    assert!(!end.is_goal && end.is_cut_off);
    assert!(path.end().unwrap().x < from.x);
}

#[test]
fn a_robot_outside_of_the_map_has_no_plan() {
    let map = states(&["...", ".#.", "..."], 1.0);
    let (mut planner, mut path) = (planner(&map, Moves::Eight), Path::default());
    let goal = Point2::new(0.5, 0.5);
    for from in [Point2::new(-5.0, 0.5), Point2::new(f64::NAN, 1e300)] {
        assert_eq!(planner.plan(&map, &from, &goal, &mut path), None);
        assert!(path.points().is_empty());
    }
    // A goal without a position in the map is replaced by a cell at the border.
    for goal in [Point2::new(f64::NAN, f64::INFINITY), Point2::new(1e300, -1e300)] {
        assert!(planner.plan(&map, &Point2::new(0.5, 0.5), &goal, &mut path).is_some());
    }
}
