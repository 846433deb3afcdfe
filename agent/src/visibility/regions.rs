use interfaces::{Cell, GridFrame};

/// The maximum number of regions from the sensor to the end of its range: more would take long and change little.
const REACH_REGIONS: f64 = 40.0;

/// The map divided into square regions of `side` × `side` cells, from its lower left corner on; regions at the
/// right and upper border can be smaller. A region has an index in row-major order, like a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Regions {
    frame: GridFrame,
    pub(super) side: usize,
    pub(super) columns: usize,
    pub(super) rows: usize,
}

impl Regions {
    /// The regions for a sensor with the range `radius_m`.
    pub(super) fn new(frame: GridFrame, radius_m: f64) -> Self {
        let reach_cells = radius_m / frame.resolution_m();
        // At least one cell, and at most the whole map. The cast saturates.
        let side = ((reach_cells / REACH_REGIONS).ceil() as usize).max(1);
        Self::with_side(frame, side.min(frame.width().max(frame.height())))
    }

    /// Regions of `side` × `side` cells.
    pub(crate) fn with_side(frame: GridFrame, side: usize) -> Self {
        Self { frame, side, columns: frame.width().div_ceil(side), rows: frame.height().div_ceil(side) }
    }

    /// The number of regions; at least one.
    pub(crate) fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// The region of a cell, both by index.
    #[inline]
    pub(crate) fn of(&self, index: usize) -> usize {
        let width = self.frame.width();
        index / width / self.side * self.columns + index % width / self.side
    }

    /// The index of a cell; `None` outside of the map.
    pub(crate) fn index(&self, cell: Cell) -> Option<usize> {
        self.frame.index(cell)
    }

    /// Whether each region is a cell.
    pub(crate) fn are_cells(&self) -> bool {
        self.side == 1
    }

    /// Whether two cells are less than a region apart; if each region is a cell: whether they are the same.
    pub(crate) fn are_near(&self, one: Cell, other: Cell) -> bool {
        (one.x.abs_diff(other.x).max(one.y.abs_diff(other.y)) as usize) < self.side
    }

    /// The indices of the cells of a region, row by row.
    pub(crate) fn cells(&self, region: usize) -> impl Iterator<Item = usize> {
        let (width, side) = (self.frame.width(), self.side);
        let (left, bottom) = (region % self.columns * side, region / self.columns * side);
        let right = (left + side).min(width);
        let rows = bottom..(bottom + side).min(self.frame.height());
        rows.flat_map(move |row| row * width + left..row * width + right)
    }

    #[inline]
    pub(super) fn at(&self, column: i32, row: i32) -> Option<usize> {
        let inside = (0..self.columns as i32).contains(&column) && (0..self.rows as i32).contains(&row);
        inside.then(|| row as usize * self.columns + column as usize)
    }

    /// The length `radius_m` in regions.
    pub(super) fn reach(&self, radius_m: f64) -> f64 {
        radius_m / (self.frame.resolution_m() * self.side as f64)
    }
}
