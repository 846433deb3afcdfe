//! Images of a large map: their cells are as much larger as is needed for the memory of a viewer.

use draw::layers::UNKNOWN;
use interfaces::{Cell, Grid, GridFrame};
use mapper::Growth;

/// The maximum number of cells of an image: a square of 145 m with cells of 0.05 m.
const MAX_CELLS: usize = 1 << 23;

/// The frame of the images of a map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coarse {
    /// The cells of an image.
    pub(super) frame: GridFrame,
    whole: GridFrame,
    /// The number of cells of the map along the side of one of an image.
    side: usize,
}

impl Coarse {
    /// The images of a map with this frame, at the end of the run.
    pub(super) fn new(whole: &GridFrame) -> Self {
        Self::of_at_most(whole, MAX_CELLS)
    }

    fn of_at_most(whole: &GridFrame, most: usize) -> Self {
        let frame = |side: usize| {
            let [width, height] = [whole.width(), whole.height()].map(|cells| cells.div_ceil(side));
            GridFrame::new(whole.origin(), side as f64 * whole.resolution_m(), width, height)
        };
        let is_small = |side: &usize| frame(*side).is_some_and(|frame| frame.len() <= most);
        let side = (1..).find(is_small).unwrap_or(1);
        Self { frame: frame(side).unwrap_or(*whole), whole: *whole, side }
    }

    /// The class of each cell of an image: of the cells of the map in it, the highest one. Values are above surfaces, and surfaces
    /// above free cells. The map can still be smaller than at the end.
    pub(super) fn classes(&self, map: &Grid<u8>) -> Vec<u8> {
        let growth = Growth::new(*map.frame(), self.whole);
        if self.side == 1 && growth.is_none_or(|growth| growth.frame() == map.frame()) {
            return map.cells().to_vec();
        }
        let mut classes = vec![UNKNOWN; self.frame.len()];
        for (index, class) in map.cells().other_than(UNKNOWN) {
            let index = growth.map_or(index, |growth| growth.index(index));
            let Cell { x, y } = self.whole.cell(index);
            let at = y as usize / self.side * self.frame.width() + x as usize / self.side;
            classes[at] = classes[at].max(*class);
        }
        classes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    #[test]
    fn a_coarse_image_shows_the_highest_class_of_its_cells() {
        let frame = |x: f64, width, height| GridFrame::new(Point2::new(x, 0.0), 0.5, width, height).unwrap();
        let (whole, before) = (frame(0.0, 7, 4), frame(0.5, 6, 4));
        let mut map = Grid::filled(before, UNKNOWN);
        for (x, y, class) in [(0, 0, 2), (1, 0, 3), (5, 3, 9), (0, 3, 4)] {
            map.set(Cell::new(x, y), class);
        }
        let coarse = Coarse::of_at_most(&whole, 8);
        assert_eq!((coarse.side, coarse.frame.width(), coarse.frame.height()), (2, 4, 2));
        assert_eq!(coarse.classes(&map), [2, 3, 1, 1, 4, 1, 1, 9]);
        let fine = Coarse::of_at_most(&whole, 28);
        assert_eq!((fine.side, fine.classes(&map)[1], fine.classes(&map).len()), (1, 2, 28));
        assert_eq!(Coarse::new(&before).classes(&map), map.cells().to_vec());
    }
}
