//! The length of the shortest path to a goal, from every cell.

use interfaces::{Cell, GridFrame};
use nalgebra::{Point2, Vector2};

/// The cost of a step to a cell that shares a side, and to one that shares a corner: 5 : 7 is √2 within 1 %.
const SIDE: u16 = 5;
const CORNER: u16 = 7;
/// More buckets than the largest cost.
const BUCKETS: usize = 8;
/// The cost of a cell from which no path leads to the goal.
const UNREACHED: u16 = u16::MAX;
/// The largest cost: cells that are farther away count as unreached.
const FARTHEST: u16 = UNREACHED - CORNER - 1;

/// The distances to one goal.
#[derive(Clone, Debug)]
pub(crate) struct Distances {
    costs: Box<[u16]>,
    /// The neighbor that is nearest to the goal, as an index of [`NEIGHBORS`]; [`NO_NEIGHBOR`] for a cell without one.
    nearer: Box<[u8]>,
}

const NO_NEIGHBOR: u8 = u8::MAX;

impl Distances {
    /// The distances to the cell `goal` (an index) through cells for which `is_free` is true.
    pub(crate) fn new(frame: &GridFrame, is_free: &[bool], goal: usize) -> Self {
        let mut costs = vec![UNREACHED; frame.len()].into_boxed_slice();
        let mut buckets: [Vec<usize>; BUCKETS] = Default::default();
        costs[goal] = 0;
        buckets[0].push(goal);
        let (mut cost, mut waiting) = (0_u16, 1_usize);
        while waiting > 0 && cost <= FARTHEST {
            while let Some(index) = buckets[usize::from(cost) % BUCKETS].pop() {
                waiting -= 1;
                if costs[index] != cost {
                    continue;
                }
                for (near, (_, _, step)) in neighbors(frame, index).zip(NEIGHBORS) {
                    let Some(near) = near else { continue };
                    if is_free[near] && costs[near] > cost + step {
                        costs[near] = cost + step;
                        buckets[usize::from(cost + step) % BUCKETS].push(near);
                        waiting += 1;
                    }
                }
            }
            cost += 1;
        }
        let nearer = (0..costs.len()).map(|index| {
            let neighbors = (0..).zip(neighbors(frame, index));
            let near = neighbors.filter_map(|(number, near)| Some((number, near?)));
            near.min_by_key(|(_, near)| costs[*near]).map_or(NO_NEIGHBOR, |(number, _)| number)
        });
        Self { nearer: nearer.collect(), costs }
    }

    /// The free cell at `point` (m), or the nearest one to the goal within two cells.
    fn cell_near(&self, frame: &GridFrame, point: &Point2<f64>) -> Option<usize> {
        let cell = frame.cell_at(point);
        let own = frame.index(cell).filter(|index| self.costs[*index] != UNREACHED);
        own.or_else(|| {
            let near = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| Cell::new(cell.x + dx, cell.y + dy)));
            let reached =
                near.filter_map(|cell| frame.index(cell)).filter(|index| self.costs[*index] != UNREACHED);
            reached.min_by_key(|index| self.costs[*index])
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
            let (dx, dy, _) = NEIGHBORS.get(usize::from(self.nearer[index]))?;
            index = index.checked_add_signed(*dy as isize * frame.width() as isize + *dx as isize)?;
        }
        (frame.center(frame.cell(index)) - point).try_normalize(1e-6)
    }
}

/// The neighbors of a cell that are on the map, in the order of [`NEIGHBORS`].
fn neighbors(frame: &GridFrame, index: usize) -> impl Iterator<Item = Option<usize>> {
    let cell = frame.cell(index);
    NEIGHBORS.iter().map(move |(dx, dy, _)| frame.index(Cell::new(cell.x + dx, cell.y + dy)))
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
