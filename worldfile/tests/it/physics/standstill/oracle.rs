//! Where a robot could drive: a flood over a grid.

use nalgebra::Point2;
use sim::physics::*;

/// The side of a cell, m.
pub(in crate::physics) const CELL_M: f64 = 0.05;

/// The positions at which the center of a robot is free, on a grid of points.
pub(in crate::physics) struct Positions {
    origin: Point2<f64>,
    columns: usize,
    is_free: Vec<bool>,
}

impl Positions {
    /// Those in a box that keep a distance to everything solid.
    pub(in crate::physics) fn new(
        [low, high]: [Point2<f64>; 2],
        solids: impl IntoIterator<Item = Form>,
        keep_m: f64,
    ) -> Self {
        let [columns, rows] =
            [high.x - low.x, high.y - low.y].map(|extent| (extent / CELL_M).ceil() as usize);
        let mut positions = Self { origin: low, columns, is_free: vec![true; columns * rows] };
        for solid in solids {
            let (low, high) = solid.bounds();
            for index in positions.cells(low, high, keep_m) {
                positions.is_free[index] &= solid.gap_m_to(&positions.center(index)) >= keep_m;
            }
        }
        positions
    }

    /// The connected parts.
    pub(in crate::physics) fn parts(&self) -> Vec<Vec<Point2<f64>>> {
        let mut left = self.is_free.clone();
        let parts = (0..left.len()).map(|start| self.flood(vec![start], &mut left));
        parts.filter(|part| !part.is_empty()).collect()
    }

    /// The positions that are connected to the `open` ones; they are taken from those that are `left`.
    fn flood(&self, mut open: Vec<usize>, left: &mut [bool]) -> Vec<Point2<f64>> {
        let (columns, mut part) = (self.columns, Vec::new());
        while let Some(index) = open.pop() {
            if std::mem::replace(&mut left[index], false) {
                part.push(self.center(index));
                open.extend((index % columns > 0).then(|| index - 1));
                open.extend((index % columns + 1 < columns).then(|| index + 1));
                open.extend(index.checked_sub(columns));
                open.extend((index + columns < left.len()).then(|| index + columns));
            }
        }
        part
    }

    fn center(&self, index: usize) -> Point2<f64> {
        let [column, row] = [index % self.columns, index / self.columns].map(|cell| cell as f64 + 0.5);
        Point2::new(self.origin.x + column * CELL_M, self.origin.y + row * CELL_M)
    }

    /// The cells whose center is in a box that is larger by a margin.
    fn cells(&self, low: Point2<f64>, high: Point2<f64>, margin_m: f64) -> Vec<usize> {
        let rows = self.is_free.len() / self.columns;
        let cell = |value: f64, cells: usize| ((value / CELL_M - 0.5).ceil().max(0.0) as usize).min(cells);
        let low = low - self.origin;
        let high = high - self.origin;
        let [left, right] = [low.x - margin_m, high.x + margin_m].map(|x| cell(x, self.columns));
        let [bottom, top] = [low.y - margin_m, high.y + margin_m].map(|y| cell(y, rows));
        (bottom..top).flat_map(|row| (left..right).map(move |column| row * self.columns + column)).collect()
    }
}

/// The positions that a robot that stands `at` could reach, among the walls, obstacles and robots of the fleet; all doors are
/// open. Robots that drive are left out: they go away.
pub(super) fn reach(fleet: &Fleet, robot: usize, at: &Point2<f64>) -> Vec<Point2<f64>> {
    let spec = fleet.spec();
    let things = fleet.obstacles().map(|view| match &spec.obstacles[view.index].motion {
        Motion::Door(door) => door.shape(&spec.obstacles[view.index].shape, 1.0).corners(),
        _ => view.corners,
    });
    let solids =
        spec.walls.iter().map(Rectangle::corners).chain(things).map(|corners| Form::Convex(corners.to_vec()));
    let others = fleet.robots().zip(&spec.robots).filter(|(other, _)| other.index != robot);
    let others = others.filter(|(_, spec)| !drives(spec)).map(|(view, spec)| spec.form(&view.pose));
    let all = Form::Convex(spec.walls.iter().flat_map(Rectangle::corners).collect()).bounds();
    let radius_m = spec.robots[robot].radius_m;
    let positions = Positions::new(all.into(), solids.chain(others), radius_m + CELL_M / 2.0);
    // Nothing but the robot is within its own radius.
    let open = positions.cells(*at, *at, radius_m);
    positions.flood(open, &mut positions.is_free.clone())
}

/// Whether a robot drives by itself.
fn drives(spec: &RobotSpec) -> bool {
    !matches!(spec.behavior, BehaviorSpec::Standing | BehaviorSpec::Driven)
}
