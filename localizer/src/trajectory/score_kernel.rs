//! The scores around an end point, in the fine and in the coarse cells of a correlation. An end point raises
//! rows of cells, so that many cells are raised at once.

use crate::constants::{CORRELATION_CELL_M, CORRELATION_STD_M};
use std::ops::RangeInclusive;
use std::sync::LazyLock;

/// Fine cells along the side of a block of shifts.
pub(super) const BLOCK: i32 = 1 << BLOCK_BITS;
pub(super) const BLOCK_BITS: u32 = 2;
/// The score of an end point on another one.
pub(super) const TOP_SCORE: u8 = u8::MAX;
/// The scores reach this number of fine cells around an end point.
const REACH: i32 = (2.5 * CORRELATION_STD_M / CORRELATION_CELL_M) as i32;
/// Rows of fine and of coarse cells, and cells of a row: what is beyond the reach is 0.
const ROWS: usize = 2 * REACH as usize + 1;
const ROW: usize = 16;
const COARSE: usize = 8;
/// An end point that is nearer to the border of the grid than this is out of reach of the points of a scan.
const BORDER: i32 = 4 * BLOCK + REACH;

/// Squares of scores: fine cells, and maxima over coarse ones.
pub(super) struct Scores {
    pub(super) side: i32,
    pub(super) fine: Vec<u8>,
    pub(super) coarse: Vec<u8>,
}

struct Kernel {
    rows: [[u8; ROW]; ROWS],
    /// The maxima over coarse cells, for each place of the end point in its block.
    coarse: [[[u8; COARSE]; COARSE]; (BLOCK * BLOCK) as usize],
}

static KERNEL: LazyLock<Kernel> = LazyLock::new(Kernel::new);

impl Kernel {
    fn new() -> Self {
        let mut kernel =
            Self { rows: [[0; ROW]; ROWS], coarse: [[[0; COARSE]; COARSE]; (BLOCK * BLOCK) as usize] };
        for ([dx, dy], score) in scores() {
            kernel.rows[(dy + REACH) as usize][(dx + REACH) as usize] = score;
            for place in 0..BLOCK * BLOCK {
                let [x, y] = [place % BLOCK, place / BLOCK].map(|at| BORDER / BLOCK * BLOCK + at);
                for row in blocks_of(y + dy) {
                    for column in blocks_of(x + dx) {
                        let [row, column] = [row - first_block(y), column - first_block(x)];
                        let bound = &mut kernel.coarse[place as usize][row as usize][column as usize];
                        *bound = (*bound).max(score);
                    }
                }
            }
        }
        kernel
    }
}

impl Scores {
    pub(super) fn new(blocks: i32) -> Self {
        let cells = |side: i32| vec![0; (side * side) as usize];
        Self { side: blocks * BLOCK, fine: cells(blocks * BLOCK), coarse: cells(blocks) }
    }

    /// Raises the scores around an end point in a fine cell.
    pub(super) fn add(&mut self, [x, y]: [i32; 2]) {
        let inner = BORDER..self.side - BORDER;
        let is_inner = inner.contains(&x) && inner.contains(&y);
        // Another end point lies in this cell, or this one is out of reach.
        if !is_inner || self.fine[(y * self.side + x) as usize] == TOP_SCORE {
            return;
        }
        let kernel = &*KERNEL;
        for (row, scores) in (y - REACH..).zip(&kernel.rows) {
            raise(&mut self.fine[(row * self.side + x - REACH) as usize..], scores);
        }
        let place = (y % BLOCK) * BLOCK + x % BLOCK;
        for (row, scores) in (first_block(y)..).zip(&kernel.coarse[place as usize]) {
            raise(&mut self.coarse[(row * (self.side / BLOCK) + first_block(x)) as usize..], scores);
        }
    }
}

pub(super) fn index([x, y]: [i32; 2], side: i32) -> Option<usize> {
    ((0..side).contains(&x) && (0..side).contains(&y)).then(|| (y * side + x) as usize)
}

/// The sums of the scores of cells, shifted by all shifts of a square from the first one on.
pub(super) fn sums<const N: usize>(
    scores: &[u8],
    side: i32,
    cells: impl Iterator<Item = [i32; 2]>,
    first: [i32; 2],
) -> [[u32; N]; N] {
    let mut sums = [[0; N]; N];
    for [x, y] in cells.map(|[x, y]| [x + first[0], y + first[1]]) {
        let is_inside = x >= 0 && x + N as i32 <= side;
        for (y, sums) in (y..).zip(&mut sums).filter(|(y, _)| (0..side).contains(y)) {
            match is_inside {
                true => {
                    let row = &scores[(y * side + x) as usize..][..N];
                    sums.iter_mut().zip(row).for_each(|(sum, score)| *sum += u32::from(*score));
                }
                false => (x..).zip(sums).for_each(|(x, sum)| {
                    *sum += index([x, y], side).map_or(0, |here| u32::from(scores[here]));
                }),
            }
        }
    }
    sums
}

fn raise<const N: usize>(cells: &mut [u8], scores: &[u8; N]) {
    cells[..N].iter_mut().zip(scores).for_each(|(cell, score)| *cell = (*cell).max(*score));
}

/// The coarse cells that cover a fine one: each covers two blocks, less one cell.
fn blocks_of(cell: i32) -> RangeInclusive<i32> {
    (cell - BLOCK + 1).max(0) / BLOCK..=cell / BLOCK
}

/// The first coarse cell that an end point in a fine cell raises, far from the border.
fn first_block(cell: i32) -> i32 {
    *blocks_of(cell - REACH).start()
}

/// The scores around an end point.
fn scores() -> impl Iterator<Item = ([i32; 2], u8)> {
    let score = |[x, y]: [i32; 2]| {
        let off = f64::from(x * x + y * y).sqrt() * CORRELATION_CELL_M / CORRELATION_STD_M;
        ([x, y], (f64::from(TOP_SCORE) * libm::exp(-0.5 * off * off)) as u8)
    };
    (-REACH..=REACH).flat_map(|y| (-REACH..=REACH).map(move |x| [x, y])).map(score)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Purpose, RandomStream};

    #[test]
    fn scores_are_the_largest_ones_of_all_end_points() {
        let (mut grid, mut random) = (Scores::new(40), RandomStream::new(100, Purpose::Agent));
        let side = grid.side;
        // Some are beyond the border, where nothing is raised.
        let mut points: Vec<[i32; 2]> =
            (0..300).map(|_| [0, 0].map(|_| random.uniform(-10.0..f64::from(side) + 10.0) as i32)).collect();
        points.iter().for_each(|point| grid.add(*point));
        points.retain(|point| point.iter().all(|at| (BORDER..side - BORDER).contains(at)));
        let around: Vec<u8> = scores().map(|(_, score)| score).collect();
        let expected = |at: [i32; 2]| {
            let of_point = |point: &[i32; 2]| {
                let [x, y] = [at[0] - point[0] + REACH, at[1] - point[1] + REACH];
                index([x, y], ROWS as i32).map_or(0, |off| around[off])
            };
            points.iter().map(of_point).max().unwrap()
        };
        let fine: Vec<u8> = (0..side * side).map(|here| expected([here % side, here / side])).collect();
        assert_eq!(grid.fine, fine);
        // A coarse cell covers seven fine ones along each side.
        let (blocks, cover) = (side / BLOCK, 2 * BLOCK - 1);
        for block in 0..blocks * blocks {
            let [x, y] = [block % blocks * BLOCK, block / blocks * BLOCK];
            let cells = (y..y + cover).flat_map(|y| (x..x + cover).map(move |x| [x, y]));
            let most = cells.filter_map(|at| index(at, side)).map(|here| fine[here]).max();
            assert_eq!(Some(grid.coarse[block as usize]), most);
        }
        let sums: [[u32; 4]; 4] = sums(&fine, side, points.iter().copied(), [-3, 5]);
        for (y, x) in (0..4).flat_map(|y| (0..4).map(move |x| (y, x))) {
            let shifted = points.iter().map(|[a, b]| [a + x - 3, b + y + 5]);
            let sum: u32 = shifted.filter_map(|at| index(at, side)).map(|here| u32::from(fine[here])).sum();
            assert_eq!(sums[y as usize][x as usize], sum);
        }
    }
}
