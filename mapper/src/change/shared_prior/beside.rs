//! Which traversable cells lie beside each other.

use interfaces::GridFrame;

/// The cells before and below a cell. A cell is known by its position in the list of all cells, plus one; 0 is no cell. Lists of
/// values begin with a value for "no cell", so that nothing asks whether a neighbor exists.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Links {
    /// The cell before the cell in its row.
    pub(super) before: u32,
    /// The cells below and to the left, below, and below and to the right.
    pub(super) below: [u32; 3],
}

/// The links of all cells; the first are those of no cell.
pub(super) fn links(frame: &GridFrame, cells: &[u32]) -> Vec<Links> {
    let width = frame.width() as u32;
    let mut links = Vec::with_capacity(cells.len() + 1);
    links.push(Links::default());
    // The first cell that is not before the place below and to the left, and the index at which the row begins.
    let (mut first, mut row) = (0, 0);
    for (position, &index) in cells.iter().enumerate() {
        while index - row >= width {
            row += width;
        }
        while cells[first] + width + 1 < index {
            first += 1;
        }
        let column = index - row;
        let is_after_another = column > 0 && position > 0 && cells[position - 1] + 1 == index;
        let mut below = [0; 3];
        for (at, cell) in cells[first..position].iter().enumerate().take(3) {
            // 0 for the place to the left, 1 below, 2 to the right.
            let side = (cell + width + 1).wrapping_sub(index) as usize;
            let is_in_row = (side > 0 || column > 0) && (side < 2 || column + 1 < width);
            if side < 3 && is_in_row {
                below[side] = (first + at) as u32 + 1;
            }
        }
        links.push(Links { before: if is_after_another { position as u32 } else { 0 }, below });
    }
    links
}
