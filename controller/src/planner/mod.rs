//! The map of occupancy states → a costmap → the cost of the path to the goal → a path.

mod costmap;
mod inflation;
mod path;
mod wavefront;

pub use costmap::{Costmap, DIAGONAL, FREE, LETHAL, MAX_COST, Moves, STRAIGHT};
pub use inflation::{Inflation, InflationSettings};
pub use path::Path;
pub use wavefront::Wavefront;

use costmap::line;
use interfaces::{Cell, CellState, Grid, Transition, Value, converted};
use nalgebra::Point2;
use path::corners;

/// The end of a plan.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct PlanEnd {
    /// Whether the path leads to the goal itself.
    pub is_goal: bool,
    /// The distance from the goal's cell to the cell where the path ends, m.
    pub distance_to_goal_m: f64,
    /// Whether a traversable cell nearer to the goal exists that no path leads to.
    pub is_cut_off: bool,
}

/// Plans paths on the inflated map, and detects changes of the map that affect the last plan.
#[derive(Clone, Debug)]
pub struct Planner {
    inflation: Inflation,
    wavefront: Wavefront,
    moves: Moves,
    /// The distance from a lethal cell within which the robot looks for a traversable one, cells.
    exit_reach: i32,
    /// The cells of the last path, as a list and as a set.
    on_path: Vec<Cell>,
    is_on_path: Grid<bool>,
    goal: Cell,
    end: Option<PlanEnd>,
    path_blocked: bool,
    goal_cleared: bool,
}

impl Planner {
    /// A planner over `map` for a robot of `radius_m`.
    pub fn new(settings: &InflationSettings, radius_m: f64, moves: Moves, map: &Grid<CellState>) -> Self {
        let frame = *map.frame();
        let exit_m = 4.0 * (radius_m + settings.footprint_padding_m);
        Self {
            inflation: Inflation::new(settings, radius_m, map),
            wavefront: Wavefront::new(frame, moves),
            moves,
            exit_reach: (exit_m / frame.resolution_m()).ceil() as i32 + 1,
            on_path: Vec::new(),
            is_on_path: Grid::filled(frame, false),
            goal: Cell::new(0, 0),
            end: None,
            path_blocked: false,
            goal_cleared: false,
        }
    }

    /// The inflated map.
    pub fn costmap(&self) -> &Costmap {
        self.inflation.costmap()
    }

    /// Applies the changes of the map, as [`Inflation::update`].
    pub fn update(&mut self, transitions: &[Transition]) {
        let Self { inflation, is_on_path, path_blocked, goal_cleared, goal, end, .. } = self;
        let resolution_m = is_on_path.frame().resolution_m();
        let blocked = |cell| *path_blocked |= is_on_path.get(cell) == Some(&true);
        // A cell farther from the goal than the end of the path helps only if it opens a path.
        let cleared = |cell: Cell| {
            *goal_cleared |= end.is_some_and(|end| {
                let distance_m = distance_squared(cell, *goal).sqrt() * resolution_m;
                end.is_cut_off || distance_m < end.distance_to_goal_m
            });
        };
        inflation.update(transitions, blocked, cleared);
    }

    /// Whether a cell of the last path has become lethal since it was planned.
    pub fn path_blocked(&self) -> bool {
        self.path_blocked
    }

    /// Whether a cell has become traversable that may bring the robot nearer to the goal than the end of the last
    /// path.
    pub fn goal_cleared(&self) -> bool {
        self.goal_cleared
    }

    /// Plans from `from` to `goal` and writes the path into `path`.
    ///
    /// A lethal or unreachable goal is replaced by the reachable cell whose center is nearest to the center of the
    /// goal's cell (of equally near cells the lowest, then the leftmost). A goal outside of the map is replaced by
    /// the nearest point in the map. A robot in a lethal cell first drives straight to the nearest traversable cell
    /// that no blocked cell separates from the robot.
    ///
    /// Returns `None`, without a path, if the robot is outside of the map or there is no such traversable cell. The
    /// time is bounded by that of a few waves over the map.
    pub fn plan(
        &mut self,
        map: &Grid<CellState>,
        from: &Point2<f64>,
        goal: &Point2<f64>,
        path: &mut Path,
    ) -> Option<PlanEnd> {
        path.clear();
        self.reset();
        let frame = *self.costmap().frame();
        let robot = frame.cell_at(from);
        let start = self.exit(map, robot)?;
        let inside = |at: i32, cells: usize| at.clamp(0, cells as i32 - 1);
        let wanted = frame.cell_at(goal);
        self.goal = Cell::new(inside(wanted.x, frame.width()), inside(wanted.y, frame.height()));
        let (last, is_cut_off) = self.spread_from_nearest(start)?;
        let costmap = self.inflation.costmap();
        let cells = self.wavefront.descend(costmap, start);
        let cost = |index: usize| self.wavefront.path_cost(cells[index]).unwrap_or(0);
        let corners = match self.moves {
            Moves::Eight => {
                corners(&cells, |from, to| cost(from) - cost(to), |from, to| costmap.line_cost(from, to))
            }
            Moves::Four => cells,
        };
        let is_goal = last == wanted;
        // The robot stands beside the center of the first cell, or in a lethal cell before it.
        let skipped = usize::from(start == robot && corners.len() > 1);
        let point = |&cell: &Cell| if is_goal && cell == last { *goal } else { frame.center(cell) };
        path.set(std::iter::once(*from).chain(corners[skipped..].iter().map(point)));
        let distance_to_goal_m = distance_squared(last, self.goal).sqrt() * frame.resolution_m();
        self.end = Some(PlanEnd { is_goal, distance_to_goal_m, is_cut_off });
        self.on_path.push(start);
        self.on_path.extend(corners.windows(2).flat_map(|leg| line(leg[0], leg[1])));
        self.on_path.iter().for_each(|cell| self.is_on_path.set(*cell, true));
        self.end
    }

    /// Writes the length of the path from `from` to each reachable cell, in row-major order, m; cells of higher
    /// cost count as longer. The values of other cells are not changed. The last plan is discarded.
    pub fn lengths_m(&mut self, map: &Grid<CellState>, from: &Point2<f64>, lengths_m: &mut [f64]) {
        self.reset();
        let frame = *self.costmap().frame();
        let Some(start) = self.exit(map, frame.cell_at(from)) else { return };
        self.wavefront.spread(self.inflation.costmap(), start, None);
        let unit_m = frame.resolution_m() / f64::from(STRAIGHT);
        for (length_m, cost) in lengths_m.iter_mut().zip(self.wavefront.path_costs()) {
            if let Some(cost) = cost {
                *length_m = f64::from(cost) * unit_m;
            }
        }
    }

    /// The nearest traversable cell that no blocked cell separates from the robot.
    fn exit(&self, map: &Grid<CellState>, robot: Cell) -> Option<Cell> {
        if self.costmap().is_traversable(robot) {
            return Some(robot);
        }
        let free = |cell: Cell| map.get(cell).is_some_and(|state| *state != CellState::Blocked);
        map.frame().contains(robot).then_some(())?;
        let exits = |cell: &Cell| self.costmap().is_traversable(*cell) && line(robot, *cell).all(free);
        nearest(robot, self.exit_reach, exits)
    }

    /// Spreads a wave to `start` from the reachable cell nearest to the goal. Returns that cell, and whether
    /// a nearer cell was traversable but unreachable.
    fn spread_from_nearest(&mut self, start: Cell) -> Option<(Cell, bool)> {
        let costmap = self.inflation.costmap();
        let reach = costmap.frame().width().max(costmap.frame().height()) as i32;
        // Mostly the first wave meets the robot. A wave that misses the robot has covered all cells that are
        // connected to its source; the next try leaves them out.
        for is_cut_off in [false, true] {
            let is_untried =
                |cell: &Cell| costmap.is_traversable(*cell) && self.wavefront.path_cost(*cell).is_none();
            let end = nearest(self.goal, reach, is_untried)?;
            if self.wavefront.spread(costmap, end, Some(start)) {
                return Some((end, is_cut_off));
            }
        }
        // There may be any number of pockets around the goal: search from the robot instead.
        self.wavefront.clear();
        self.wavefront.spread(costmap, start, None);
        let end = nearest(self.goal, reach, |cell| self.wavefront.path_cost(*cell).is_some())?;
        self.wavefront.clear();
        self.wavefront.spread(costmap, end, Some(start)).then_some((end, true))
    }

    /// The last plan. What follows from the map is not in it.
    pub(crate) fn value(&mut self) -> Box<dyn Value + '_> {
        let save = |planner: &Self| {
            let Self { on_path, goal, end, path_blocked, goal_cleared, .. } = planner;
            (on_path.clone(), *goal, *end, *path_blocked, *goal_cleared)
        };
        converted(self, save, |planner, saved| {
            planner.reset();
            let Self { on_path, goal, end, path_blocked, goal_cleared, is_on_path, .. } = planner;
            (*on_path, *goal, *end, *path_blocked, *goal_cleared) = saved;
            on_path.iter().for_each(|cell| is_on_path.set(*cell, true));
            Ok(())
        })
    }

    fn reset(&mut self) {
        self.on_path.drain(..).for_each(|cell| self.is_on_path.set(cell, false));
        self.wavefront.clear();
        (self.end, self.path_blocked, self.goal_cleared) = (None, false, false);
    }
}

fn distance_squared(a: Cell, b: Cell) -> f64 {
    let (dx, dy) = (f64::from(a.x - b.x), f64::from(a.y - b.y));
    dx * dx + dy * dy
}

/// The cell nearest to `middle` for which `is_wanted`, of equally near cells the lowest, then leftmost; at
/// most `reach` columns or rows away. Searches in rings around the middle, so that the time is proportional
/// to the number of nearer cells.
fn nearest(middle: Cell, reach: i32, is_wanted: impl Fn(&Cell) -> bool) -> Option<Cell> {
    let mut best: Option<(i64, i32, i32)> = None;
    for ring in 0..=reach {
        // All cells of this ring and beyond are at least `ring` away.
        if best.is_some_and(|(square, ..)| square < i64::from(ring) * i64::from(ring)) {
            break;
        }
        for dy in -ring..=ring {
            let step = if dy.abs() == ring { 1 } else { (2 * ring).max(1) };
            for dx in (-ring..=ring).step_by(step as usize) {
                let square = i64::from(dx) * i64::from(dx) + i64::from(dy) * i64::from(dy);
                let candidate = (square, dy, dx);
                let better = best.is_none_or(|best| candidate < best);
                if better && is_wanted(&Cell::new(middle.x + dx, middle.y + dy)) {
                    best = Some(candidate);
                }
            }
        }
    }
    best.map(|(_, dy, dx)| Cell::new(middle.x + dx, middle.y + dy))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{find, states};
    use interfaces::GridFrame;
    use proptest::prelude::*;

    const POINT: InflationSettings =
        InflationSettings { footprint_padding_m: 0.0, inflation_m: 0.0, inflation_cost: 1 };

    fn planner(map: &Grid<CellState>, moves: Moves) -> Planner {
        Planner::new(&POINT, 0.0, moves, map)
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
        let settings = InflationSettings { footprint_padding_m: 0.01, inflation_m: 0.01, inflation_cost: 1 };
        let mut planner = Planner::new(&settings, 0.2, Moves::Eight, &map);
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
}
