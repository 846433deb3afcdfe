use crate::costmap::{Costmap, Moves, STRAIGHT, line};
use crate::inflation::{Inflation, InflationSettings};
use crate::path::{Path, corners};
use crate::wavefront::Wavefront;
use interfaces::{Cell, CellState, Grid, Transition};
use nalgebra::Point2;

/// How a plan ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Whether the path leads to the goal itself.
    pub is_goal: bool,
    /// How far from the goal's cell that of the path's end is, m.
    pub short_m: f64,
    /// Whether an open cell nearer to the goal was given up because no way leads there.
    pub walled_off: bool,
}

/// Plans paths over the inflated map, and tells when a change of the map concerns the last one.
#[derive(Clone, Debug)]
pub struct Planner {
    inflation: Inflation,
    wavefront: Wavefront,
    moves: Moves,
    /// How far from a closed cell a robot looks for an open one, cells.
    exit_reach: i32,
    /// Cells of the last path, and the same as a set.
    on_path: Vec<Cell>,
    is_on_path: Grid<bool>,
    goal: Cell,
    reach: Option<Reach>,
    path_closed: bool,
    goal_opened: bool,
    way: Vec<Cell>,
    corners: Vec<Cell>,
}

impl Planner {
    /// A planner over `map` for a robot of `radius_m`.
    pub fn new(settings: &InflationSettings, radius_m: f64, moves: Moves, map: &Grid<CellState>) -> Self {
        let frame = *map.frame();
        Self {
            inflation: Inflation::new(settings, radius_m, map),
            wavefront: Wavefront::new(frame, moves),
            moves,
            exit_reach: (4.0 * (radius_m + settings.margin_m) / frame.resolution_m()).ceil() as i32 + 1,
            on_path: Vec::new(),
            is_on_path: Grid::filled(frame, false),
            goal: Cell::new(0, 0),
            reach: None,
            path_closed: false,
            goal_opened: false,
            way: Vec::new(),
            corners: Vec::new(),
        }
    }

    /// The map as the robot's centre meets it.
    pub fn costmap(&self) -> &Costmap {
        self.inflation.costmap()
    }

    /// Follows the map's changes, as [`Inflation::update`].
    pub fn update(&mut self, transitions: &[Transition]) {
        let Self { inflation, is_on_path, path_closed, goal_opened, goal, reach, .. } = self;
        let resolution_m = is_on_path.frame().resolution_m();
        let closed = |cell| *path_closed |= is_on_path.get(cell) == Some(&true);
        // What opens farther from the goal than the path ends helps only if it opens a way.
        let opened = |cell: Cell| {
            *goal_opened |= reach.is_some_and(|reach| {
                reach.walled_off || distance_squared(cell, *goal).sqrt() * resolution_m < reach.short_m
            });
        };
        inflation.update(transitions, closed, opened);
    }

    /// Whether a cell on the last path has closed since it was planned.
    pub fn path_closed(&self) -> bool {
        self.path_closed
    }

    /// Whether a cell has opened that may bring the robot nearer to the goal than the last path.
    pub fn goal_opened(&self) -> bool {
        self.goal_opened
    }

    /// Plans from `from` to `goal` and writes the path into `path`.
    ///
    /// A closed goal, or one that no way leads to, is replaced by the reachable cell whose centre
    /// is nearest to that of the goal's cell (of equally near ones the one lowest, then leftmost).
    /// A goal outside of the map counts as the nearest point in it. A robot that stands in a
    /// closed cell first goes straight to the nearest open one that nothing blocked hides from it.
    ///
    /// `None`, and no path, if the robot is not on the map or there is no such open cell. The
    /// work is bounded by a few waves over the map.
    pub fn plan(
        &mut self,
        map: &Grid<CellState>,
        from: &Point2<f64>,
        goal: &Point2<f64>,
        path: &mut Path,
    ) -> Option<Reach> {
        path.clear();
        self.forget();
        let frame = *self.costmap().frame();
        let robot = frame.cell_at(from);
        let start = self.exit(map, robot)?;
        let inside = |at: i32, cells: usize| at.clamp(0, cells as i32 - 1);
        let wanted = frame.cell_at(goal);
        self.goal = Cell::new(inside(wanted.x, frame.width()), inside(wanted.y, frame.height()));
        let (end, walled_off) = self.spread_from_nearest(start)?;
        self.wavefront.descend(self.inflation.costmap(), start, &mut self.way);
        let (wavefront, costmap, way) = (&self.wavefront, self.inflation.costmap(), &self.way);
        let cost = |place: usize| wavefront.cost(way[place]).unwrap_or(0);
        match self.moves {
            Moves::Four => self.corners.clone_from(way),
            Moves::Eight => {
                let between = |from, to| cost(from) - cost(to);
                corners(way, between, |from, to| costmap.line_cost(from, to), &mut self.corners);
            }
        }
        let is_goal = end == wanted;
        // The robot stands beside the centre of the first cell, or in a closed cell before it.
        let skipped = usize::from(start == robot && self.corners.len() > 1);
        let ways = self.corners[skipped..].iter().map(|cell| frame.center(*cell));
        path.set(std::iter::once(*from).chain(ways));
        if is_goal {
            path.move_end(*goal);
        }
        let short_m = distance_squared(end, self.goal).sqrt() * frame.resolution_m();
        let reach = Reach { is_goal, short_m, walled_off };
        self.reach = Some(reach);
        self.remember(start);
        Some(reach)
    }

    /// Writes the length of the way from `from` to each cell that can be reached, in row-major order,
    /// m; what the costmap charges more for counts as longer. Leaves the others as they are. The last
    /// path is forgotten.
    pub fn lengths_m(&mut self, map: &Grid<CellState>, from: &Point2<f64>, lengths_m: &mut [f64]) {
        self.forget();
        let frame = *self.costmap().frame();
        let Some(start) = self.exit(map, frame.cell_at(from)) else { return };
        self.wavefront.spread(self.inflation.costmap(), start, None);
        let unit_m = frame.resolution_m() / f64::from(STRAIGHT);
        for (index, length_m) in lengths_m.iter_mut().enumerate().take(frame.len()) {
            if let Some(cost) = self.wavefront.cost(frame.cell(index)) {
                *length_m = f64::from(cost) * unit_m;
            }
        }
    }

    /// The nearest open cell that nothing blocked hides from the robot's.
    fn exit(&self, map: &Grid<CellState>, robot: Cell) -> Option<Cell> {
        if self.costmap().is_open(robot) {
            return Some(robot);
        }
        let free = |cell: Cell| map.get(cell).is_some_and(|state| *state != CellState::Blocked);
        map.frame().contains(robot).then_some(())?;
        let exits = |cell: &Cell| self.costmap().is_open(*cell) && line(robot, *cell).all(free);
        nearest(robot, self.exit_reach, exits)
    }

    /// Spreads a wave to `start` from the open cell nearest to the goal that has a way there.
    /// Returns that cell, and whether a nearer one was open but had no way.
    fn spread_from_nearest(&mut self, start: Cell) -> Option<(Cell, bool)> {
        let costmap = self.inflation.costmap();
        let reach = costmap.frame().width().max(costmap.frame().height()) as i32;
        // Mostly the first try meets the robot. One that misses it has covered all that its source
        // is connected to, which the next try leaves out.
        for walled_off in [false, true] {
            let hope = |cell: &Cell| costmap.is_open(*cell) && self.wavefront.cost(*cell).is_none();
            let end = nearest(self.goal, reach, hope)?;
            if self.wavefront.spread(costmap, end, Some(start)) {
                return Some((end, walled_off));
            }
        }
        // There may be any number of pockets around the goal: ask what the robot can reach instead.
        self.wavefront.clear();
        self.wavefront.spread(costmap, start, None);
        let end = nearest(self.goal, reach, |cell| self.wavefront.cost(*cell).is_some())?;
        self.wavefront.clear();
        self.wavefront.spread(costmap, end, Some(start)).then_some((end, true))
    }

    fn forget(&mut self) {
        for cell in self.on_path.drain(..) {
            if let Some(on_path) = self.is_on_path.get_mut(cell) {
                *on_path = false;
            }
        }
        self.wavefront.clear();
        (self.reach, self.path_closed, self.goal_opened) = (None, false, false);
    }

    fn remember(&mut self, start: Cell) {
        self.on_path.push(start);
        for leg in self.corners.windows(2) {
            self.on_path.extend(line(leg[0], leg[1]));
        }
        for cell in &self.on_path {
            if let Some(on_path) = self.is_on_path.get_mut(*cell) {
                *on_path = true;
            }
        }
    }
}

fn distance_squared(a: Cell, b: Cell) -> f64 {
    let (dx, dy) = (f64::from(a.x - b.x), f64::from(a.y - b.y));
    dx * dx + dy * dy
}

/// The cell nearest to `middle` that is `wanted`, of equally near ones the lowest, then leftmost;
/// not more than `reach` columns or rows away. Looks at rings around the middle, so that it costs
/// what lies nearer than the cell it finds.
fn nearest(middle: Cell, reach: i32, wanted: impl Fn(&Cell) -> bool) -> Option<Cell> {
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
                if better && wanted(&Cell::new(middle.x + dx, middle.y + dy)) {
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
    use crate::drawing::{find, states};
    use interfaces::GridFrame;
    use proptest::prelude::*;

    const POINT: InflationSettings = InflationSettings { margin_m: 0.0, comfort_m: 0.0, comfort_price: 1 };

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
                if map.is_open(cell) && !found.contains(&cell) {
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
            let reach = planner.plan(&map, &from, &to, &mut path).unwrap();
            let square = |cell: &Cell| (cell.x - goal.x).pow(2) + (cell.y - goal.y).pow(2);
            let order = |cell: &Cell| (square(cell), cell.y, cell.x);
            let nearest = reachable(planner.costmap(), robot).into_iter().min_by_key(order).unwrap();
            prop_assert_eq!(frame.cell_at(path.end().unwrap()), nearest);
            prop_assert_eq!(reach.is_goal, nearest == goal);
            prop_assert!((reach.short_m - 0.5 * f64::from(square(&nearest)).sqrt()).abs() < 1e-12);
            prop_assert_eq!(path.points()[0], from);
            for leg in path.points().windows(2) {
                let (a, b) = (frame.cell_at(&leg[0]), frame.cell_at(&leg[1]));
                prop_assert!(planner.costmap().line_cost(a, b).is_some());
                prop_assert!(!four || (a.x - b.x).abs() + (a.y - b.y).abs() <= 1);
            }
            // The shortened path costs no more than the field says.
            let cost = planner.wavefront.cost(robot).unwrap();
            let line = |leg: &[Cell]| planner.costmap().line_cost(leg[0], leg[1]).unwrap();
            prop_assert!(planner.corners.windows(2).map(line).sum::<u32>() <= cost);
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
        assert!(!planner.path_closed());
        let on_it = transition(&mut map, Cell::new(3, 1), CellState::Blocked);
        planner.update(&on_it);
        assert!(planner.path_closed());
        planner.plan(&map, &from, &to, &mut path);
        assert!(!planner.path_closed() && path.points().len() > 2);
    }

    #[test]
    fn an_opening_concerns_a_path_that_falls_short() {
        let rows = ["..#...", "R.#..G", "..#..."];
        let mut map = states(&rows, 1.0);
        let (mut planner, mut path) = (planner(&map, Moves::Eight), Path::default());
        let (from, to) = (map.frame().center(find(&rows, 'R')), map.frame().center(find(&rows, 'G')));
        let reach = planner.plan(&map, &from, &to, &mut path);
        assert_eq!(reach, Some(Reach { is_goal: false, short_m: 4.0, walled_off: true }));
        assert!(!planner.goal_opened());
        let door = transition(&mut map, Cell::new(2, 0), CellState::Free);
        planner.update(&door);
        assert!(planner.goal_opened());
        assert!(planner.plan(&map, &from, &to, &mut path).unwrap().is_goal);
    }

    #[test]
    fn a_robot_in_a_closed_cell_leaves_it_on_its_own_side_of_the_wall() {
        let rows = ["......#......", "......#......", ".....R#....G.", "......#......", "......#......"];
        let map = states(&rows, 0.2);
        let settings = InflationSettings { margin_m: 0.01, comfort_m: 0.01, comfort_price: 1 };
        let mut planner = Planner::new(&settings, 0.2, Moves::Eight, &map);
        let mut path = Path::default();
        let (robot, goal) = (find(&rows, 'R'), find(&rows, 'G'));
        assert!(!planner.costmap().is_open(robot));
        let (from, to) = (map.frame().center(robot), map.frame().center(goal));
        let reach = planner.plan(&map, &from, &to, &mut path).unwrap();
        assert!(!reach.is_goal && reach.walled_off);
        assert!(path.end().unwrap().x < from.x);
    }

    #[test]
    fn a_robot_that_is_nowhere_has_no_plan() {
        let map = states(&["...", ".#.", "..."], 1.0);
        let (mut planner, mut path) = (planner(&map, Moves::Eight), Path::default());
        let goal = Point2::new(0.5, 0.5);
        for from in [Point2::new(-5.0, 0.5), Point2::new(f64::NAN, 1e300)] {
            assert_eq!(planner.plan(&map, &from, &goal, &mut path), None);
            assert!(path.points().is_empty());
        }
        // A goal that is nowhere is taken for a cell at the border.
        for goal in [Point2::new(f64::NAN, f64::INFINITY), Point2::new(1e300, -1e300)] {
            assert!(planner.plan(&map, &Point2::new(0.5, 0.5), &goal, &mut path).is_some());
        }
    }
}
