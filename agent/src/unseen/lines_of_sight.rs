use interfaces::{Cell, GridFrame};
use std::f64::consts::TAU;

/// The cells on straight lines in a number of directions from a cell, relative to it, from the cell on. The lines have
/// the length `range_m`; they end where every map of this size ends.
pub(super) fn lines_of_sight(frame: &GridFrame, range_m: f64, directions: u32) -> Vec<Vec<Cell>> {
    let max_steps = 2 * (frame.width() + frame.height()) as u32;
    let steps = ((2.0 * range_m / frame.resolution_m()) as u32).min(max_steps);
    let line = |direction: u32| {
        let (sin, cos) = libm::sincos(TAU * f64::from(direction) / f64::from(directions));
        let offset = |slope: f64, step: u32| (slope * f64::from(step) / 2.0).round() as i32;
        let mut line: Vec<Cell> =
            (0..steps).map(|step| Cell::new(offset(cos, step), offset(sin, step))).collect();
        // Steps of half a cell often stay in a cell.
        line.dedup();
        line
    };
    (0..directions).map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    #[test]
    fn lines_are_the_cells_of_half_steps_without_repetitions() {
        let frame = |cells| GridFrame::new(Point2::origin(), 0.05, cells, cells).unwrap();
        let lines = lines_of_sight(&frame(400), 2.0, 240);
        assert_eq!(lines.len(), 240);
        for (direction, line) in lines.iter().enumerate() {
            let (sin, cos) = libm::sincos(TAU * direction as f64 / 240.0);
            let at = |step: i32, slope: f64| (slope * f64::from(step) / 2.0).round() as i32;
            let mut cells: Vec<Cell> = (0..80).map(|step| Cell::new(at(step, cos), at(step, sin))).collect();
            cells.dedup();
            assert_eq!(*line, cells);
        }
        // A long range takes no more memory than the map.
        let longest = lines_of_sight(&frame(10), 1e6, 4).iter().map(Vec::len).max();
        assert_eq!(longest, Some(21));
    }
}
