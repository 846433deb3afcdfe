//! The exact sensor of a grid world: line of sight between the centers of cells.
//!
//! A cell is in line of sight when the segment from the center of the robot's cell to the center of the cell
//! passes through the inside of no other blocked cell. A segment may pass exactly through the corner at which
//! four cells meet, unless both cells beside the corner are blocked. Line of sight is symmetric.

#[cfg(test)]
mod tests;

use super::spec::GridSpec;
use interfaces::{Cell, Grid, GridFrame};
use std::cmp::Ordering;
use std::ops::Range;

/// A direction or an offset: columns to the right, rows up.
type Offset = (i32, i32);

/// The cells in line of sight of a sensor. What can hide a cell is computed once, in integers.
#[derive(Clone, Debug)]
pub(super) struct LineOfSight {
    reach: Vec<Reach>,
    /// For all cells in reach, the pairs of cells that hide the cell if both are blocked, as differences of indices.
    hiding: Vec<[i32; 2]>,
}

/// A cell in reach.
#[derive(Clone, Debug)]
struct Reach {
    /// The offset from the robot.
    offset: Offset,
    /// What hides the cell.
    hiding: Range<usize>,
}

impl LineOfSight {
    pub(super) fn new(radius: u32, frame: &GridFrame) -> Self {
        let mut hiding = Vec::new();
        let reach = in_reach(radius as i32).into_iter().map(|offset| {
            let start = hiding.len();
            let index = |(x, y): Offset| y * frame.width() as i32 + x;
            hiding.extend(between(offset).into_iter().map(|pair| pair.map(index)));
            Reach { offset, hiding: start..hiding.len() }
        });
        Self { reach: reach.collect(), hiding }
    }

    /// The cells in line of sight from `robot`, each with whether it is blocked.
    pub(super) fn look(&self, blocked: &Grid<bool>, robot: Cell) -> Vec<(Cell, bool)> {
        let Some(here) = blocked.frame().index(robot) else { return Vec::new() };
        let is_blocked = |by: i32| blocked.cells()[(here as i32 + by) as usize];
        let mut cells = Vec::with_capacity(self.reach.len());
        for Reach { offset: (dx, dy), hiding } in &self.reach {
            let cell = Cell::new(robot.x + dx, robot.y + dy);
            let Some(state) = blocked.get(cell) else { continue };
            // Without a branch for the second cell of a pair.
            if !self.hiding[hiding.clone()].iter().any(|[a, b]| is_blocked(*a) & is_blocked(*b)) {
                cells.push((cell, *state));
            }
        }
        cells
    }
}

impl GridSpec {
    /// For every cell, the cells that the robot sees from there if no block is in between, all by index. From
    /// inside a wall the robot sees nothing.
    pub fn sights(&self) -> Vec<Vec<usize>> {
        let (frame, walls) = (self.frame(), self.walls.cells());
        let line_of_sight = LineOfSight::new(self.sensor_radius, frame);
        let from = |index: usize| {
            let seen = line_of_sight.look(&self.walls, frame.cell(index));
            seen.into_iter().filter_map(|(cell, _)| frame.index(cell)).collect()
        };
        (0..frame.len()).map(|index| if walls[index] { Vec::new() } else { from(index) }).collect()
    }
}

/// What hides the cell at an offset: a cell (twice) through which the segment passes, and the two cells beside a corner.
fn between((x, y): Offset) -> Vec<[Offset; 2]> {
    let (long, short) = (x.abs().max(y.abs()), x.abs().min(y.abs()));
    let offset = |along: i32, across: i32| {
        let (dx, dy) = if x.abs() == long { (along, across) } else { (across, along) };
        (dx * x.signum(), dy * y.signum())
    };
    let mut hiding = Vec::new();
    for along in 0..long {
        // Where the segment enters and leaves a column, in units of a cell divided by 2 `long`.
        let [enters, leaves] = [2 * along - 1, 2 * along + 1].map(|half| half * short);
        if along > 0 {
            let cells = (enters - long).div_euclid(2 * long) + 1..=(leaves + long - 1).div_euclid(2 * long);
            hiding.extend(cells.map(|across| [offset(along, across); 2]));
        }
        if (leaves - long) % (2 * long) == 0 {
            let across = (leaves - long) / (2 * long);
            hiding.push([offset(along + 1, across), offset(along, across + 1)]);
        }
    }
    hiding
}

/// The offsets of all cells in reach: the cell of the robot, then by direction counter-clockwise from the right and from
/// near to far.
fn in_reach(radius: i32) -> Vec<Offset> {
    let square = (-radius..=radius).flat_map(|y| (-radius..=radius).map(move |x| (x, y)));
    let mut offsets: Vec<Offset> = square.filter(|(x, y)| x * x + y * y <= radius * radius).collect();
    let steps = |(x, y): Offset| x.abs() + y.abs();
    offsets.sort_unstable_by(|&a, &b| {
        let by_angle = if a == (0, 0) || b == (0, 0) { Ordering::Equal } else { by_direction(a, b) };
        (a != (0, 0)).cmp(&(b != (0, 0))).then(by_angle).then(steps(a).cmp(&steps(b)))
    });
    offsets
}

/// The order of directions, counter-clockwise from the right.
fn by_direction(a: Offset, b: Offset) -> Ordering {
    let is_lower_half = |(x, y): Offset| y < 0 || (y == 0 && x < 0);
    let cross = a.0 * b.1 - a.1 * b.0;
    is_lower_half(a).cmp(&is_lower_half(b)).then(0.cmp(&cross))
}
