use interfaces::{Cell, GridFrame};

/// Enters `start` and all cells that are connected with it by the sides of cells. `enter` returns whether a cell is
/// open and has not been entered before. Returns the number of cells that were entered.
pub(crate) fn flood(frame: &GridFrame, start: Cell, mut enter: impl FnMut(usize) -> bool) -> usize {
    let mut count = 0;
    let mut open: Vec<usize> = frame.index(start).into_iter().collect();
    while let Some(index) = open.pop() {
        if enter(index) {
            count += 1;
            open.extend(frame.beside(index));
        }
    }
    count
}
