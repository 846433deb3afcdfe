//! The surfaces of all cells: most cells have none.

use super::Surface;
use crate::Growth;
use interfaces::{CellList, GridFrame, SparseCells, ValueError, write_value};
use std::ops::{Index, IndexMut};

/// One surface per cell. A cell takes four bytes until it is changed for the first time.
#[derive(Clone, Debug)]
pub(super) struct Surfaces {
    /// The number of the surface of each cell; 0 for cells without one.
    numbers: SparseCells<u32>,
    /// All surfaces; the first one is that of all cells without one.
    surfaces: Vec<Surface>,
}

impl Surfaces {
    pub(super) fn new(frame: &GridFrame) -> Self {
        let numbers = SparseCells::new(frame.width(), frame.height(), 0);
        Self { numbers, surfaces: vec![Surface::default()] }
    }

    /// Whether the surface of a cell was never changed.
    #[inline]
    pub(super) fn is_none(&self, index: usize) -> bool {
        self.numbers[index] == 0
    }

    /// The surface of a cell, to be changed, if it was ever changed.
    #[inline]
    pub(super) fn stored_mut(&mut self, index: usize) -> Option<&mut Surface> {
        match self.numbers[index] {
            0 => None,
            number => self.surfaces.get_mut(number as usize),
        }
    }

    /// The surfaces that were ever changed.
    pub(super) fn all_mut(&mut self) -> impl Iterator<Item = &mut Surface> {
        self.surfaces.iter_mut().skip(1)
    }

    /// Moves all surfaces into a larger map.
    pub(super) fn grow(&mut self, growth: &Growth) {
        growth.sparse(&mut self.numbers);
    }

    /// The memory of all surfaces, bytes.
    pub(super) fn bytes(&self) -> usize {
        self.numbers.bytes() + self.surfaces.capacity() * size_of::<Surface>()
    }
}

impl CellList for &mut Surfaces {
    type Item = Surface;

    fn len(&self) -> usize {
        self.numbers.len()
    }

    fn write(&self, index: usize, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
        write_value(&self[index], bytes)
    }

    fn alike(&self, index: usize) -> usize {
        self.numbers.alike(index)
    }

    /// One that the cell has already needs no memory.
    fn set(&mut self, index: usize, surface: &Surface) {
        if self[index] != *surface {
            self[index] = *surface;
        }
    }
}

impl Index<usize> for Surfaces {
    type Output = Surface;

    #[inline]
    fn index(&self, index: usize) -> &Surface {
        &self.surfaces[self.numbers[index] as usize]
    }
}

impl IndexMut<usize> for Surfaces {
    #[inline]
    fn index_mut(&mut self, index: usize) -> &mut Surface {
        if self.numbers[index] == 0 {
            self.numbers[index] = self.surfaces.len() as u32;
            self.surfaces.push(Surface::default());
        }
        &mut self.surfaces[self.numbers[index] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    #[test]
    fn only_cells_that_were_changed_have_a_surface() {
        let mut surfaces = &mut Surfaces::new(&GridFrame::new(Point2::origin(), 0.05, 20, 20).unwrap());
        surfaces.set(7, &Surface::default());
        assert!(surfaces.stored_mut(7).is_none() && surfaces.all_mut().count() == 0);
        surfaces[7].hits = 3;
        surfaces.set(399, &Surface { hits: 4, ..Surface::default() });
        assert_eq!([surfaces[6].hits, surfaces[7].hits, surfaces[399].hits], [0, 3, 4]);
        surfaces.set(7, &Surface::default());
        assert_eq!((surfaces[7], surfaces.all_mut().count(), surfaces.len()), (Surface::default(), 2, 400));
    }
}
