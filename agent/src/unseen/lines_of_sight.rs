use interfaces::{Cell, GridFrame};
use std::f64::consts::TAU;

/// The cells on straight lines in all directions from a cell, computed once for a map.
#[derive(Clone, Debug, Default)]
pub(super) struct LinesOfSight {
    /// The cells of all lines relative to their start, from the start on.
    offsets: Vec<Cell>,
    /// The end of each line in `offsets`.
    ends: Vec<usize>,
}

impl LinesOfSight {
    /// Lines with the length `range_m` in a number of directions; they end where every map of this size ends.
    pub(super) fn new(frame: &GridFrame, range_m: f64, directions: u32) -> Self {
        let most = 2 * (frame.width() + frame.height()) as u32;
        let steps = ((2.0 * range_m / frame.resolution_m()) as u32).min(most);
        let mut lines = Self::default();
        for direction in 0..directions {
            let (sin, cos) = libm::sincos(TAU * f64::from(direction) / f64::from(directions));
            let start = lines.offsets.len();
            for step in 0..steps {
                let offset = |slope: f64| (slope * f64::from(step) / 2.0).round() as i32;
                let cell = Cell::new(offset(cos), offset(sin));
                // Steps of half a cell often stay in a cell.
                if lines.offsets[start..].last() != Some(&cell) {
                    lines.offsets.push(cell);
                }
            }
            lines.ends.push(lines.offsets.len());
        }
        lines
    }

    /// The lines, as cells relative to their start.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[Cell]> {
        let starts = std::iter::once(&0).chain(&self.ends);
        starts.zip(&self.ends).map(|(&start, &end)| &self.offsets[start..end])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    #[test]
    fn lines_are_the_cells_of_half_steps_without_repetitions() {
        let frame = |cells| GridFrame::new(Point2::origin(), 0.05, cells, cells).unwrap();
        let lines = LinesOfSight::new(&frame(400), 2.0, 240);
        assert_eq!(lines.iter().count(), 240);
        for (direction, line) in lines.iter().enumerate() {
            let (sin, cos) = libm::sincos(TAU * direction as f64 / 240.0);
            let at = |step: i32, slope: f64| (slope * f64::from(step) / 2.0).round() as i32;
            let mut cells: Vec<Cell> = (0..80).map(|step| Cell::new(at(step, cos), at(step, sin))).collect();
            cells.dedup();
            assert_eq!(line, cells);
        }
        // A long range takes no more memory than the map.
        let longest = LinesOfSight::new(&frame(10), 1e6, 4).iter().map(<[Cell]>::len).max();
        assert_eq!(longest, Some(21));
    }
}
