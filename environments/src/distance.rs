//! The length of the shortest path to a goal, from every cell.

use interfaces::{Cell, GridFrame};
use nalgebra::{Point2, Vector2};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The cost of a step to a cell that shares a side, and to one that shares a corner: 5 : 7 is √2 within 1 %.
const SIDE: u16 = 5;
const CORNER: u16 = 7;
/// The cost of a cell from which no path leads to the goal, or only a longer one.
const UNREACHED: u16 = u16::MAX;

/// The distances to one goal.
#[derive(Clone, Debug)]
pub(crate) struct Distances {
    costs: Vec<u16>,
}

impl Distances {
    /// The distances to the cell `goal` (an index) through cells for which `is_free` is true.
    pub(crate) fn new(frame: &GridFrame, is_free: &[bool], goal: usize) -> Self {
        let mut costs = vec![UNREACHED; frame.len()];
        let mut open = BinaryHeap::from([Reverse((0, goal))]);
        costs[goal] = 0;
        while let Some(Reverse((cost, index))) = open.pop() {
            if costs[index] != cost {
                continue;
            }
            for (near, step) in neighbors(frame, index).filter(|(near, _)| is_free[*near]) {
                let next = cost.saturating_add(step);
                if next < costs[near] {
                    costs[near] = next;
                    open.push(Reverse((next, near)));
                }
            }
        }
        Self { costs }
    }

    /// The free cell at `point` (m), or the nearest one to the goal within two cells.
    fn cell_near(&self, frame: &GridFrame, point: &Point2<f64>) -> Option<usize> {
        let cell = frame.cell_at(point);
        let own = frame.index(cell).filter(|index| self.costs[*index] != UNREACHED);
        own.or_else(|| {
            let near = cell.square(2).filter_map(|cell| frame.index(cell));
            near.filter(|index| self.costs[*index] != UNREACHED).min_by_key(|index| self.costs[*index])
        })
    }

    /// The length of the shortest path from `point` (m) to the goal, m; `None` where there is none.
    pub(crate) fn at_m(&self, frame: &GridFrame, point: &Point2<f64>) -> Option<f64> {
        let index = self.cell_near(frame, point)?;
        Some(f64::from(self.costs[index]) / f64::from(SIDE) * frame.resolution_m())
    }

    /// The unit vector from `point` (m) to the place that is `ahead_m` farther along the shortest path; `None` at the
    /// goal, and where there is no path.
    pub(crate) fn direction(
        &self,
        frame: &GridFrame,
        point: &Point2<f64>,
        ahead_m: f64,
    ) -> Option<Vector2<f64>> {
        let mut index = self.cell_near(frame, point)?;
        let end = self.costs[index].saturating_sub((ahead_m / frame.resolution_m() * f64::from(SIDE)) as u16);
        while self.costs[index] > end {
            index = neighbors(frame, index).map(|(near, _)| near).min_by_key(|near| self.costs[*near])?;
        }
        (frame.center(frame.cell(index)) - point).try_normalize(1e-6)
    }
}

/// The neighbors of a cell that are on the map, with the costs of a step to them, in the order of [`NEIGHBORS`].
fn neighbors(frame: &GridFrame, index: usize) -> impl Iterator<Item = (usize, u16)> {
    let cell = frame.cell(index);
    let on_map = move |(dx, dy, cost)| Some((frame.index(Cell::new(cell.x + dx, cell.y + dy))?, cost));
    NEIGHBORS.into_iter().filter_map(on_map)
}

const NEIGHBORS: [(i32, i32, u16); 8] = [
    (1, 0, SIDE),
    (0, 1, SIDE),
    (-1, 0, SIDE),
    (0, -1, SIDE),
    (1, 1, CORNER),
    (-1, 1, CORNER),
    (-1, -1, CORNER),
    (1, -1, CORNER),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_goes_round_a_wall() {
        // The goal is in the lower left corner, a wall stands in the middle column below the top row.
        let map = ["....", ".#..", ".#.."];
        let is_free: Vec<bool> =
            map.iter().rev().flat_map(|row| row.bytes().map(|cell| cell == b'.')).collect();
        let frame = GridFrame::new(Point2::origin(), 1.0, 4, 3).unwrap();
        let distances = Distances::new(&frame, &is_free, 0);
        let at_m = |x, y| distances.at_m(&frame, &Point2::new(x, y));
        assert_eq!(at_m(0.5, 0.5), Some(0.0));
        assert_eq!(at_m(0.5, 2.5), Some(2.0));
        // Two corners and two sides: 0,0 → 0,1 → 1,2 → 2,1 → 2,0.
        assert_eq!(at_m(2.5, 0.5), Some((2.0 * 5.0 + 2.0 * 7.0) / 5.0));
        // Inside of the wall: as from the free cell nearest to the goal.
        assert_eq!(at_m(1.5, 0.5), Some(0.0));
        assert_eq!(at_m(50.0, 0.5), None);
        let ahead = distances.direction(&frame, &Point2::new(2.5, 0.5), 1.0).unwrap();
        assert_eq!((ahead.x, ahead.y), (0.0, 1.0));
        assert_eq!(distances.direction(&frame, &Point2::new(0.5, 0.5), 1.0), None);
    }
}
