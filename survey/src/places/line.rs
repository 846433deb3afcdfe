//! Changes along a thin line: the leaf of a door, or the surface of a wall that a small error of the poses moves by a cell.

use mapper::Mapper;
use nalgebra::{Matrix2, Vector2};

/// What is at most this wide across its line, in cells, is no body.
const THIN_CELLS: f64 = 1.5;
/// A line is at least this long, m: the front of a person is shorter.
const LONG_M: f64 = 0.6;

/// Whether cells, by their indices, are a thin line, as long as a narrow door or longer. People, carts and boxes are wider.
pub fn is_line(mapper: &Mapper, cells: &[usize]) -> bool {
    let at = |index: &usize| {
        let cell = mapper.frame().cell(*index);
        Vector2::new(f64::from(cell.x), f64::from(cell.y))
    };
    let count = cells.len().max(1) as f64;
    let middle = cells.iter().map(at).sum::<Vector2<f64>>() / count;
    let spread = |index: &usize| (at(index) - middle) * (at(index) - middle).transpose();
    let variances = (cells.iter().map(spread).sum::<Matrix2<f64>>() / count).symmetric_eigenvalues();
    // The variance of a row of cells that is n cells long is (n² − 1) / 12.
    let cells_of = |variance: f64| (12.0 * variance.max(0.0) + 1.0).sqrt();
    let length_m = cells_of(variances.max()) * mapper.frame().resolution_m();
    cells_of(variances.min()) <= THIN_CELLS && length_m >= LONG_M
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Cell, GridFrame};
    use mapper::MapperSettings;
    use nalgebra::Point2;

    #[test]
    fn rows_of_cells_are_lines_in_every_direction_and_bodies_are_not() {
        let frame = GridFrame::new(Point2::origin(), 0.05, 60, 60).unwrap();
        let mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
        let is = |cells: &[(i32, i32)]| {
            let cells: Vec<usize> =
                cells.iter().filter_map(|(x, y)| frame.index(Cell { x: *x, y: *y })).collect();
            is_line(&mapper, &cells)
        };
        let row: Vec<(i32, i32)> = (5..20).map(|x| (x, 7)).collect();
        let slanted: Vec<(i32, i32)> = (5..25).map(|x| (x, x / 2)).collect();
        let body: Vec<(i32, i32)> = (5..11).flat_map(|x| (5..9).map(move |y| (x, y))).collect();
        assert!(is(&row) && is(&slanted) && !is(&body));
        assert!(!is(&row[..8]) && !is(&[]), "too short");
    }
}
