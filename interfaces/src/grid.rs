use crate::{Cell, SparseCells};
use nalgebra::{Point2, Vector2};
use std::collections::BTreeSet;

/// The position and the size of a grid: square cells, row-major, row 0 at the lowest y.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(try_from = "FrameParts", into = "FrameParts")]
pub struct GridFrame {
    origin: Point2<f64>,
    resolution_m: f64,
    width: usize,
    height: usize,
}

/// The origin (m), the resolution (m), the width and the height.
type FrameParts = (Point2<f64>, f64, usize, usize);

impl From<GridFrame> for FrameParts {
    fn from(GridFrame { origin, resolution_m, width, height }: GridFrame) -> Self {
        (origin, resolution_m, width, height)
    }
}

impl TryFrom<FrameParts> for GridFrame {
    type Error = &'static str;

    fn try_from((origin, resolution_m, width, height): FrameParts) -> Result<Self, Self::Error> {
        Self::new(origin, resolution_m, width, height).ok_or("not the frame of a grid")
    }
}

impl GridFrame {
    /// The maximum number of cells: more than two square kilometers with cells of 0.05 m. It bounds what one value per cell
    /// takes even where every cell has a value of its own.
    pub const MAX_CELLS: usize = 1 << 30;

    /// A frame of `width` × `height` cells with sides of `resolution_m` (m), whose lower left corner is at `origin`
    /// (m). `None` unless every number is finite, the resolution is positive, and the grid has between one cell and
    /// [`MAX_CELLS`](Self::MAX_CELLS).
    pub fn new(origin: Point2<f64>, resolution_m: f64, width: usize, height: usize) -> Option<Self> {
        let cells = width.checked_mul(height)?;
        let finite = origin.x.is_finite() && origin.y.is_finite() && resolution_m.is_finite();
        (finite && resolution_m > 0.0 && (1..=Self::MAX_CELLS).contains(&cells)).then_some(Self {
            origin,
            resolution_m,
            width,
            height,
        })
    }

    /// The frame that covers the rectangle of `width_m` × `height_m` (m) whose lower left corner is `origin` (m).
    /// `None` under the same conditions as for [`GridFrame::new`].
    pub fn covering(origin: Point2<f64>, width_m: f64, height_m: f64, resolution_m: f64) -> Option<Self> {
        // A millionth of a cell of slack: 12 m in cells of 0.05 m are 240 cells, not 241.
        let cells = |length_m: f64| (length_m / resolution_m - 1e-6).ceil() as usize;
        Self::new(origin, resolution_m, cells(width_m), cells(height_m))
    }

    /// The smallest frame with the cells of this one that covers another frame as well; `None` if the sides of its cells are others,
    /// or if it has too many cells.
    pub fn union(&self, other: &Self) -> Option<Self> {
        let shift = (other.origin - self.origin) / self.resolution_m;
        let size = |frame: &Self| Vector2::new(frame.width as f64, frame.height as f64);
        let low = shift.map(|cells| (cells + 1e-6).floor()).inf(&Vector2::zeros());
        let high = (shift + size(other)).map(|cells| (cells - 1e-6).ceil()).sup(&size(self));
        let (origin, cells) = (self.origin + low * self.resolution_m, high - low);
        let frame = Self::new(origin, self.resolution_m, cells.x as usize, cells.y as usize);
        frame.filter(|_| self.resolution_m == other.resolution_m)
    }

    /// The lower left corner, m.
    #[inline]
    pub fn origin(&self) -> Point2<f64> {
        self.origin
    }

    /// The side of a cell, m.
    #[inline]
    pub fn resolution_m(&self) -> f64 {
        self.resolution_m
    }

    /// The number of columns.
    #[inline]
    pub fn width(&self) -> usize {
        self.width
    }

    /// The number of rows.
    #[inline]
    pub fn height(&self) -> usize {
        self.height
    }

    /// The number of cells; at least one.
    #[inline]
    #[allow(clippy::len_without_is_empty)] // a frame is never empty
    pub fn len(&self) -> usize {
        self.width * self.height
    }

    /// The cell that contains `point` (m); the cell can be outside of the grid. A point on a border belongs to the
    /// cell to the right and above.
    #[inline]
    pub fn cell_at(&self, point: &Point2<f64>) -> Cell {
        let at = (point - self.origin) / self.resolution_m;
        Cell::new(floor(at.x), floor(at.y))
    }

    /// The center of a cell, m; the cell can be outside of the grid.
    #[inline]
    pub fn center(&self, cell: Cell) -> Point2<f64> {
        Point2::new(
            self.origin.x + (f64::from(cell.x) + 0.5) * self.resolution_m,
            self.origin.y + (f64::from(cell.y) + 0.5) * self.resolution_m,
        )
    }

    /// Whether the cell lies in the grid.
    #[inline]
    pub fn contains(&self, cell: Cell) -> bool {
        (0..self.width as i32).contains(&cell.x) && (0..self.height as i32).contains(&cell.y)
    }

    /// The index of a cell in row-major order; `None` outside of the grid.
    #[inline]
    pub fn index(&self, cell: Cell) -> Option<usize> {
        self.contains(cell).then(|| cell.y as usize * self.width + cell.x as usize)
    }

    /// The cell of an index in row-major order.
    #[inline]
    pub fn cell(&self, index: usize) -> Cell {
        // Grids have at most 2^30 cells, and a division of 32 bits takes less time.
        let (index, width) = (index as u32, self.width as u32);
        Cell::new((index % width) as i32, (index / width) as i32)
    }

    /// The indices of the cells that share a side with a cell, in the order of [`Cell::neighbours4`].
    #[inline]
    pub fn beside(&self, index: usize) -> impl Iterator<Item = usize> + use<> {
        let frame = *self;
        frame.cell(index).neighbours4().into_iter().filter_map(move |cell| frame.index(cell))
    }

    /// Takes a cell from `left`, the first one, with all that are connected with it; `None` if there is no cell. Cells are connected
    /// up to a distance of `reach` along both axes: with 1, by sides or corners.
    pub fn take_connected(&self, left: &mut BTreeSet<usize>, reach: i32) -> Option<Vec<usize>> {
        let (mut cells, mut next) = (vec![left.pop_first()?], 0);
        while let Some(cell) = cells.get(next).map(|index| self.cell(*index)) {
            next += 1;
            let around = cell.square(reach).filter_map(|cell| self.index(cell));
            cells.extend(around.filter(|index| left.remove(index)));
        }
        Some(cells)
    }

    /// The longer side of the rectangle around some cells, in cells.
    pub fn longer_side(&self, cells: &[usize]) -> i32 {
        let length = |along: fn(Cell) -> i32| {
            let places = || cells.iter().map(|index| along(self.cell(*index)));
            places().max().unwrap_or_default() - places().min().unwrap_or_default() + 1
        };
        length(|cell| cell.x).max(length(|cell| cell.y))
    }
}

/// The largest whole number that is not above a number, limited to the range of `i32`. The portable instruction set
/// has no rounding instruction, and this function is called for every beam.
#[inline]
fn floor(x: f64) -> i32 {
    let toward_zero = x as i32;
    toward_zero.saturating_sub(i32::from(x < f64::from(toward_zero)))
}

/// One value for every cell of a frame, in memory that grows with the number of cells that differ from the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<T> {
    frame: GridFrame,
    cells: SparseCells<T>,
}

impl<T: Clone> Grid<T> {
    /// A grid that holds `value` everywhere.
    pub fn filled(frame: GridFrame, value: T) -> Self {
        Self { frame, cells: SparseCells::new(frame.width(), frame.height(), value) }
    }

    /// A grid of `cells` in row-major order; `None` if the number of cells is not that of the frame.
    pub fn from_cells(frame: GridFrame, cells: Vec<T>) -> Option<Self>
    where
        T: PartialEq,
    {
        let is_complete = cells.len() == frame.len();
        is_complete.then(|| Self { frame, cells: SparseCells::from_vec(frame.width(), cells) })
    }

    /// The mutable value of a cell; `None` outside of the grid.
    #[inline]
    pub fn get_mut(&mut self, cell: Cell) -> Option<&mut T> {
        Some(&mut self.cells[self.frame.index(cell)?])
    }

    /// Sets the value of a cell, if the cell is in the grid.
    pub fn set(&mut self, cell: Cell, value: T) {
        if let Some(own) = self.get_mut(cell) {
            *own = value;
        }
    }
}

impl<T> Grid<T> {
    /// A grid of the same frame, with `f` applied to every value: once for all cells that never got a value of their own.
    pub fn map<U: Clone>(&self, f: impl FnMut(&T) -> U) -> Grid<U> {
        Grid { frame: self.frame, cells: self.cells.map(f) }
    }

    /// The position and the size of the grid.
    #[inline]
    pub fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// The values in row-major order, row 0 at the lowest y.
    #[inline]
    pub fn cells(&self) -> &SparseCells<T> {
        &self.cells
    }

    /// The mutable values in row-major order, row 0 at the lowest y.
    #[inline]
    pub fn cells_mut(&mut self) -> &mut SparseCells<T> {
        &mut self.cells
    }

    /// The rows, from the lowest y on.
    pub fn rows(&self) -> impl DoubleEndedIterator<Item = impl DoubleEndedIterator<Item = &T>> {
        (0..self.frame.height()).map(|row| self.cells.row(row))
    }

    /// The value of a cell; `None` outside of the grid.
    #[inline]
    pub fn get(&self, cell: Cell) -> Option<&T> {
        Some(&self.cells[self.frame.index(cell)?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> GridFrame {
        GridFrame::covering(Point2::new(-1.0, 2.0), 12.0, 6.0, 0.05).unwrap()
    }

    #[test]
    fn covering_does_not_add_a_cell_for_rounding() {
        assert_eq!((frame().width(), frame().height()), (240, 120));
    }

    #[test]
    fn index_and_cell_are_inverse() {
        for index in [0, 1, 239, 240, 28_799] {
            assert_eq!(frame().index(frame().cell(index)), Some(index));
        }
    }

    #[test]
    fn outside_is_outside_on_every_side() {
        for cell in [Cell::new(-1, 0), Cell::new(0, -1), Cell::new(240, 0), Cell::new(0, 120)] {
            assert_eq!(frame().index(cell), None);
        }
    }

    #[test]
    fn floor_is_floor() {
        for step in -40..40 {
            let x = f64::from(step) * 0.25;
            assert_eq!(floor(x), x.floor() as i32, "{x}");
        }
        assert_eq!((floor(-1e300), floor(1e300)), (i32::MIN, i32::MAX));
    }

    #[test]
    fn a_cell_holds_its_center() {
        let cell = Cell::new(7, 9);
        assert_eq!(frame().cell_at(&frame().center(cell)), cell);
    }

    #[test]
    fn absurd_frames_are_refused() {
        let origin = Point2::origin();
        assert_eq!(GridFrame::new(origin, 0.0, 1, 1), None);
        assert_eq!(GridFrame::new(origin, f64::NAN, 1, 1), None);
        assert_eq!(GridFrame::new(origin, 1.0, 0, 1), None);
        assert_eq!(GridFrame::new(origin, 1.0, usize::MAX, 2), None);
        assert_eq!(GridFrame::new(origin, 1.0, (1 << 15) + 1, 1 << 15), None);
        assert_eq!(GridFrame::covering(origin, 1e9, 1e9, 1e-3), None);
    }
}
