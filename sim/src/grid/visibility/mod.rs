//! The exact sensor of a grid world: line of sight between the centers of cells.
//!
//! A cell is in line of sight when the segment from the center of the robot's cell to the center of the cell
//! passes through the inside of no other blocked cell. A segment may pass exactly through the corner at which
//! four cells meet, unless both cells beside the corner are blocked. Line of sight is symmetric.
//!
//! Nearly all of the work is done in advance. Seen from the robot, a blocked cell always hides the same cells:
//! those strictly within the angle of its corners and behind the cell. Every blocked cell near the robot therefore
//! has a *shadow*, a set of bits, and the union of the shadows is hidden. The computing time depends on the number
//! of blocked cells around the robot, not on the size of the world.

mod blocked;
mod shadows;
#[cfg(test)]
mod tests;

use super::spec::GridSpec;
pub(super) use blocked::BlockedCells;
use interfaces::Cell;
use shadows::{Reach, Shadows};

/// The cells in line of sight of a sensor.
#[derive(Clone, Debug)]
pub(super) struct LineOfSight {
    shadows: Shadows,
    /// Scratch, a bit per cell of the square around the robot: what is blocked.
    square: Vec<u64>,
    /// Scratch, a bit per cell in reach: what is hidden.
    hidden: Vec<u64>,
}

impl LineOfSight {
    pub(super) fn new(radius: u32) -> Self {
        let shadows = Shadows::new(radius as i32);
        // The cell to the upper right is a row and a bit further on, and may be beyond the last cell.
        let square = vec![0; shadows.masks.len() + shadows.side / 64 + 2];
        let hidden = vec![0; shadows.everything.len()];
        Self { shadows, square, hidden }
    }

    /// The cells in line of sight from `robot`, each with whether it is blocked.
    pub(super) fn look(&mut self, blocked: &BlockedCells, robot: Cell) -> Vec<(Cell, bool)> {
        blocked.copy_square(robot, self.shadows.side, &mut self.square);
        self.hide(blocked, robot);
        let seen = self.hidden.iter().zip(&self.shadows.everything).map(|(hidden, all)| !hidden & all);
        let count = seen.clone().map(|seen| seen.count_ones() as usize).sum();
        let mut cells = Vec::with_capacity(count);
        for (seen, reach) in seen.zip(self.shadows.reach.chunks(64)) {
            each_bit(seen, |bit| {
                let Reach { offset: (dx, dy), bit } = reach[bit];
                let is_blocked = self.square[bit as usize / 64] >> (bit % 64) & 1 == 1;
                cells.push((Cell::new(robot.x + dx, robot.y + dy), is_blocked));
            });
        }
        cells
    }

    /// Unites the shadows of the blocked cells.
    fn hide(&mut self, blocked: &BlockedCells, robot: Cell) {
        let (shadows, square, hidden) = (&self.shadows, &self.square[..], &mut self.hidden[..]);
        hidden.fill(0);
        for outside in shadows.outside(blocked, robot) {
            hidden.iter_mut().zip(outside).for_each(|(hidden, outside)| *hidden |= outside);
        }
        for (word, mask) in shadows.masks.iter().enumerate() {
            let here = square[word];
            let [right, above, above_right] =
                [1, shadows.side, shadows.side + 1].map(|further| shifted(square, word, further));
            each_bit(here & mask.cells, |bit| {
                shadows.cells[word * 64 + bit].unite(hidden, &shadows.words);
            });
            each_bit(right & above & mask.rising | here & above_right & mask.falling, |bit| {
                shadows.corners[word * 64 + bit].unite(hidden, &shadows.words);
            });
        }
    }
}

/// The word that begins a number of bits after the word with an index.
#[inline]
fn shifted(words: &[u64], word: usize, bits: usize) -> u64 {
    let (word, shift) = (word + bits / 64, bits % 64);
    // In two shifts, since a shift by 64 is not defined.
    words[word] >> shift | words[word + 1] << 1 << (63 - shift)
}

/// Calls `f` with the index of every bit that is set.
#[inline]
fn each_bit(mut bits: u64, mut f: impl FnMut(usize)) {
    while bits != 0 {
        f(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}
