//! The footprint of a scan: the set of cells that its beams passed through, each cell once.
//!
//! Between two neighboring beams the scan covers a triangle. All triangles together form a star-shaped polygon,
//! which is filled row by row: a cell counts as passed if its center is inside. This visits each cell once, in
//! memory order; following every beam would visit the cells near the sensor hundreds of times.
//!
//! Where neighboring beams are farther apart than `max_gap_m`, a thin obstacle could be between them. There the
//! polygon (the fan) ends, and only the cells on the beams themselves count.

use super::projection::ProjectedScan;
use interfaces::{Cell, GridFrame};
use nalgebra::{Point2, Vector2};

/// Scratch memory for filling footprints, reused from scan to scan.
#[derive(Clone, Debug, Default)]
pub(in crate::occupancy) struct Footprint {
    /// For each row of the grid, the columns at which the border of the polygon crosses the center line of the row.
    crossings: Vec<Vec<f64>>,
}

impl Footprint {
    /// Calls `run(start, end)` for the runs of cells (indices in row-major order) inside the fan, each cell once.
    /// `is_joined(beam)` states whether a beam and the next beam ended on the same surface.
    pub(in crate::occupancy) fn fill(
        &mut self,
        scan: &ProjectedScan,
        frame: &GridFrame,
        max_gap_m: f64,
        is_joined: impl Fn(usize) -> bool,
        mut run: impl FnMut(usize, usize),
    ) {
        let fan_m = fan_m(scan, max_gap_m);
        let (low, high) = self.cross(scan, frame, fan_m, is_joined);
        for row in low..high {
            let crossings = &mut self.crossings[row];
            crossings.sort_unstable_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                let (start, end) = (first_after(pair[0], frame.width()), first_after(pair[1], frame.width()));
                if start < end {
                    run(row * frame.width() + start, row * frame.width() + end);
                }
            }
            crossings.clear();
        }
    }

    /// Collects the crossings of the border of the polygon with each row; returns the range of rows.
    fn cross(
        &mut self,
        scan: &ProjectedScan,
        frame: &GridFrame,
        fan_m: f64,
        is_joined: impl Fn(usize) -> bool,
    ) -> (usize, usize) {
        self.crossings.resize_with(frame.height(), Vec::new);
        let scale = 1.0 / frame.resolution_m();
        let origin = (scan.origin - frame.origin()) * scale;
        let point = |beam: usize, range_m: f64| origin + scan.directions[beam] * (range_m * scale);
        let (mut low, mut high) = (frame.height(), 0);
        let mut edge = |from: Vector2<f64>, to: Vector2<f64>| {
            let (bottom, top) = if from.y <= to.y { (from, to) } else { (to, from) };
            let (first, end) = (first_after(bottom.y, frame.height()), first_after(top.y, frame.height()));
            if first < end {
                let slope = (top.x - bottom.x) / (top.y - bottom.y);
                for row in first..end {
                    self.crossings[row].push(bottom.x + (row as f64 + 0.5 - bottom.y) * slope);
                }
                (low, high) = (low.min(first), high.max(end));
            }
        };
        // The end of the border so far, on a beam with this range.
        let (mut last, mut last_m) = (origin, f64::NAN);
        for beam in 0..scan.len() {
            let Some(next) = scan.next(beam) else { break };
            let clear = |beam: usize| scan.returns[beam].clear_m().min(fan_m);
            let (mut from_m, mut to_m) = (clear(beam), clear(next));
            if !is_joined(beam) {
                // Where the surface jumps, only the shorter range holds for the whole triangle.
                from_m = from_m.min(to_m);
                to_m = from_m;
            }
            if from_m != last_m {
                let from = point(beam, from_m);
                if beam > 0 || !scan.is_full_turn {
                    edge(last, from);
                }
                last = from;
            }
            let to = point(next, to_m);
            edge(last, to);
            (last, last_m) = (to, to_m);
            if next == 0 {
                // The polygon closes where the first triangle began.
                let first_m = if is_joined(0) { clear(0) } else { clear(0).min(clear(1)) };
                edge(last, point(0, first_m));
                return (low, high);
            }
        }
        edge(last, origin);
        (low, high)
    }
}

/// The range of the fan, m.
fn fan_m(scan: &ProjectedScan, max_gap_m: f64) -> f64 {
    max_gap_m / scan.spacing_rad.max(f64::MIN_POSITIVE)
}

/// Calls `visit` for the cells (indices in row-major order) that single beams passed beyond
/// the fan; a cell on two beams is visited twice.
pub(in crate::occupancy) fn beyond_fan(
    scan: &ProjectedScan,
    frame: &GridFrame,
    max_gap_m: f64,
    mut visit: impl FnMut(usize),
) {
    let fan_m = fan_m(scan, max_gap_m);
    for beam in 0..scan.len() {
        let clear_m = scan.returns[beam].clear_m();
        if clear_m > fan_m {
            cells_along(frame, &scan.point(beam, fan_m), &scan.point(beam, clear_m), &mut visit);
        }
    }
}

/// The first column (or row) whose center is after `at`, at most `count`. Column i has the center i + 1/2. An
/// interval therefore covers the columns from `first_after` its start to just before `first_after` its end.
#[inline]
fn first_after(at: f64, count: usize) -> usize {
    // A cast from f64 to usize is slow where there is no instruction for it.
    (at + 0.5).max(0.0).min(count as f64) as u32 as usize
}

/// The parameters (shares of its length) at which the segment from `at` to `at + delta` enters and leaves the grid
/// (Liang and Barsky's clipping; all in cells). `None` if the segment misses the grid.
fn clip(frame: &GridFrame, at: Vector2<f64>, delta: Vector2<f64>) -> Option<(f64, f64)> {
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for (at, delta, count) in [(at.x, delta.x, frame.width()), (at.y, delta.y, frame.height())] {
        let count = count as f64;
        if delta != 0.0 {
            let (low, high) = (-at / delta, (count - at) / delta);
            (enter, leave) = (enter.max(low.min(high)), leave.min(low.max(high)));
        } else if !(0.0..count).contains(&at) {
            return None;
        }
    }
    (enter <= leave).then_some((enter, leave))
}

/// Calls `visit` for every cell of the grid (indices in row-major order) that the segment from
/// `from` to `to` passes through, in order, once each (Amanatides and Woo's traversal).
#[inline]
pub(in crate::occupancy) fn cells_along(
    frame: &GridFrame,
    from: &Point2<f64>,
    to: &Point2<f64>,
    mut visit: impl FnMut(usize),
) {
    let scale = 1.0 / frame.resolution_m();
    let (at, delta) = ((from - frame.origin()) * scale, (to - from) * scale);
    let (mut cell, mut end) = (frame.cell_at(from), frame.cell_at(to));
    if !frame.contains(cell) || !frame.contains(end) {
        let Some((enter, leave)) = clip(frame, at, delta) else { return };
        let inside = |share: f64| {
            let Cell { x, y } = frame.cell_at(&from.lerp(to, share));
            Cell::new(x.clamp(0, frame.width() as i32 - 1), y.clamp(0, frame.height() as i32 - 1))
        };
        (cell, end) = (inside(enter), inside(leave));
    }
    // For each axis: the direction of a step, and the shares of the segment to the next border and between borders.
    let axis = |at: f64, cell: i32, end: i32, delta: f64| {
        let step = (end - cell).signum();
        let border = f64::from(cell + i32::from(step > 0));
        if step == 0 { (0, f64::INFINITY, 0.0) } else { (step, (border - at) / delta, 1.0 / delta.abs()) }
    };
    let (step_x, mut next_x, width_x) = axis(at.x, cell.x, end.x, delta.x);
    let (step_y, mut next_y, width_y) = axis(at.y, cell.y, end.y, delta.y);
    let mut visit = |cell: Cell| visit(cell.y as usize * frame.width() + cell.x as usize);
    visit(cell);
    // The loop compares cells, not positions: rounding can never miss the end.
    while cell != end {
        if cell.y == end.y || (cell.x != end.x && next_x < next_y) {
            cell.x += step_x;
            next_x += width_x;
        } else {
            cell.y += step_y;
            next_y += width_y;
        }
        visit(cell);
    }
}

#[cfg(test)]
mod tests;
