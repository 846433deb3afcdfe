//! Surfels from a known occupancy grid.

use super::SurfelMap;
use interfaces::{CellState, Grid};
use nalgebra::{Point2, Vector2};

/// The number of scans that a surfel of a known map counts as. Scans correct it soon.
const PRIOR_SCANS: u32 = 20;
/// A surface is fitted to the borders within this distance, m.
const FIT_M: f64 = 0.15;

impl SurfelMap {
    /// The surfaces of a known map: the borders between blocked and free cells, each with the line through the borders
    /// around it.
    pub(crate) fn from_grid(grid: &Grid<CellState>) -> Self {
        let mut map = Self::new(grid.frame());
        let borders = borders(grid);
        let resolution_m = grid.frame().resolution_m();
        let reach = FIT_M.max(1.5 * resolution_m);
        for (index, (at, outward)) in borders.iter().enumerate() {
            // Borders are listed row by row, so that neighbors are not far apart in the list.
            let (mut sum, mut normal, mut count) = (Vector2::zeros(), Vector2::zeros(), 0.0);
            let near = |other: &(Point2<f64>, Vector2<f64>)| (other.0 - at).norm_squared() <= reach * reach;
            let rows = (2.0 * reach / resolution_m) as usize + 2;
            let span = rows * 2 * grid.frame().width();
            let (low, high) = (index.saturating_sub(span), (index + span).min(borders.len()));
            for other in borders[low..high].iter().filter(|other| near(other)) {
                if other.1.dot(outward) >= 0.0 {
                    sum += other.0 - at;
                    normal += other.1;
                    count += 1.0;
                }
            }
            let length = normal.norm();
            if count < 2.0 || length < 1e-9 {
                continue;
            }
            let (middle, normal) = (at + sum / count, normal / length);
            // On the line through the middle, at the foot of the border.
            let foot = at - normal * normal.dot(&(at - middle));
            if map.nearest(&foot, &normal, 0.05).is_none() {
                map.add(foot, normal, PRIOR_SCANS);
            }
        }
        map
    }
}

/// The middles of the sides between blocked and free cells, each with the direction to the free side.
fn borders(grid: &Grid<CellState>) -> Vec<(Point2<f64>, Vector2<f64>)> {
    let frame = grid.frame();
    let mut borders = Vec::new();
    for index in (0..frame.len()).filter(|&index| grid.cells()[index] == CellState::Blocked) {
        let cell = frame.cell(index);
        for other in cell.neighbours4() {
            if grid.get(other) == Some(&CellState::Free) {
                let outward = Vector2::new(f64::from(other.x - cell.x), f64::from(other.y - cell.y));
                borders.push((frame.center(cell) + outward * (frame.resolution_m() / 2.0), outward));
            }
        }
    }
    borders
}
