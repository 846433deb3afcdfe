use interfaces::{Cell, GridFrame};

/// Marks all cells that are connected with `start` by the sides of cells for which `is_open` holds. Returns the number
/// of cells that were not marked before.
pub(crate) fn flood(
    frame: &GridFrame,
    start: Cell,
    is_open: impl Fn(usize) -> bool,
    reached: &mut [bool],
) -> usize {
    let mut count = 0;
    let mut open: Vec<usize> = frame.index(start).into_iter().collect();
    while let Some(index) = open.pop() {
        if is_open(index) && !std::mem::replace(&mut reached[index], true) {
            count += 1;
            open.extend(frame.beside(index));
        }
    }
    count
}
