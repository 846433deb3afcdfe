use crate::costmap::{Costmap, Moves, line};
use crate::inflation::{Inflation, InflationSettings};
use crate::path::{Path, corners};
use crate::wavefront::Wavefront;
use geometry::{Cell, CellState, Grid, Transition};
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
