//! How well a point fits at each place of the line map, and the maxima over squares of growing size: the bounds of the
//! branch and bound of Hess, Kohler, Rapp & Andor (2016), section V.

use crate::constants::{ALONG_M, MAX_SIDE_M, MINOR, SCORE_CELL_M, THICK_M, TOP};
use crate::surfel_map::{SurfelMap, fitted};
use crate::work;
use interfaces::{Cell, CellState, Grid, GridFrame};
use nalgebra::{Point2, Vector2};

/// The scores, from 0 to 255, at all levels.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(crate) struct ScoreGrid {
    frame: GridFrame,
    /// The margin on the low sides, in cells: a square may begin outside of the map and end inside.
    margin: i32,
    width: usize,
    levels: Vec<Vec<u8>>,
    /// For every cell of the frame, the number of free cells to the left of and below it: where a robot can be. `None`:
    /// anywhere.
    free: Option<Vec<u32>>,
}

impl ScoreGrid {
    /// The scores of the line map. The robot can only be where `states` are free.
    pub(crate) fn new(surfels: &SurfelMap, states: &Grid<CellState>) -> Self {
        Self::anywhere(surfels).only_where_free(states)
    }

    /// The same, of the part of the line map around a point, up to `reach_m` away in x and in y.
    pub(crate) fn around(
        surfels: &SurfelMap,
        states: &Grid<CellState>,
        middle: &Point2<f64>,
        reach_m: f64,
    ) -> Self {
        let reach = Vector2::repeat(reach_m.min(MAX_SIDE_M / 2.0));
        let whole = surfels.frame();
        let end = Vector2::new(whole.width() as f64, whole.height() as f64) * whole.resolution_m();
        let (low, high) = ((middle - reach - whole.origin()), (middle + reach - whole.origin()));
        let (low, high) = (low.sup(&Vector2::zeros()), high.inf(&end));
        let size = (high - low).sup(&Vector2::repeat(SCORE_CELL_M));
        let frame = GridFrame::covering(whole.origin() + low, size.x, size.y, SCORE_CELL_M);
        Self::of_frame(surfels, frame.unwrap_or(*whole)).only_where_free(states)
    }

    /// The scores of the line map, where nothing is known about the places where the robot can be.
    pub(crate) fn anywhere(surfels: &SurfelMap) -> Self {
        Self::of_frame(surfels, fitted(surfels.frame(), SCORE_CELL_M, 0))
    }

    fn only_where_free(self, states: &Grid<CellState>) -> Self {
        work::count(self.frame.len());
        Self { free: Some(free_cells(&self.frame, states)), ..self }
    }

    /// The same, in cells of any size.
    pub(crate) fn of_frame(surfels: &SurfelMap, frame: GridFrame) -> Self {
        let margin = 1_usize << TOP;
        let (width, height) = (frame.width() + margin, frame.height() + margin);
        let mut grid =
            Self { frame, margin: margin as i32, width, levels: vec![vec![0; width * height]], free: None };
        grid.splat(surfels);
        for level in 0..TOP {
            let finer = &grid.levels[level];
            work::count(finer.len());
            grid.levels.push(maxima(finer, width, 1 << level));
        }
        grid
    }

    fn splat(&mut self, surfels: &SurfelMap) {
        let cell_m = self.frame.resolution_m();
        let (reach, along_most_m) = (Vector2::repeat(THICK_M.max(cell_m)), ALONG_M.max(cell_m / 2.0));
        let last = Cell::new(self.frame.width() as i32 - 1, self.frame.height() as i32 - 1);
        for surfel in surfels.usable() {
            let (low, high) =
                (self.frame.cell_at(&(surfel.at - reach)), self.frame.cell_at(&(surfel.at + reach)));
            let (columns, rows) = (low.x.max(0)..=high.x.min(last.x), low.y.max(0)..=high.y.min(last.y));
            for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
                let cell = Cell::new(x, y);
                let to = self.frame.center(cell) - surfel.at;
                let (off_m, along_m) = (surfel.normal.dot(&to).abs(), surfel.normal.perp(&to).abs());
                if along_m > along_most_m {
                    continue;
                }
                let share = (1.0 - (off_m - cell_m / 2.0).max(0.0) / THICK_M).max(0.0);
                let score = (255.0 * share * surfel.steadiness.max(MINOR)) as u8;
                let index = self.padded(x, y);
                let here = &mut self.levels[0][index];
                *here = (*here).max(score);
            }
        }
    }

    fn padded(&self, x: i32, y: i32) -> usize {
        (y + self.margin) as usize * self.width + (x + self.margin) as usize
    }

    /// The grid of the scores.
    pub(crate) fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// The largest score in the square of 2^`level` cells whose lower left cell is `(x, y)`.
    #[inline]
    pub(crate) fn bound(&self, level: usize, x: i32, y: i32) -> u8 {
        // A negative number becomes a large one: one comparison per axis.
        let (column, row) = ((x + self.margin) as u32 as usize, (y + self.margin) as u32 as usize);
        if column >= self.width {
            return 0;
        }
        self.levels[level].get(row * self.width + column).copied().unwrap_or(0)
    }

    /// Whether the square of `side` cells at `(x, y)` contains a cell where a robot can be.
    pub(crate) fn has_free(&self, x: i32, y: i32, side: i32) -> bool {
        let Some(free) = &self.free else { return true };
        let (width, height) = (self.frame.width() as i32, self.frame.height() as i32);
        let (low_x, low_y) = (x.clamp(0, width), y.clamp(0, height));
        let (high_x, high_y) = ((x + side).clamp(0, width), (y + side).clamp(0, height));
        let sum = |x: i32, y: i32| free[y as usize * (width as usize + 1) + x as usize];
        sum(high_x, high_y) + sum(low_x, low_y) > sum(low_x, high_y) + sum(high_x, low_y)
    }
}

/// The maxima over squares of twice the side, from those over squares of `side` cells.
fn maxima(finer: &[u8], width: usize, side: usize) -> Vec<u8> {
    let height = finer.len() / width;
    let mut coarser = finer.to_vec();
    for (row, finer) in coarser.chunks_exact_mut(width).zip(finer.chunks_exact(width)) {
        for (here, right) in row.iter_mut().zip(&finer[side..]) {
            *here = (*here).max(*right);
        }
    }
    for y in 0..height - side {
        let (low, high) = coarser.split_at_mut((y + side) * width);
        for (here, above) in low[y * width..(y + 1) * width].iter_mut().zip(&high[..width]) {
            *here = (*here).max(*above);
        }
    }
    coarser
}

/// Sums of the free cells, with one more column and row than the frame.
fn free_cells(frame: &GridFrame, states: &Grid<CellState>) -> Vec<u32> {
    let (width, height) = (frame.width(), frame.height());
    let mut sums = vec![0; (width + 1) * (height + 1)];
    let known = |x: usize, y: usize| states.frame().cell_at(&frame.center(Cell::new(x as i32, y as i32)));
    let columns: Vec<i32> = (0..width).map(|x| known(x, 0).x).collect();
    for y in 0..height {
        let mut row = 0;
        let state_row = known(0, y).y;
        for (x, column) in columns.iter().enumerate() {
            let state = states.get(Cell::new(*column, state_row));
            row += u32::from(state == Some(&CellState::Free));
            sums[(y + 1) * (width + 1) + x + 1] = sums[y * (width + 1) + x + 1] + row;
        }
    }
    sums
}
