//! Whether a robot could drive to a place: a flood over a grid, with all doors open and everything else where it is.

use nalgebra::Point2;
use sim::physics::*;

/// The side of a cell, m.
const CELL_M: f64 = 0.05;

/// The positions that the center of a robot could reach.
pub(super) struct Reach {
    origin: Point2<f64>,
    columns: usize,
    is_reached: Vec<bool>,
}

impl Reach {
    /// The reach of a robot that stands `at`, among the walls, obstacles and robots of the fleet. Robots that drive
    /// are left out: they go away.
    pub(super) fn new(fleet: &Fleet, robot: usize, at: &Point2<f64>) -> Self {
        let spec = fleet.spec();
        let (low, high) = bounds(spec);
        let [columns, rows] =
            [high.x - low.x, high.y - low.y].map(|extent| (extent / CELL_M).ceil() as usize);
        let mut is_free = vec![true; columns * rows];
        let mut reach = Self { origin: low, columns, is_reached: vec![false; columns * rows] };
        let radius_m = spec.robots[robot].radius_m;
        let keep_m = radius_m + CELL_M / 2.0;
        let mut block = |around: &Form| {
            let (low, high) = around.bounds();
            for index in reach.cells(low, high, keep_m) {
                is_free[index] &= around.gap_m_to(&reach.center(index)) >= keep_m;
            }
        };
        fleet.walls().for_each(|wall| block(&Form::Convex(wall.to_vec())));
        for view in fleet.obstacles() {
            let corners = match &spec.obstacles[view.index].motion {
                Motion::Door(door) => door.shape(&spec.obstacles[view.index].shape, 1.0).corners(),
                _ => view.corners,
            };
            block(&Form::Convex(corners.to_vec()));
        }
        let others = fleet.robots().zip(&spec.robots).filter(|(other, _)| other.index != robot);
        others.filter(|(_, spec)| !drives(spec)).for_each(|(view, spec)| block(&spec.form(&view.pose)));
        // Nothing but the robot is within its own radius.
        let mut open = reach.cells(*at, *at, radius_m);
        while let Some(index) = open.pop() {
            if is_free[index] && !std::mem::replace(&mut reach.is_reached[index], true) {
                let (row, column) = (index / columns, index % columns);
                open.extend((column > 0).then(|| index - 1));
                open.extend((column + 1 < columns).then(|| index + 1));
                open.extend((row > 0).then(|| index - columns));
                open.extend((row + 1 < rows).then(|| index + columns));
            }
        }
        reach
    }

    /// Whether the robot can get to a point.
    pub(super) fn has(&self, point: &Point2<f64>) -> bool {
        self.cells(*point, *point, CELL_M).iter().any(|index| self.is_reached[*index])
    }

    /// Whether the robot can get farther away than a distance.
    pub(super) fn is_wider_than(&self, at: &Point2<f64>, distance_m: f64) -> bool {
        let mut reached = (0..self.is_reached.len()).filter(|index| self.is_reached[*index]);
        reached.any(|index| (self.center(index) - at).norm() > distance_m)
    }

    fn center(&self, index: usize) -> Point2<f64> {
        let [column, row] = [index % self.columns, index / self.columns].map(|cell| cell as f64 + 0.5);
        Point2::new(self.origin.x + column * CELL_M, self.origin.y + row * CELL_M)
    }

    /// The cells whose center is in a box that is larger by a margin.
    fn cells(&self, low: Point2<f64>, high: Point2<f64>, margin_m: f64) -> Vec<usize> {
        let rows = self.is_reached.len() / self.columns;
        let cell = |value: f64, cells: usize| ((value / CELL_M - 0.5).ceil().max(0.0) as usize).min(cells);
        let low = low - self.origin;
        let high = high - self.origin;
        let [left, right] = [low.x - margin_m, high.x + margin_m].map(|x| cell(x, self.columns));
        let [bottom, top] = [low.y - margin_m, high.y + margin_m].map(|y| cell(y, rows));
        (bottom..top).flat_map(|row| (left..right).map(move |column| row * self.columns + column)).collect()
    }
}

/// Whether a robot drives by itself.
pub(super) fn drives(spec: &RobotSpec) -> bool {
    !matches!(spec.behavior, BehaviorSpec::Standing | BehaviorSpec::Driven)
}

/// The box around all walls.
fn bounds(spec: &FleetSpec) -> (Point2<f64>, Point2<f64>) {
    let corners: Vec<Point2<f64>> = spec.walls.iter().flat_map(Rectangle::corners).collect();
    let around = Form::Convex(corners);
    around.bounds()
}
