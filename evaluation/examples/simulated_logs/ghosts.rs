//! Ghost surfaces: blocked cells of the map where the true world is free.

use crate::drive::SimulatedLog;
use nalgebra::{Isometry2, Point2};
use std::collections::BTreeSet;

/// The side of the cells, m.
const CELL_M: f64 = 0.1;
/// What is farther from all true surfaces than this number of cells is a ghost.
const NEAR: i32 = 3;

type Cells = BTreeSet<(i32, i32)>;

/// The share of the cells that are hit along a trajectory and are not near those that are hit along the true poses.
pub(crate) fn share(to_truth: &Isometry2<f64>, poses: &[Isometry2<f64>], log: &SimulatedLog) -> f64 {
    let hit = |poses: &mut dyn Iterator<Item = Isometry2<f64>>| {
        let mut cells = Cells::new();
        for (reading, pose) in log.readings.iter().zip(poses) {
            cells.extend(reading.hits().map(|hit| cell(&(pose * hit))));
        }
        cells
    };
    let truth = hit(&mut log.truth.iter().copied());
    let found = hit(&mut poses.iter().map(|pose| to_truth * pose));
    let is_ghost = |(x, y): &&(i32, i32)| {
        let rows = x - NEAR..=x + NEAR;
        rows.into_iter().all(|x| truth.range((x, y - NEAR)..=(x, y + NEAR)).next().is_none())
    };
    found.iter().filter(is_ghost).count() as f64 / found.len().max(1) as f64
}

fn cell(at: &Point2<f64>) -> (i32, i32) {
    ((at.x / CELL_M).floor() as i32, (at.y / CELL_M).floor() as i32)
}
