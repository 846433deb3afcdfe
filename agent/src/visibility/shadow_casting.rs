use interfaces::{Cell, GridFrame};

/// A slope as a fraction; the denominator is positive.
#[derive(Clone, Copy, Debug)]
struct Slope(i32, i32);

impl Slope {
    fn is_below(self, other: Self) -> bool {
        self.0 * other.1 < other.0 * self.1
    }
}

/// The part of a row of a quadrant, `depth` away from the origin, that is in view between two slopes.
#[derive(Clone, Copy, Debug)]
struct Row {
    depth: i32,
    start: Slope,
    end: Slope,
}

impl Row {
    /// The columns whose regions overlap the view of the row, and some more.
    fn columns(&self) -> std::ops::RangeInclusive<i32> {
        let first = (self.depth * self.start.0).div_euclid(self.start.1) - 1;
        let last = (self.depth * self.end.0).div_euclid(self.end.1) + 2;
        first.max(-self.depth)..=last.min(self.depth)
    }

    fn shows(&self, column: i32) -> bool {
        let middle = Slope(column, self.depth);
        !middle.is_below(self.start) && !self.end.is_below(middle)
    }

    /// The slopes between which a region of this row hides what lies behind it.
    fn shadow(&self, column: i32) -> (Slope, Slope) {
        let (left, right, near, far) =
            (2 * column - 1, 2 * column + 1, 2 * self.depth - 1, 2 * self.depth + 1);
        (Slope(left, if left > 0 { far } else { near }), Slope(right, if right > 0 { near } else { far }))
    }
}

/// The regions in view from `origin` within `reach` regions, sorted. Shadow casting by rows: a region is in view
/// unless the straight line between the centers passes through the inside of an opaque region. Visibility is
/// symmetric.
pub(super) fn cast(regions: &Regions, opaque: &[bool], origin: usize, reach: f64) -> Vec<u32> {
    let (x, y) = ((origin % regions.columns) as i32, (origin / regions.columns) as i32);
    let mut seen = vec![origin as u32];
    let mut rows = Vec::new();
    for quadrant in 0..4 {
        let at = |depth: i32, column: i32| match quadrant {
            0 => regions.at(x + column, y + depth),
            1 => regions.at(x + column, y - depth),
            2 => regions.at(x + depth, y + column),
            _ => regions.at(x - depth, y + column),
        };
        rows.push(Row { depth: 1, start: Slope(-1, 1), end: Slope(1, 1) });
        while let Some(mut row) = rows.pop() {
            let depth = row.depth;
            if f64::from(depth) > reach {
                continue;
            }
            // Within a quadrant, no region hides the center of another region in the same row.
            for column in row.columns() {
                let region = at(depth, column);
                let is_near = f64::from(depth * depth + column * column) <= reach * reach;
                if let Some(region) = region.filter(|_| is_near && row.shows(column)) {
                    seen.push(region as u32);
                }
                let (start, end) = row.shadow(column);
                let is_hiding = row.start.is_below(end) && start.is_below(row.end);
                if is_hiding && region.is_none_or(|region| opaque[region]) {
                    if !start.is_below(row.start) {
                        rows.push(Row { depth: depth + 1, start: row.start, end: start });
                    }
                    row.start = end;
                }
            }
            if !row.end.is_below(row.start) {
                rows.push(Row { depth: depth + 1, ..row });
            }
        }
    }
    // Two quadrants share a diagonal.
    seen.sort_unstable();
    seen.dedup();
    seen
}

/// The maximum number of regions from the sensor to the end of its range, and of all regions: more would take long and change little.
const REACH_REGIONS: f64 = 40.0;
const MAX_REGIONS: usize = 40_000;

/// The map divided into square regions of `side` × `side` cells, from its lower left corner on; regions at the
/// right and upper border can be smaller. A region has an index in row-major order, like a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Regions {
    frame: GridFrame,
    /// The side of a region, cells.
    pub(crate) side: usize,
    pub(super) columns: usize,
    pub(super) rows: usize,
}

impl Regions {
    /// The regions for a sensor with the range `radius_m`.
    pub(crate) fn of_sensor(frame: GridFrame, radius_m: f64) -> Self {
        let reach_cells = radius_m / frame.resolution_m();
        // At least one cell, and at most the whole map. The cast saturates.
        let side = ((reach_cells / REACH_REGIONS).ceil() as usize).max(1);
        Self::at_most(MAX_REGIONS, frame, side.min(frame.width().max(frame.height())))
    }

    /// At most `count` regions of at least `side` × `side` cells.
    pub(crate) fn at_most(count: usize, frame: GridFrame, side: usize) -> Self {
        let mut regions = Self::with_side(frame, side);
        while regions.count() > count.max(1) {
            regions = Self::with_side(frame, regions.side + 1);
        }
        regions
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
