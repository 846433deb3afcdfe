//! How well a point fits at each place of the line map, and the maxima over squares of growing size: the bounds of the
//! branch and bound of Hess, Kohler, Rapp & Andor (2016), section V, in tables that shrink as the squares grow.

use crate::constants::{MAX_SIDE_M, MINOR, SCORE_CELL_M, THICK_M, TOP};
use crate::surfel_map::{SurfelMap, fitted};
use crate::work;
use interfaces::{Cell, CellState, Grid, GridFrame};
use nalgebra::{Point2, Vector2};

/// A surfel reaches this far along its surface, m: neighbors join.
const ALONG_M: f64 = 0.08;

/// Cells on the low sides of a frame: a square may begin outside of the frame and end inside.
const MARGIN: usize = 1 << TOP;

/// The scores, from 0 to 255, and where a robot can be.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(crate) struct ScoreGrid {
    /// The grid of the scores.
    pub(crate) frame: GridFrame,
    /// The bounds of the scores in squares of 2^level cells.
    pub(crate) scores: Vec<Level>,
    /// Not 0 where a robot can be. Without levels: anywhere.
    free: Vec<Level>,
}

impl ScoreGrid {
    /// The scores of the part of the line map around a point, up to `reach_m` away in x and in y. The robot can only be
    /// where `states` are free.
    pub(crate) fn around(
        surfels: &SurfelMap,
        states: &Grid<CellState>,
        middle: &Point2<f64>,
        reach_m: f64,
    ) -> Self {
        let reach = Vector2::repeat(reach_m.min(MAX_SIDE_M / 2.0));
        let whole = &surfels.frame;
        let end = Vector2::new(whole.width() as f64, whole.height() as f64) * whole.resolution_m();
        let (low, high) = ((middle - reach - whole.origin()), (middle + reach - whole.origin()));
        let (low, high) = (low.sup(&Vector2::zeros()), high.inf(&end));
        let size = (high - low).sup(&Vector2::repeat(SCORE_CELL_M));
        let frame = GridFrame::covering(whole.origin() + low, size.x, size.y, SCORE_CELL_M).unwrap_or(*whole);
        Self { free: levels(&frame, free_cells(&frame, states)), ..Self::of_frame(surfels, frame) }
    }

    /// The scores of the line map, where nothing is known about the places where the robot can be.
    pub(crate) fn anywhere(surfels: &SurfelMap) -> Self {
        Self::of_frame(surfels, fitted(&surfels.frame, SCORE_CELL_M, 0))
    }

    /// The same, in cells of any size.
    pub(crate) fn of_frame(surfels: &SurfelMap, frame: GridFrame) -> Self {
        Self { frame, scores: levels(&frame, splat(surfels, &frame)), free: Vec::new() }
    }

    /// The number of cells at all levels.
    pub(crate) fn cells(&self) -> usize {
        self.scores.iter().chain(&self.free).map(|level| level.cells.len()).sum()
    }

    /// Whether a robot can be in a square of 2^`level` cells; above level 2, or in one that touches it.
    pub(crate) fn has_free(&self, level: usize, x: i32, y: i32) -> bool {
        self.free.get(level).is_none_or(|free| free.bound(x, y) > 0)
    }
}

/// Maxima over squares of 2^level cells. Those of large squares begin at every 2^`shift`th cell only, and are over this
/// number of cells more, less one.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(crate) struct Level {
    shift: u32,
    width: usize,
    cells: Vec<u8>,
}

impl Level {
    /// An upper bound of the values in the square whose lower left cell is `(x, y)`: the largest one up to level 2; above it,
    /// the largest one in a square whose side is at most a quarter longer.
    #[inline]
    pub(crate) fn bound(&self, x: i32, y: i32) -> u8 {
        // A negative number becomes a large one: one comparison per axis.
        let at = |x: i32| ((x + MARGIN as i32) >> self.shift) as u32 as usize;
        if at(x) >= self.width {
            return 0;
        }
        self.cells.get(at(y) * self.width + at(x)).copied().unwrap_or(0)
    }

    /// The next level, whose squares have sides of 2^`level` cells.
    fn coarser(&self, level: u32) -> Self {
        // From level 3 on, four tables of squares lie beside each other in one of the next level.
        let shift = level.saturating_sub(2);
        let (step, parts) = match shift - self.shift {
            0 => (1, [0, 0, 1 << (level - 1)]),
            _ => (2, [0, 4, 5]),
        };
        let height = self.cells.len() / self.width;
        let width = self.width.div_ceil(step);
        let mut rows = vec![0; width * height];
        for (row, finer) in rows.chunks_exact_mut(width).zip(self.cells.chunks_exact(self.width)) {
            parts.iter().for_each(|&part| raise(row, &finer[part.min(self.width)..], step));
        }
        let mut cells = vec![0; width * height.div_ceil(step)];
        for (y, row) in cells.chunks_exact_mut(width).enumerate() {
            for finer in parts.iter().filter_map(|part| rows.chunks_exact(width).nth(y * step + part)) {
                raise(row, finer, 1);
            }
        }
        Self { shift, width, cells }
    }
}

/// Raises values to every `step`th of others.
fn raise(row: &mut [u8], others: &[u8], step: usize) {
    let larger = |(here, other): (&mut u8, &u8)| *here = (*here).max(*other);
    match step {
        1 => row.iter_mut().zip(others).for_each(larger), // at many cells at once
        _ => row.iter_mut().zip(others.iter().step_by(step)).for_each(larger),
    }
}

/// All levels over the cells of a frame and its margin.
fn levels(frame: &GridFrame, cells: Vec<u8>) -> Vec<Level> {
    let mut levels = vec![Level { shift: 0, width: frame.width() + MARGIN, cells }];
    for level in 0..TOP {
        work::count(levels[level].cells.len());
        levels.push(levels[level].coarser(level as u32 + 1));
    }
    levels
}

fn empty(frame: &GridFrame) -> Vec<u8> {
    vec![0; (frame.width() + MARGIN) * (frame.height() + MARGIN)]
}

/// The index of a cell of a frame with its margin.
fn padded(frame: &GridFrame, x: usize, y: usize) -> usize {
    (y + MARGIN) * (frame.width() + MARGIN) + x + MARGIN
}

/// The scores of the cells of a frame.
fn splat(surfels: &SurfelMap, frame: &GridFrame) -> Vec<u8> {
    let mut scores = empty(frame);
    let cell_m = frame.resolution_m();
    let (reach, max_along_m) = (Vector2::repeat(THICK_M.max(cell_m)), ALONG_M.max(cell_m / 2.0));
    let last = Cell::new(frame.width() as i32 - 1, frame.height() as i32 - 1);
    let end = frame.origin() + Vector2::new(frame.width() as f64, frame.height() as f64) * cell_m;
    surfels.within(&(frame.origin() - reach), &(end + reach), |surfel| {
        let (low, high) = (frame.cell_at(&(surfel.at - reach)), frame.cell_at(&(surfel.at + reach)));
        let (columns, rows) = (low.x.max(0)..=high.x.min(last.x), low.y.max(0)..=high.y.min(last.y));
        for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
            let to = frame.center(Cell::new(x, y)) - surfel.at;
            let (off_m, along_m) = (surfel.normal.dot(&to).abs(), surfel.normal.perp(&to).abs());
            if along_m > max_along_m {
                continue;
            }
            let share = (1.0 - (off_m - cell_m / 2.0).max(0.0) / THICK_M).max(0.0);
            let score = (f64::from(u8::MAX) * share * surfel.steadiness.max(MINOR)) as u8;
            let here = &mut scores[padded(frame, x as usize, y as usize)];
            *here = (*here).max(score);
        }
    });
    scores
}

/// 1 where a robot can be.
fn free_cells(frame: &GridFrame, states: &Grid<CellState>) -> Vec<u8> {
    let mut free = empty(frame);
    let known = |x: usize, y: usize| states.frame().cell_at(&frame.center(Cell::new(x as i32, y as i32)));
    let columns: Vec<i32> = (0..frame.width()).map(|x| known(x, 0).x).collect();
    for y in 0..frame.height() {
        let (row, first) = (known(0, y).y, padded(frame, 0, y));
        for (here, column) in free[first..].iter_mut().zip(&columns) {
            *here = u8::from(states.get(Cell::new(*column, row)) == Some(&CellState::Free));
        }
    }
    free
}
