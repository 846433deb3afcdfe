//! Surfels from a known occupancy grid.

use super::SurfelMap;
use crate::work;
use interfaces::{Cell, CellState, Grid};
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
        let borders = Borders::of(grid);
        let resolution_m = grid.frame().resolution_m();
        let reach = FIT_M.max(1.5 * resolution_m);
        let cells = (reach / resolution_m).ceil() as i32 + 1;
        for border in &borders.all {
            if let Some((foot, normal)) = border.fitted(borders.around(border, cells), reach)
                && map.nearest(&foot, &normal, 0.05).is_none()
            {
                map.add(foot, normal, PRIOR_SCANS);
            }
        }
        map
    }
}

/// The middle of a side between a blocked and a free cell, with the direction to the free side.
pub(super) struct Border {
    /// The blocked cell.
    cell: Cell,
    at: Point2<f64>,
    outward: Vector2<f64>,
}

impl Border {
    /// The line through the borders up to `reach` (m) away, as a point and a normal, if there are enough.
    pub(super) fn fitted<'a>(
        &self,
        others: impl Iterator<Item = &'a Self>,
        reach: f64,
    ) -> Option<(Point2<f64>, Vector2<f64>)> {
        let (mut sum, mut normal, mut count) = (Vector2::zeros(), Vector2::zeros(), 0.0);
        for other in others {
            work::count(1);
            let to = other.at - self.at;
            if to.norm_squared() <= reach * reach && other.outward.dot(&self.outward) >= 0.0 {
                sum += to;
                normal += other.outward;
                count += 1.0;
            }
        }
        let length = normal.norm();
        if count < 2.0 || length < 1e-9 {
            return None;
        }
        let (middle, normal) = (self.at + sum / count, normal / length);
        // On the line through the middle, at the foot of the border.
        Some((self.at - normal * normal.dot(&(self.at - middle)), normal))
    }
}

/// All borders of a map, row by row, and from left to right in each.
pub(super) struct Borders {
    pub(super) all: Vec<Border>,
    /// Where the borders of each row begin, and the end of the last one.
    rows: Vec<usize>,
}

impl Borders {
    pub(super) fn of(grid: &Grid<CellState>) -> Self {
        let frame = grid.frame();
        let (mut all, mut rows) = (Vec::new(), Vec::with_capacity(frame.height() + 1));
        for index in 0..frame.len() {
            let cell = frame.cell(index);
            if cell.x == 0 {
                rows.push(all.len());
            }
            if grid.cells()[index] != CellState::Blocked {
                continue;
            }
            for other in cell.neighbours4() {
                if grid.get(other) == Some(&CellState::Free) {
                    let outward = Vector2::new(f64::from(other.x - cell.x), f64::from(other.y - cell.y));
                    let at = frame.center(cell) + outward * (frame.resolution_m() / 2.0);
                    all.push(Border { cell, at, outward });
                }
            }
        }
        rows.push(all.len());
        Self { all, rows }
    }

    /// The borders of the blocked cells up to a number of cells around a border, in their order.
    fn around(&self, border: &Border, cells: i32) -> impl Iterator<Item = &Border> {
        let Cell { x, y } = border.cell;
        let last = self.rows.len() as i32 - 2;
        ((y - cells).max(0)..=(y + cells).min(last)).flat_map(move |row| {
            let row = &self.all[self.rows[row as usize]..self.rows[row as usize + 1]];
            let first = row.partition_point(|other| other.cell.x < x - cells);
            row[first..].iter().take_while(move |other| other.cell.x <= x + cells)
        })
    }
}
