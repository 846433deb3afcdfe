/// In which cells a thing in a room can be seen by a robot that comes in.
///
/// A robot that is inside when the door closes goes on looking. The bound lets it see all things of the room in every
/// cell from then on, at the price of a look in the cell after a look.
pub(super) struct Access {
    is_open: Vec<bool>,
    /// The first open cell from each cell on; the number of cells if there is none.
    next_open: Vec<usize>,
}

impl Access {
    pub(super) fn of(is_open: Vec<bool>) -> Self {
        let mut next_open = vec![is_open.len(); is_open.len()];
        let mut next = is_open.len();
        for cell in (0..is_open.len()).rev() {
            next = if is_open[cell] { cell } else { next };
            next_open[cell] = next;
        }
        Self { is_open, next_open }
    }

    pub(super) fn is_open(&self, cell: usize) -> bool {
        self.is_open[cell]
    }

    pub(super) fn next_open(&self, cell: usize) -> usize {
        self.next_open[cell]
    }
}
