use interfaces::{Cell, GridFrame};

/// The price of a cell that the robot's centre may not enter.
pub const CLOSED: u8 = 0;
/// The price of a cell far from everything.
pub const OPEN: u8 = 1;
/// The cost of a move to a cell that shares a side, at price [`OPEN`].
pub const STRAIGHT: u32 = 5;
/// The cost of a move to a cell that shares a corner: 7/5 is √2 within one percent, and small
/// integers keep the costs exact and the wavefront's buckets few.
pub const DIAGONAL: u32 = 7;
/// No cell may be dearer: it bounds the number of buckets of a [`Wavefront`](crate::Wavefront).
pub const MAX_PRICE: u8 = 9;

/// What a robot can do in one move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moves {
    /// To one of the four cells that share a side.
    Four,
    /// To one of the eight cells that share a side or a corner; never diagonally past a closed
    /// cell.
    Eight,
}

/// The price of every cell: [`CLOSED`], or what a move into it costs per length. A frame of closed
/// cells is laid around the grid, so that no search has to look where the grid ends.
#[derive(Clone, Debug)]
pub struct Costmap {
    frame: GridFrame,
    stride: usize,
    prices: Vec<u8>,
    /// Whether the eight cells around have the same price; never true in the frame.
    even: Vec<bool>,
}

impl Costmap {
    /// A map of the cells of `frame`, all closed.
    pub fn closed(frame: GridFrame) -> Self {
        let stride = frame.width() + 2;
        let slots = stride * (frame.height() + 2);
        Self { frame, stride, prices: vec![CLOSED; slots], even: vec![false; slots] }
    }

    /// Where the cells lie.
    pub fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// What a move into `cell` costs per length; [`CLOSED`] outside of the grid.
    pub fn price(&self, cell: Cell) -> u8 {
        if self.frame.contains(cell) { self.prices[self.slot(cell)] } else { CLOSED }
    }

    /// Whether the robot's centre may be in `cell`.
    pub fn is_open(&self, cell: Cell) -> bool {
        self.price(cell) != CLOSED
    }

    /// Sets the price of a cell of the grid, at most [`MAX_PRICE`]; cells outside stay closed.
    pub fn set_price(&mut self, cell: Cell, price: u8) {
        if self.price(cell) == price || !self.frame.contains(cell) {
            return;
        }
        let slot = self.slot(cell);
        self.prices[slot] = price.min(MAX_PRICE);
        self.even[slot] = self.look_around(slot);
        for around in cell.neighbours8() {
            if self.frame.contains(around) {
                let slot = self.slot(around);
                self.even[slot] = self.look_around(slot);
            }
        }
    }

    /// Sets the price of all cells at once, in row-major order as in a grid.
    pub fn set_prices(&mut self, prices: impl IntoIterator<Item = u8>) {
        let (width, frame) = (self.frame.width(), self.frame);
        for (index, price) in prices.into_iter().take(frame.len()).enumerate() {
            let slot = (index / width + 1) * self.stride + index % width + 1;
            self.prices[slot] = price.min(MAX_PRICE);
        }
        for index in 0..frame.len() {
            let slot = self.slot(frame.cell(index));
            self.even[slot] = self.look_around(slot);
        }
    }

    /// Whether the prices around a slot of the grid are the same as its own.
    fn look_around(&self, slot: usize) -> bool {
        let price = self.prices[slot];
        let row = |middle: usize| self.prices[middle - 1..middle + 2] == [price; 3];
        price != CLOSED && row(slot) && row(slot - self.stride) && row(slot + self.stride)
    }

    /// The cost of the straight line of cells from `from` (not counted) to `to`, by diagonal moves
    /// where they are allowed; `None` if it touches a closed cell. In the open no way is cheaper.
    pub fn line_cost(&self, from: Cell, to: Cell) -> Option<u32> {
        let mut cost = 0;
        let mut last = from;
        for cell in line(from, to) {
            let price = u32::from(self.price(cell));
            let diagonal = cell.x != last.x && cell.y != last.y;
            let cuts_corner = diagonal
                && !(self.is_open(Cell::new(cell.x, last.y)) && self.is_open(Cell::new(last.x, cell.y)));
            if price == u32::from(CLOSED) || cuts_corner {
                return None;
            }
            cost += price * if diagonal { DIAGONAL } else { STRAIGHT };
            last = cell;
        }
        Some(cost)
    }

    /// All prices with the frame around them.
    pub(crate) fn slots(&self) -> &[u8] {
        &self.prices
    }

    /// Whether the price of a slot is that of all eight around it.
    pub(crate) fn is_even(&self, slot: usize) -> bool {
        self.even[slot]
    }

    /// The slot of a cell of the grid or of the frame around it.
    pub(crate) fn slot(&self, cell: Cell) -> usize {
        (cell.y + 1) as usize * self.stride + (cell.x + 1) as usize
    }
}

/// The cells from `from` (not included) to `to`, each touching the one before at a side or a corner
/// (Bresenham).
pub(crate) fn line(from: Cell, to: Cell) -> impl Iterator<Item = Cell> {
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
    use crate::drawing::costmap;

    #[test]
    fn a_line_ends_where_it_should() {
        for (x, y) in [(0, 0), (5, 0), (0, -4), (7, 3), (-3, 8), (-6, -6)] {
            let cells: Vec<_> = line(Cell::new(1, 2), Cell::new(1 + x, 2 + y)).collect();
            assert_eq!(cells.len() as i32, x.abs().max(y.abs()));
            assert_eq!(*cells.last().unwrap_or(&Cell::new(1, 2)), Cell::new(1 + x, 2 + y));
        }
    }

    #[test]
    fn a_line_pays_for_what_it_enters_and_stops_at_walls() {
        let map = costmap(&["...#", "..#.", "3..."]);
        assert_eq!(map.line_cost(Cell::new(0, 2), Cell::new(2, 2)), Some(2 * STRAIGHT));
        assert_eq!(map.line_cost(Cell::new(0, 1), Cell::new(0, 0)), Some(3 * STRAIGHT));
        assert_eq!(map.line_cost(Cell::new(0, 2), Cell::new(1, 1)), Some(DIAGONAL));
        assert_eq!(map.line_cost(Cell::new(1, 1), Cell::new(3, 1)), None, "through a wall");
        assert_eq!(map.line_cost(Cell::new(1, 1), Cell::new(2, 0)), None, "past a corner");
        assert_eq!(map.line_cost(Cell::new(0, 1), Cell::new(-1, 1)), None, "out of the grid");
    }
}
