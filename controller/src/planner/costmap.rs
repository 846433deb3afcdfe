use interfaces::{Cell, GridFrame};

/// The cost of a cell that the center of the robot must not enter. (A special value, not a low cost.)
pub const LETHAL: u8 = 0;
/// The cost of a cell far from every obstacle.
pub const FREE: u8 = 1;
/// The largest cost of a cell. It bounds the number of buckets of a [`Wavefront`](crate::Wavefront).
pub const MAX_COST: u8 = 9;
/// The cost of a move to a cell that shares a side, at cell cost [`FREE`].
pub const STRAIGHT: u32 = 5;
/// The cost of a move to a cell that shares a corner, at cell cost [`FREE`]. 7/5 is √2 within one percent;
/// small integers keep path costs exact and the buckets of the wavefront few.
pub const DIAGONAL: u32 = 7;

/// The moves that a robot can make from cell to cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moves {
    /// To the four cells that share a side.
    Four,
    /// To the eight cells that share a side or a corner; never diagonally past a lethal cell.
    Eight,
}

/// The cost of every cell: [`LETHAL`], or the cost per length of a move into the cell. A border of lethal cells
/// surrounds the grid, so that a search need not check for the end of the grid.
#[derive(Clone, Debug)]
pub struct Costmap {
    frame: GridFrame,
    /// The number of slots in a row: the cells of the grid, and one border cell at each end.
    stride: usize,
    costs: Vec<u8>,
    /// For each slot whether its eight neighbors have the same cost; never true in the border.
    uniform: Vec<bool>,
}

impl Costmap {
    /// A costmap of `frame` in which all cells are lethal.
    pub fn lethal(frame: GridFrame) -> Self {
        let stride = frame.width() + 2;
        let slots = stride * (frame.height() + 2);
        Self { frame, stride, costs: vec![LETHAL; slots], uniform: vec![false; slots] }
    }

    /// The frame of the grid.
    pub fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// The cost per length of a move into `cell`; [`LETHAL`] outside of the grid.
    pub fn cost(&self, cell: Cell) -> u8 {
        if self.frame.contains(cell) { self.costs[self.slot(cell)] } else { LETHAL }
    }

    /// Whether the center of the robot may be in `cell`.
    pub fn is_traversable(&self, cell: Cell) -> bool {
        self.cost(cell) != LETHAL
    }

    /// Sets the cost of a cell of the grid, at most [`MAX_COST`]. Cells outside of the grid stay lethal.
    pub fn set_cost(&mut self, cell: Cell, cost: u8) {
        if self.cost(cell) == cost || !self.frame.contains(cell) {
            return;
        }
        let slot = self.slot(cell);
        self.costs[slot] = cost.min(MAX_COST);
        for around in cell.square(1) {
            if self.frame.contains(around) {
                let slot = self.slot(around);
                self.uniform[slot] = self.is_uniform_around(slot);
            }
        }
    }

    /// Sets the costs of all cells, in row-major order.
    pub fn set_costs(&mut self, costs: impl IntoIterator<Item = u8>) {
        let frame = self.frame;
        for (index, cost) in costs.into_iter().take(frame.len()).enumerate() {
            let slot = self.slot(frame.cell(index));
            self.costs[slot] = cost.min(MAX_COST);
        }
        for index in 0..frame.len() {
            let slot = self.slot(frame.cell(index));
            self.uniform[slot] = self.is_uniform_around(slot);
        }
    }

    fn is_uniform_around(&self, slot: usize) -> bool {
        let cost = self.costs[slot];
        let row = |middle: usize| self.costs[middle - 1..middle + 2] == [cost; 3];
        cost != LETHAL && row(slot) && row(slot - self.stride) && row(slot + self.stride)
    }

    /// The cost of the straight line of cells from `from` (not counted) to `to`, with diagonal moves where they are
    /// allowed; `None` if the line touches a lethal cell. Over free cells no path has a lower cost.
    pub fn line_cost(&self, from: Cell, to: Cell) -> Option<u32> {
        let mut cost = 0;
        let mut last = from;
        for cell in line(from, to) {
            let cell_cost = u32::from(self.cost(cell));
            let diagonal = cell.x != last.x && cell.y != last.y;
            let passes = |x, y| self.is_traversable(Cell::new(x, y));
            let cuts_corner = diagonal && !(passes(cell.x, last.y) && passes(last.x, cell.y));
            if cell_cost == u32::from(LETHAL) || cuts_corner {
                return None;
            }
            cost += cell_cost * if diagonal { DIAGONAL } else { STRAIGHT };
            last = cell;
        }
        Some(cost)
    }

    /// The costs of all slots: the cells and the border around them.
    pub(super) fn slots(&self) -> &[u8] {
        &self.costs
    }

    /// Whether the eight slots around have the same cost.
    pub(super) fn is_uniform(&self, slot: usize) -> bool {
        self.uniform[slot]
    }

    /// The slot of a cell of the grid or of the border.
    pub(super) fn slot(&self, cell: Cell) -> usize {
        (cell.y + 1) as usize * self.stride + (cell.x + 1) as usize
    }
}

/// The cells of the straight line from `from` (not included) to `to` (Bresenham). Each cell shares a side or a
/// corner with the cell before.
pub(super) fn line(from: Cell, to: Cell) -> impl Iterator<Item = Cell> {
    let (dx, dy) = ((to.x - from.x).abs(), (to.y - from.y).abs());
    let (step_x, step_y) = ((to.x - from.x).signum(), (to.y - from.y).signum());
    let (mut at, mut error) = (from, dx - dy);
    (0..dx.max(dy)).map(move |_| {
        let twice = 2 * error;
        if twice > -dy {
            error -= dy;
            at.x += step_x;
        }
        if twice < dx {
            error += dx;
            at.y += step_y;
        }
        at
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::costmap;

    #[test]
    fn a_line_ends_where_it_should() {
        for (x, y) in [(0, 0), (5, 0), (0, -4), (7, 3), (-3, 8), (-6, -6)] {
            let cells: Vec<_> = line(Cell::new(1, 2), Cell::new(1 + x, 2 + y)).collect();
            assert_eq!(cells.len() as i32, x.abs().max(y.abs()));
            assert_eq!(*cells.last().unwrap_or(&Cell::new(1, 2)), Cell::new(1 + x, 2 + y));
        }
    }

    #[test]
    fn a_line_costs_the_cells_it_enters_and_ends_at_walls() {
        let map = costmap(&["...#", "..#.", "3..."]);
        assert_eq!(map.line_cost(Cell::new(0, 2), Cell::new(2, 2)), Some(2 * STRAIGHT));
        assert_eq!(map.line_cost(Cell::new(0, 1), Cell::new(0, 0)), Some(3 * STRAIGHT));
        assert_eq!(map.line_cost(Cell::new(0, 2), Cell::new(1, 1)), Some(DIAGONAL));
        assert_eq!(map.line_cost(Cell::new(1, 1), Cell::new(3, 1)), None, "through a wall");
        assert_eq!(map.line_cost(Cell::new(1, 1), Cell::new(2, 0)), None, "past a corner");
        assert_eq!(map.line_cost(Cell::new(0, 1), Cell::new(-1, 1)), None, "out of the grid");
    }
}
