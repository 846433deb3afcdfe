//! The exact sensor of a grid world: line of sight between the centers of cells.
//!
//! A cell is in line of sight when the segment from the center of the robot's cell to the center of the cell
//! passes through the inside of no other blocked cell. A segment may pass exactly through the corner at which
//! four cells meet, unless both cells beside the corner are blocked. Line of sight is symmetric.

#[cfg(test)]
mod tests;

use interfaces::{Cell, Grid};
use std::cmp::Ordering;

/// An offset from the robot: columns to the right, rows up.
type Offset = (i32, i32);

/// The cells in line of sight of a sensor.
#[derive(Clone, Debug)]
pub(super) struct LineOfSight {
    /// The cells in reach: the cell of the robot, then by direction counter-clockwise from the right and from near to far.
    reach: Vec<Offset>,
}

impl LineOfSight {
    pub(super) fn new(radius: u32) -> Self {
        let radius = radius as i32;
        let square = (-radius..=radius).flat_map(|y| (-radius..=radius).map(move |x| (x, y)));
        let mut reach: Vec<Offset> = square.filter(|(x, y)| x * x + y * y <= radius * radius).collect();
        let is_away = |offset: Offset| offset != (0, 0);
        reach.sort_unstable_by(|&a, &b| {
            let by_angle = if is_away(a) && is_away(b) { by_direction(a, b) } else { Ordering::Equal };
            is_away(a).cmp(&is_away(b)).then(by_angle).then(steps(a).cmp(&steps(b)))
        });
        Self { reach }
    }

    /// The cells in line of sight from `robot`, each with whether it is blocked.
    pub(super) fn look(&self, blocked: &Grid<bool>, robot: Cell) -> Vec<(Cell, bool)> {
        let seen = |&(dx, dy): &Offset| {
            let cell = Cell::new(robot.x + dx, robot.y + dy);
            let is_blocked = *blocked.get(cell)?;
            is_in_sight(blocked, robot, (dx, dy)).then_some((cell, is_blocked))
        };
        self.reach.iter().filter_map(seen).collect()
    }
}

/// Whether nothing is between two cells of the grid. The segment crosses borders between columns and between rows in turn;
/// their shares of the way are compared in integers.
fn is_in_sight(blocked: &Grid<bool>, robot: Cell, (dx, dy): Offset) -> bool {
    let (columns, rows, cells) = (dx.abs(), dy.abs(), blocked.cells());
    let start = robot.y as isize * blocked.frame().width() as isize + robot.x as isize;
    let (right, up) = (dx.signum() as isize, dy.signum() as isize * blocked.frame().width() as isize);
    let is_blocked = |x: i32, y: i32| cells[(start + x as isize * right + y as isize * up) as usize];
    let (mut x, mut y) = (0, 0);
    while x + y < columns + rows {
        let (across, along) = ((2 * x + 1) * rows, (2 * y + 1) * columns);
        if across == along && is_blocked(x + 1, y) && is_blocked(x, y + 1) {
            return false;
        }
        x += i32::from(across <= along);
        y += i32::from(across >= along);
        if x + y < columns + rows && is_blocked(x, y) {
            return false;
        }
    }
    true
}

/// The order of directions, counter-clockwise from the right.
fn by_direction(a: Offset, b: Offset) -> Ordering {
    let is_lower_half = |(x, y): Offset| y < 0 || (y == 0 && x < 0);
    is_lower_half(a).cmp(&is_lower_half(b)).then(0.cmp(&cross(a, b)))
}

/// Positive if `b` lies counter-clockwise of `a`.
fn cross(a: Offset, b: Offset) -> i64 {
    i64::from(a.0) * i64::from(b.1) - i64::from(a.1) * i64::from(b.0)
}

/// The number of columns and rows to get there.
fn steps((x, y): Offset) -> i32 {
    x.abs() + y.abs()
}
