//! A small kinematic world: walls drawn in ASCII, boxes that move, a differential-drive robot with bounded
//! accelerations, a laser with exact rays, and a map that lags behind as a real map does.

use controller::{ControlInput, Controller, DiffDrive, DiffDriveSettings, Driver, Status};
use interfaces::{
    Cell, CellState, Grid, GridFrame, Purpose, RandomStream, Transition, Twist, heading_rad, pose,
};
use nalgebra::{Isometry2, Point2, Vector2};
use std::f64::consts::TAU;

/// The side of one character of the drawing, m: five cells.
pub(crate) const CHARACTER_M: f64 = 0.25;
const CELL_M: f64 = 0.05;
const TICK_S: f64 = 0.1;
const SUBSTEPS: u32 = 10;
pub(crate) const RADIUS_M: f64 = 0.2;

/// An axis-aligned rectangle.
#[derive(Clone, Copy, Debug)]
struct Rectangle {
    low: Point2<f64>,
    high: Point2<f64>,
}

impl Rectangle {
    fn around(middle: Point2<f64>, half_m: f64) -> Self {
        Self { low: middle - Vector2::repeat(half_m), high: middle + Vector2::repeat(half_m) }
    }

    fn distance_m(&self, to: &Point2<f64>) -> f64 {
        let out = |at: f64, low: f64, high: f64| (low - at).max(at - high).max(0.0);
        out(to.x, self.low.x, self.high.x).hypot(out(to.y, self.low.y, self.high.y))
    }

    /// The range at which a ray enters the rectangle, m; infinite if the ray misses.
    fn range_m(&self, from: &Point2<f64>, direction: &Vector2<f64>) -> f64 {
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for axis in 0..2 {
            let a = (self.low[axis] - from[axis]) / direction[axis];
            let b = (self.high[axis] - from[axis]) / direction[axis];
            (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
        }
        if enter <= leave { enter } else { f64::INFINITY }
    }
}

/// A square box that moves back and forth.
#[derive(Clone, Debug)]
pub(crate) struct Mover {
    pub(crate) half_m: f64,
    pub(crate) between: [Point2<f64>; 2],
    pub(crate) speed_mps: f64,
    pub(crate) appears_s: f64,
    pub(crate) goes_s: f64,
    /// The box stops while the robot is nearer than this in its way, m; 0 for a box that never stops.
    pub(crate) yields_m: f64,
    pub(crate) at: Point2<f64>,
    pub(crate) heads_for: usize,
}

impl Mover {
    pub(crate) fn new(between: [Point2<f64>; 2], half_m: f64, speed_mps: f64) -> Self {
        let (at, goes_s) = (between[0], f64::INFINITY);
        Self { half_m, between, speed_mps, appears_s: 0.0, goes_s, yields_m: 0.0, at, heads_for: 1 }
    }

    fn rectangle(&self, time_s: f64) -> Option<Rectangle> {
        (self.appears_s..self.goes_s).contains(&time_s).then(|| Rectangle::around(self.at, self.half_m))
    }

    /// Whether it may ever cover a point.
    fn sweeps(&self, point: &Point2<f64>) -> bool {
        let [a, b] = self.between;
        let half = Vector2::repeat(self.half_m);
        Rectangle { low: a.inf(&b) - half, high: a.sup(&b) + half }.distance_m(point) == 0.0
    }

    fn go(&mut self, step_s: f64, robot: &Point2<f64>) {
        let way = self.between[self.heads_for] - self.at;
        if way.norm() <= self.speed_mps * step_s {
            self.heads_for = 1 - self.heads_for;
            return;
        }
        let step = way.normalize() * self.speed_mps * step_s;
        let ahead = Rectangle::around(self.at + way.normalize() * self.yields_m, self.half_m);
        let gap_m =
            ahead.distance_m(robot).min(Rectangle::around(self.at + step, self.half_m).distance_m(robot));
        if self.yields_m == 0.0 || gap_m > RADIUS_M + 0.02 {
            self.at += step;
        }
    }
}

pub(crate) struct House {
    pub(crate) time_s: f64,
    pub(crate) pose: Isometry2<f64>,
    pub(crate) movers: Vec<Mover>,
    pub(crate) map: Grid<CellState>,
    /// The number of substeps in which the robot drove into something.
    pub(crate) contacts: u32,
    /// The least gap to anything that the robot drove toward, m.
    pub(crate) nearest_m: f64,
    twist: Twist,
    walls: Vec<Rectangle>,
    wall_cells: Grid<bool>,
    disagrees: Grid<u8>,
    /// The cells that may ever change.
    swept: Vec<usize>,
    transitions: Vec<Transition>,
    points: Vec<Point2<f64>>,
}

impl House {
    /// `#` is a wall, `R` the robot, which points to the right.
    pub(crate) fn new(rows: &[&str]) -> Self {
        let side = (CHARACTER_M / CELL_M).round() as usize;
        let frame =
            GridFrame::new(Point2::origin(), CELL_M, rows[0].len() * side, rows.len() * side).unwrap();
        let mut wall_cells = Grid::filled(frame, false);
        let (mut walls, mut start) = (Vec::<Rectangle>::new(), Point2::origin());
        for (up, row) in rows.iter().rev().enumerate() {
            for (along, character) in row.chars().enumerate() {
                let low = Point2::new(along as f64, up as f64) * CHARACTER_M;
                if character == 'R' {
                    start = low + Vector2::repeat(CHARACTER_M / 2.0);
                } else if character == '#' {
                    let high = low + Vector2::repeat(CHARACTER_M);
                    match walls.last_mut() {
                        Some(Rectangle { low: from, high: to }) if from.y == low.y && to.x == low.x => {
                            *to = high
                        }
                        _ => walls.push(Rectangle { low, high }),
                    }
                    for cell in 0..side * side {
                        let (x, y) = (along * side + cell % side, up * side + cell / side);
                        *wall_cells.get_mut(Cell::new(x as i32, y as i32)).unwrap() = true;
                    }
                }
            }
        }
        let map = wall_cells.map(|wall| if *wall { CellState::Blocked } else { CellState::Free });
        Self {
            time_s: 0.0,
            pose: pose(start.x, start.y, 0.0),
            movers: Vec::new(),
            disagrees: map.map(|_| 0),
            map,
            contacts: 0,
            nearest_m: f64::INFINITY,
            twist: Twist::STOP,
            walls,
            wall_cells,
            swept: Vec::new(),
            transitions: Vec::new(),
            points: Vec::new(),
        }
    }

    /// The middle of the character in column `along` and row `up`, counted from the lower left.
    pub(crate) fn at(along: usize, up: usize) -> Point2<f64> {
        Point2::new(along as f64 + 0.5, up as f64 + 0.5) * CHARACTER_M
    }

    pub(crate) fn position(&self) -> Point2<f64> {
        self.pose.translation.vector.into()
    }

    fn bodies(&self) -> impl Iterator<Item = Rectangle> {
        let movers = self.movers.iter().filter_map(|mover| mover.rectangle(self.time_s));
        self.walls.iter().copied().chain(movers)
    }

    /// Updates map and scan to the present.
    pub(crate) fn sense(&mut self) {
        self.transitions.clear();
        let movers: Vec<_> = self.movers.iter().filter_map(|mover| mover.rectangle(self.time_s)).collect();
        let frame = *self.map.frame();
        if self.swept.is_empty() {
            let near =
                |cell: &usize| self.movers.iter().any(|mover| mover.sweeps(&frame.center(frame.cell(*cell))));
            self.swept = (0..frame.len()).filter(near).collect();
        }
        for &index in &self.swept {
            let cell = frame.cell(index);
            let blocked = self.wall_cells.cells()[index]
                || movers.iter().any(|mover| mover.distance_m(&frame.center(cell)) == 0.0);
            let before = self.map.cells()[index];
            let disagrees = &mut self.disagrees.cells_mut()[index];
            if blocked == (before == CellState::Blocked) {
                *disagrees = 0;
                continue;
            }
            *disagrees += 1;
            // Three hits, ten misses.
            if *disagrees >= if blocked { 3 } else { 10 } {
                let after = if blocked { CellState::Blocked } else { CellState::Free };
                self.map.cells_mut()[index] = after;
                self.transitions.push(Transition { cell, before, after });
            }
        }
        let from = self.position();
        self.points.clear();
        for beam in 0..360 {
            let (sin, cos) = (heading_rad(&self.pose) + TAU * f64::from(beam) / 360.0).sin_cos();
            let direction = Vector2::new(cos, sin);
            let range_m = self.bodies().map(|body| body.range_m(&from, &direction)).fold(5.0, f64::min);
            if range_m < 5.0 {
                self.points.push(from + direction * range_m);
            }
        }
    }

    pub(crate) fn input(&self) -> ControlInput<'_> {
        ControlInput {
            time: self.time_s,
            pose: &self.pose,
            map: &self.map,
            transitions: &self.transitions,
            points: &self.points,
            obstacles: None,
        }
    }

    /// Executes a command for a tick.
    pub(crate) fn act(&mut self, command: Twist) {
        let step_s = TICK_S / f64::from(SUBSTEPS);
        for _ in 0..SUBSTEPS {
            let towards =
                |now: f64, wish: f64, most: f64| now + (wish - now).clamp(-most * step_s, most * step_s);
            self.twist.linear_mps = towards(self.twist.linear_mps, command.linear_mps.clamp(-0.5, 0.5), 1.0);
            self.twist.angular_radps =
                towards(self.twist.angular_radps, command.angular_radps.clamp(-1.5, 1.5), 4.0);
            let heading = heading_rad(&self.pose) + self.twist.angular_radps * step_s / 2.0;
            let step = Vector2::new(heading.cos(), heading.sin()) * self.twist.linear_mps * step_s;
            let from = self.position();
            let at = from + step;
            self.pose = pose(at.x, at.y, heading + self.twist.angular_radps * step_s / 2.0);
            if self.twist.linear_mps != 0.0 {
                for body in self.bodies().collect::<Vec<_>>() {
                    let gap_m = body.distance_m(&at) - RADIUS_M;
                    // A box that never stops may hit the robot. This does not count as a contact of the robot,
                    // unless the robot drives on into the box.
                    if gap_m < body.distance_m(&from) - RADIUS_M {
                        self.nearest_m = self.nearest_m.min(gap_m);
                        self.contacts += u32::from(gap_m < 0.0);
                    }
                }
            }
            self.movers.iter_mut().for_each(|mover| mover.go(step_s, &at));
        }
        self.time_s += TICK_S;
    }

    /// One tick of robot and world.
    pub(crate) fn tick(&mut self, controller: &mut Controller<DiffDrive>) {
        self.sense();
        let command = controller.drive(&self.input());
        self.act(command);
    }

    /// Runs until the controller is done; panics if that takes longer than `limit_s`.
    pub(crate) fn run(
        &mut self,
        controller: &mut Controller<DiffDrive>,
        limit_s: f64,
    ) -> controller::Outcome {
        let end_s = self.time_s + limit_s;
        loop {
            self.tick(controller);
            if let Status::Finished(outcome) = controller.view().status {
                return outcome;
            }
            assert!(self.time_s < end_s, "still {:?} after {limit_s} s", controller.view().status);
        }
    }
}

pub(crate) fn controller() -> Controller<DiffDrive> {
    let drive = DiffDrive::new(DiffDriveSettings::default()).unwrap();
    Controller::new(drive, 42, RandomStream::new(7, Purpose::Controller))
}
