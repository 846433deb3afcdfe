//! Cells that are together as large as a thing, out of cells that change.
//!
//! The noise of a laser makes cells change one by one or a few together. What a robot can meet is larger: the two legs of a person, a
//! chair, the leaf of a door.

use interfaces::GridFrame;
use std::collections::BTreeSet;

/// A patch has at least this length and width, m, or this area in another form: as the legs of a person.
const PATCH_M: [f64; 2] = [0.3, 0.1];

/// The cells that are connected to an area of at least 0.1 m × 0.3 m; `cells` and the result are in ascending order.
pub(crate) fn areas(frame: &GridFrame, cells: &[usize]) -> Vec<usize> {
    let least = (PATCH_M[0] * PATCH_M[1] / frame.resolution_m().powi(2)).round().max(1.0) as usize;
    connected_where(frame, cells, |patch| patch.len() >= least)
}

/// The cells that are connected over at least 0.3 m along an axis of the grid, in ascending order as `cells`: of a thing that is seen
/// from one side, only the front changes, which is one cell deep.
pub(crate) fn fronts(frame: &GridFrame, cells: &[usize]) -> Vec<usize> {
    let least = (PATCH_M[0] / frame.resolution_m()).round().max(1.0) as i32;
    connected_where(frame, cells, |patch| frame.longer_side(patch) >= least)
}

/// The cells of all connected patches that are kept, in ascending order as `cells`.
fn connected_where(frame: &GridFrame, cells: &[usize], is_kept: impl Fn(&[usize]) -> bool) -> Vec<usize> {
    let mut left: BTreeSet<usize> = cells.iter().copied().collect();
    let mut found = Vec::new();
    while let Some(patch) = frame.take_connected(&mut left, 1) {
        if is_kept(&patch) {
            found.extend(patch);
        }
    }
    found.sort_unstable();
    found
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
        assert_eq!(left(areas, drawing), expected);
    }

    #[test]
    fn fronts_are_wide() {
        let drawing =
            ["######.#####", "............", "#...........", ".#..........", "..#.###.....", "...#...##..."];
        let expected =
            ["######......", "............", "#...........", ".#..........", "..#.###.....", "...#...##..."];
        assert_eq!(left(fronts, drawing), expected);
    }
}
