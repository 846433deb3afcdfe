//! Surfels from a known occupancy grid.

use super::SurfelMap;
use crate::constants::{SURFEL_M, THICK_M, TRUSTED_SCANS};
use crate::scan_points::ScanPoint;
use crate::work;
use interfaces::{Cell, CellState, Grid, GridFrame};
use nalgebra::{Isometry2, Point2, Vector2};

/// Scans as which a surfel of a known map counts: the next ones correct it.
const PRIOR_SCANS: u32 = 20;

/// The middle of a side between a blocked and a free cell: the blocked cell, the position and the direction to the free side.
type Border = (Cell, Point2<f64>, Vector2<f64>);

impl SurfelMap {
    /// Its surfaces in a map of another frame, as those of a known map.
    pub(crate) fn moved_to(&self, frame: &GridFrame) -> Self {
        let mut map = Self::new(frame);
        for surfel in self.usable() {
            map.add(surfel.at, surfel.normal, PRIOR_SCANS);
        }
        map
    }

    /// The surfaces of a known map: the borders between blocked and free cells, each with the line through the borders
    /// around it.
    pub(crate) fn from_grid(grid: &Grid<CellState>) -> Self {
        let mut map = Self::new(grid.frame());
        let borders = borders(grid);
        // Where the borders of each row begin, and where those of the last one end.
        let height = grid.frame().height() as i32;
        let rows: Vec<usize> =
            (0..=height).map(|row| borders.partition_point(|(cell, ..)| cell.y < row)).collect();
        let resolution_m = grid.frame().resolution_m();
        // Between surfels that are farther apart than SURFEL_M, there would be gaps.
        let pieces = (resolution_m / SURFEL_M).ceil() as u32;
        // Small cells are smoothed, for walls at an angle to them. A border of a large cell is a surface of its own: those around a
        // corner would turn it, and those of the next row would move it.
        let (around, min_dot, min_count) = if pieces > 2 { (1.0, 0.5, 1.0) } else { (1.5, 0.0, 2.0) };
        let reach = THICK_M.max(around * resolution_m);
        let cells = (reach / resolution_m) as i32 + 2;
        for (Cell { x, y }, at, outward) in &borders {
            let (mut sum, mut normal, mut count) = (Vector2::zeros(), Vector2::zeros(), 0.0);
            for row in (y - cells).max(0)..(y + cells).min(height) {
                let row = &borders[rows[row as usize]..rows[row as usize + 1]];
                let first = row.partition_point(|(cell, ..)| cell.x < x - cells);
                for other in row[first..].iter().take_while(|(cell, ..)| cell.x <= x + cells) {
                    work::count(1);
                    let to = other.1 - at;
                    if to.norm_squared() <= reach * reach && other.2.dot(outward) >= min_dot {
                        sum += to;
                        normal += other.2;
                        count += 1.0;
                    }
                }
            }
            let length = normal.norm();
            if count < min_count || length < 1e-9 {
                continue;
            }
            let (middle, normal) = (at + sum / count, normal / length);
            // On the line through the middle, at the foot of the border.
            let foot = at - normal * normal.dot(&(at - middle));
            let along = Vector2::new(-normal.y, normal.x) * (resolution_m / f64::from(pieces));
            for piece in 0..pieces {
                let part = foot + along * (f64::from(piece) - f64::from(pieces - 1) / 2.0);
                if map.nearest(&part, &normal, SURFEL_M / 2.0).is_none() {
                    map.add(part, normal, PRIOR_SCANS);
                }
            }
        }
        map
    }
}

/// The borders of a map, row by row and from left to right.
pub(super) fn borders(grid: &Grid<CellState>) -> Vec<Border> {
    let frame = grid.frame();
    let mut borders = Vec::new();
    for index in (0..frame.len()).filter(|&index| grid.cells()[index] == CellState::Blocked) {
        let cell = frame.cell(index);
        for other in cell.neighbours4() {
            if grid.get(other) == Some(&CellState::Free) {
                let outward = Vector2::new(f64::from(other.x - cell.x), f64::from(other.y - cell.y));
                borders.push((cell, frame.center(cell) + outward * (frame.resolution_m() / 2.0), outward));
            }
        }
    }
    borders
}

// A line map as a list of points on surfaces, and back: what is kept of a map that is rarely needed.

/// No map of points is larger, m.
const MAX_PLACE_M: f64 = 200.0;

impl SurfelMap {
    /// All surfels that take part in matching, in a frame whose pose in the frame of the map is `pose`.
    pub(crate) fn points(&self, pose: &Isometry2<f64>) -> Vec<ScanPoint> {
        let back = pose.inverse();
        let point = |(beam, surfel): (usize, &crate::surfel_map::Surfel)| ScanPoint {
            beam,
            ..ScanPoint::new(back * surfel.at, back.rotation * surfel.normal)
        };
        self.usable().enumerate().map(point).collect()
    }

    /// The map of some points, all with full weight.
    pub(crate) fn of_points(points: &[ScanPoint]) -> Option<Self> {
        let first = points.first()?.at;
        let (low, high) = points.iter().fold((first, first), |(low, high), point| {
            (low.coords.inf(&point.at.coords).into(), high.coords.sup(&point.at.coords).into())
        });
        let size: Vector2<f64> = high - low;
        if size.max() > MAX_PLACE_M {
            return None;
        }
        let origin: Point2<f64> = low - Vector2::repeat(SURFEL_M);
        let frame = GridFrame::covering(origin, size.x + 2.0 * SURFEL_M, size.y + 2.0 * SURFEL_M, SURFEL_M)?;
        let mut map = Self::new(&frame);
        for point in points {
            map.add(point.at, point.normal, TRUSTED_SCANS);
        }
        Some(map)
    }
}
