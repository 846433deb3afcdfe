//! Cells that are together as large as a thing, out of cells that change.
//!
//! The noise of a laser makes cells change one by one or a few together. What a robot can meet is larger: the two legs of a person, a
//! chair, the leaf of a door.

use interfaces::{Cell, GridFrame};
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
    let length = |patch: &[usize], along: fn(Cell) -> i32| {
        let places = || patch.iter().map(|index| along(frame.cell(*index)));
        places().max().unwrap_or_default() - places().min().unwrap_or_default() + 1
    };
    connected_where(frame, cells, |patch| {
        length(patch, |cell| cell.x).max(length(patch, |cell| cell.y)) >= least
    })
}

/// The cells of all connected patches that are kept, in ascending order as `cells`.
fn connected_where(frame: &GridFrame, cells: &[usize], is_kept: impl Fn(&[usize]) -> bool) -> Vec<usize> {
    let mut left: BTreeSet<usize> = cells.iter().copied().collect();
    let mut found = Vec::new();
    while let Some(first) = left.pop_first() {
        let patch = connected(frame, first, 1, &mut left);
        if is_kept(&patch) {
            found.extend(patch);
        }
    }
    found.sort_unstable();
    found
}

/// The cells of `left` that are connected with `first`, with it; they are removed from `left`. Cells are connected up to a distance
/// of `reach` along both axes: with 1, by sides or corners.
pub(crate) fn connected(
    frame: &GridFrame,
    first: usize,
    reach: i32,
    left: &mut BTreeSet<usize>,
) -> Vec<usize> {
    let (mut cells, mut next) = (vec![first], 0);
    while let Some(cell) = cells.get(next).map(|index| frame.cell(*index)) {
        next += 1;
        let around = cell.square(reach).filter_map(|cell| frame.index(cell));
        cells.extend(around.filter(|index| left.remove(index)));
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
