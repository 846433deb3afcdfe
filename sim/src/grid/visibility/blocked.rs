use super::shifted;
use interfaces::{Cell, Grid};

/// The blocked cells: a bit each, in rows of words, with a rim as wide as the range of the sensor, so that the
/// sensor never leaves the bits.
#[derive(Clone, Debug)]
pub(in crate::grid) struct BlockedCells {
    /// The number of columns and of rows.
    pub(super) width: i32,
    pub(super) height: i32,
    rim: usize,
    /// The number of words of a row. A square may begin in the last but one.
    stride: usize,
    words: Vec<u64>,
}

impl BlockedCells {
    /// The walls, for a sensor of `radius`.
    pub(in crate::grid) fn new(walls: &Grid<bool>, radius: u32) -> Self {
        let (width, height, rim) = (walls.frame().width(), walls.frame().height(), radius as usize);
        let stride = (width + 2 * rim) / 64 + 2;
        let words = vec![0; stride * (height + 2 * rim)];
        let mut blocked = Self { width: width as i32, height: height as i32, rim, stride, words };
        for (index, _) in walls.cells().iter().enumerate().filter(|(_, wall)| **wall) {
            blocked.set(walls.frame().cell(index), true);
        }
        blocked
    }

    /// Whether a cell of the grid, or of the rim around it, is blocked.
    #[inline]
    pub(in crate::grid) fn get(&self, cell: Cell) -> bool {
        let (word, bit) = self.position(cell);
        self.words[word] >> bit & 1 == 1
    }

    /// Blocks or frees a cell of the grid.
    #[inline]
    pub(in crate::grid) fn set(&mut self, cell: Cell, is_blocked: bool) {
        let (word, bit) = self.position(cell);
        self.words[word] = self.words[word] & !(1 << bit) | u64::from(is_blocked) << bit;
    }

    #[inline]
    fn position(&self, cell: Cell) -> (usize, usize) {
        let column = (cell.x + self.rim as i32) as usize;
        ((cell.y + self.rim as i32) as usize * self.stride + column / 64, column % 64)
    }

    /// Copies the cells of the square with a side of `side` cells around `robot`, row by row from the bottom and
    /// without gaps.
    #[inline]
    pub(super) fn copy_square(&self, robot: Cell, side: usize, square: &mut [u64]) {
        let (column, bottom) = (robot.x as usize, robot.y as usize);
        let mut at = 0;
        square[0] = 0;
        for row in self.words.chunks_exact(self.stride).skip(bottom).take(side) {
            for first in (0..side).step_by(64) {
                let count = (side - first).min(64);
                let bits = shifted(row, 0, column + first) & (u64::MAX >> (64 - count));
                square[at / 64] |= bits << (at % 64);
                square[at / 64 + 1] = bits >> 1 >> (63 - at % 64);
                at += count;
            }
        }
    }
}
