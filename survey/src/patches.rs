//! Cells that are together as large as a thing, out of cells that change.
//!
//! The noise of a laser makes cells change one by one, and along the surface of a wall in lines that are one cell deep. What a
//! robot can meet is larger: the two legs of a person, a chair, the leaf of a door.

use interfaces::{Cell, GridFrame};
use std::collections::BTreeSet;

/// What passes is at least this deep everywhere, m: noise at a surface is one cell of 0.05 m deep.
const DEPTH_M: f64 = 0.1;
/// A patch is at least this wide and long, m, or has this area in another form: as the legs of a person who stands.
const PATCH_M: [f64; 2] = [0.1, 0.3];

/// The cells of all squares of 0.1 m that are filled (a morphological opening), in ascending order as `cells`: lines that are one cell
/// deep are none.
pub(crate) fn opened(frame: &GridFrame, cells: &[usize]) -> Vec<usize> {
    let side = (DEPTH_M / frame.resolution_m()).round().max(1.0) as i32;
    let square = |corner: Cell| {
        (0..side).flat_map(move |y| (0..side).map(move |x| Cell::new(corner.x + x, corner.y + y)))
    };
    let is_in = |cell: Cell| frame.index(cell).is_some_and(|index| cells.binary_search(&index).is_ok());
    let corners = cells.iter().map(|index| frame.cell(*index)).filter(|corner| square(*corner).all(is_in));
    let kept: BTreeSet<usize> = corners.flat_map(square).filter_map(|cell| frame.index(cell)).collect();
    kept.into_iter().collect()
}

/// The cells that are connected to a patch of at least 0.1 m × 0.3 m, in ascending order.
pub(crate) fn patches(frame: &GridFrame, cells: &[usize]) -> Vec<usize> {
    let mut left: BTreeSet<usize> = cells.iter().copied().collect();
    let least = (PATCH_M[0] * PATCH_M[1] / frame.resolution_m().powi(2)).round().max(1.0) as usize;
    let mut found = Vec::new();
    while let Some(first) = left.pop_first() {
        let patch = connected(frame, first, &mut left);
        if patch.len() >= least {
            found.extend(patch);
        }
    }
    found.sort_unstable();
    found
}

/// The cells of `left` that are connected with `first` by sides or corners, with it; they are removed from `left`.
fn connected(frame: &GridFrame, first: usize, left: &mut BTreeSet<usize>) -> Vec<usize> {
    let (mut cells, mut next) = (vec![first], 0);
    while let Some(Cell { x, y }) = cells.get(next).map(|index| frame.cell(*index)) {
        next += 1;
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| Cell::new(x + dx, y + dy)));
        cells.extend(around.filter_map(|cell| frame.index(cell)).filter(|index| left.remove(index)));
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    type Filter = fn(&GridFrame, &[usize]) -> Vec<usize>;

    /// The cells that are left of a drawing in cells of 0.05 m.
    fn left<const ROWS: usize>(filter: Filter, drawing: [&str; ROWS]) -> [String; ROWS] {
        let frame = GridFrame::new(Point2::origin(), 0.05, drawing[0].len(), ROWS).unwrap();
        let text = drawing.concat();
        let cells: Vec<usize> = text.match_indices('#').map(|(index, _)| index).collect();
        let kept = filter(&frame, &cells);
        let mark = |index: usize| if kept.binary_search(&index).is_ok() { '#' } else { '.' };
        let width = drawing[0].len();
        std::array::from_fn(|row| (row * width..(row + 1) * width).map(mark).collect())
    }

    #[test]
    fn single_cells_and_small_patches_are_no_things() {
        let drawing = [
            "#.........#######...",
            "....................",
            "######........###...",
            "######........###...",
            "..............###..#",
            "############........",
        ];
        let expected = [
            "....................",
            "....................",
            "######..............",
            "######..............",
            "....................",
            "############........",
        ];
        assert_eq!(left(patches, drawing), expected);
    }

    #[test]
    fn what_is_one_cell_deep_does_not_pass() {
        let drawing = ["####....", "########", "####...#", "..#.....", ".....##."];
        assert_eq!(left(opened, drawing), ["####....", "####....", "####....", "........", "........"]);
    }
}
