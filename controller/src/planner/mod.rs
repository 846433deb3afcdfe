//! The map of occupancy states → a costmap → the cost of the path to the goal → a path.

mod costmap;
mod inflation;
mod path;
#[cfg(test)]
mod tests;
mod wavefront;

pub use costmap::{Costmap, DIAGONAL, FREE, LETHAL, MAX_COST, Moves, STRAIGHT};
pub use inflation::{Inflation, InflationSettings};
pub use path::Path;
pub use wavefront::Wavefront;

use costmap::line;
use interfaces::{Cell, CellState, Grid, Transition, Values, values};
use nalgebra::Point2;
use path::corners;
use std::collections::BTreeSet;

/// The robot waits this far before its way is blocked, m: the leaf of a door needs room.
const STANDOFF_M: f64 = 1.0;

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
    /// The distance from a lethal cell within which the robot looks for a traversable one, cells.
    exit_reach: i32,
    /// The cells of the last path.
    on_path: BTreeSet<Cell>,
    goal: Cell,
    end: Option<PlanEnd>,
    path_blocked: bool,
    goal_cleared: bool,
}

impl Planner {
    /// A planner over `map` for a robot of `radius_m`.
    pub fn new(inflation: &InflationSettings, radius_m: f64, moves: Moves, map: &Grid<CellState>) -> Self {
        let frame = *map.frame();
        let exit_m = 4.0 * (radius_m + inflation.footprint_padding_m);
        Self {
            inflation: Inflation::new(inflation, radius_m, map),
            wavefront: Wavefront::new(frame, moves),
            exit_reach: (exit_m / frame.resolution_m()).ceil() as i32 + 1,
            on_path: BTreeSet::new(),
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
        let Self { inflation, on_path, path_blocked, goal_cleared, goal, end, .. } = self;
        let resolution_m = inflation.costmap().frame().resolution_m();
        let blocked = |cell| *path_blocked |= on_path.contains(&cell);
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
        let corners = match self.wavefront.moves {
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
        self.on_path.insert(start);
        self.on_path.extend(corners.windows(2).flat_map(|leg| line(leg[0], leg[1])));
        self.end
    }

    /// Plans as if these blocked cells were free, up to the place where the robot has to wait for that. Returns the length of the whole
    /// path, m, and the point where its way is blocked; `None`, with any path, if no path leads to the goal even then, or if the way is free.
    pub fn plan_past(
        &mut self,
        map: &Grid<CellState>,
        from: &Point2<f64>,
        goal: &Point2<f64>,
        blocked: &[Cell],
        path: &mut Path,
    ) -> Option<(f64, Point2<f64>)> {
        let changes = |[before, after]: [CellState; 2]| -> Vec<Transition> {
            blocked.iter().map(|&cell| Transition { cell, before, after }).collect()
        };
        let states = [CellState::Blocked, CellState::Free];
        self.inflation.update(&changes(states), |_| (), |_| ());
        let end = self.plan(map, from, goal, path);
        self.inflation.update(&changes([states[1], states[0]]), |_| (), |_| ());
        end.filter(|end| end.is_goal)?;
        self.look_for_better();
        let length_m = path.remaining_m(from);
        let frame = *self.costmap().frame();
        let is_lethal = |point: &Point2<f64>| !self.costmap().is_traversable(frame.cell_at(point));
        let (until_m, at) = path.first(frame.resolution_m() / 2.0, is_lethal)?;
        path.truncate((until_m - STANDOFF_M).max(0.0));
        Some((length_m, at))
    }

    /// Detects every cell that becomes traversable, as if the last plan did not lead to the goal.
    pub fn look_for_better(&mut self) {
        self.end.iter_mut().for_each(|end| end.is_cut_off = true);
    }

    /// Whether a blocked cell can make a point lethal.
    pub fn is_near(&self, point: &Point2<f64>, cell: Cell) -> bool {
        let frame = self.costmap().frame();
        // A quarter of the reach of an exit is the distance of a blocked cell that makes a cell lethal.
        let reach = f64::from(self.exit_reach / 4 + 1);
        distance_squared(frame.cell_at(point), cell) <= reach * reach
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
    pub(crate) fn values(&mut self) -> Values<'_> {
        values![self.on_path, self.goal, self.end, self.path_blocked, self.goal_cleared]
    }

    fn reset(&mut self) {
        self.on_path.clear();
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
