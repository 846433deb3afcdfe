use nalgebra::Point2;

/// A cell, given by its column (`x`, to the right) and its row (`y`, upward). The numbers are signed: the neighbor
/// of a border cell is a cell outside the grid, and never a cell of another row.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Deserialize, serde::Serialize,
)]
pub struct Cell {
    /// Column, counted from the left.
    pub x: i32,
    /// Row, counted from the bottom.
    pub y: i32,
}

impl Cell {
    /// The cell in column `x` and row `y`.
    #[inline]
    pub const fn new(x: i32, y: i32) -> Self {
        Self { x, y }
    }

    /// The four cells that share a side: right, up, left, down.
    #[inline]
    pub fn neighbours4(self) -> [Self; 4] {
        [(1, 0), (0, 1), (-1, 0), (0, -1)].map(|(dx, dy)| Self::new(self.x + dx, self.y + dy))
    }

    /// The eight cells that share a side or a corner, row by row from the bottom.
    #[inline]
    pub fn neighbours8(self) -> [Self; 8] {
        [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)]
            .map(|(dx, dy)| Self::new(self.x + dx, self.y + dy))
    }

    /// The cells up to this many columns and rows away, with this one, row by row from the bottom.
    pub fn square(self, reach: i32) -> impl Iterator<Item = Self> {
        let rows = self.y - reach..=self.y + reach;
        rows.flat_map(move |y| (self.x - reach..=self.x + reach).map(move |x| Self::new(x, y)))
    }

    /// The cells of this [square](Self::square) whose centers are at most `reach` sides of a cell away.
    pub fn disc(self, reach: i32) -> impl Iterator<Item = Self> {
        self.square(reach).filter(move |cell| self.is_within(*cell, reach))
    }

    /// Whether the center of a cell near this one is at most `reach` sides of a cell away.
    pub fn is_within(self, cell: Self, reach: i32) -> bool {
        (cell.x - self.x).pow(2) + (cell.y - self.y).pow(2) <= reach * reach
    }

    /// The cell that contains the mean of the positions of `cells`; `None` for no cells.
    pub fn centroid(cells: impl IntoIterator<Item = Self>) -> Option<Self> {
        let (mut sum, mut count) = (Point2::new(0.0, 0.0), 0.0);
        for cell in cells {
            sum.x += f64::from(cell.x);
            sum.y += f64::from(cell.y);
            count += 1.0;
        }
        (count > 0.0).then(|| Self::new((sum.x / count).round() as i32, (sum.y / count).round() as i32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centroid_is_the_mean() {
        assert_eq!(Cell::centroid([]), None);
        assert_eq!(Cell::centroid([Cell::new(0, 0), Cell::new(4, 2)]), Some(Cell::new(2, 1)));
    }
}
