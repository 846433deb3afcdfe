use nalgebra::Point2;

/// A cell, given by its column (`x`, to the right) and its row (`y`, upward). The numbers are signed: the neighbor
/// of a border cell is a cell outside the grid, and never a cell of another row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Deserialize, serde::Serialize)]
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
