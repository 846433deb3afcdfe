//! Images of a large map: their cells are as much larger as is needed for the memory of a viewer.

use draw::layers::UNKNOWN;
use interfaces::{Grid, GridFrame};

/// The maximum number of cells of an image: a square of 145 m with cells of 0.05 m.
const MAX_CELLS: usize = 1 << 23;

/// The cells of the images of a map with this frame at the end of the run.
pub(super) fn frame(whole: &GridFrame) -> GridFrame {
    of_at_most(whole, MAX_CELLS)
}

fn of_at_most(whole: &GridFrame, most: usize) -> GridFrame {
    let frame = |side: usize| {
        let [width, height] = [whole.width(), whole.height()].map(|cells| cells.div_ceil(side));
        GridFrame::new(whole.origin(), side as f64 * whole.resolution_m(), width, height)
    };
    (1..=whole.len()).filter_map(frame).find(|frame| frame.len() <= most).unwrap_or(*whole)
}

/// The class of each cell of an image: of the cells of the map in it, the highest one. Values are above surfaces, and surfaces
/// above free cells. The map can still be smaller than at the end.
pub(super) fn classes(frame: &GridFrame, map: &Grid<u8>) -> Vec<u8> {
    if frame == map.frame() {
        return map.cells().to_vec();
    }
    let mut classes = vec![UNKNOWN; frame.len()];
    for (index, class) in map.cells().other_than(UNKNOWN) {
        let center = map.frame().center(map.frame().cell(index));
        if let Some(at) = frame.index(frame.cell_at(&center)) {
            classes[at] = classes[at].max(*class);
        }
    }
    classes
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Cell;
    use nalgebra::Point2;

    #[test]
    fn a_coarse_image_shows_the_highest_class_of_its_cells() {
        let frame = |x: f64, width, height| GridFrame::new(Point2::new(x, 0.0), 0.5, width, height).unwrap();
        let (whole, before) = (frame(0.0, 7, 4), frame(0.5, 6, 4));
        let mut map = Grid::filled(before, UNKNOWN);
        for (x, y, class) in [(0, 0, 2), (1, 0, 3), (5, 3, 9), (0, 3, 4)] {
            map.set(Cell::new(x, y), class);
        }
        let coarse = of_at_most(&whole, 8);
        assert_eq!((coarse.resolution_m(), coarse.width(), coarse.height()), (1.0, 4, 2));
        assert_eq!(classes(&coarse, &map), [2, 3, 1, 1, 4, 1, 1, 9]);
        let fine = classes(&of_at_most(&whole, 28), &map);
        assert_eq!((fine[1], fine.len()), (2, 28));
        assert_eq!(classes(&super::frame(&before), &map), map.cells().to_vec());
    }
}
