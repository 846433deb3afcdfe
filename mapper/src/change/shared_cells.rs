use crate::Growth;
use interfaces::{CellList, GridFrame, Place, SparseCells, ValueError, write_value};
use serde::{Serialize, de::DeserializeOwned};
use std::ops::Index;
use std::sync::Arc;

/// The number of values that are copied at once.
const CHUNK: usize = 64;

/// One value per cell that copies share until one of them changes it: a copy of a large map must not stop the loop of a
/// robot for longer than a few milliseconds. A value takes memory from the first time that it differs from the default.
#[derive(Clone, Debug)]
pub(super) struct SharedCells<T> {
    /// The number of the value of each cell, plus one; 0 for the default.
    numbers: SparseCells<u32>,
    /// All values but the default, in the order in which they were made.
    chunks: Vec<Arc<Vec<T>>>,
    default: T,
}

impl<T: Clone + Default + PartialEq> SharedCells<T> {
    /// The default value for each cell of a frame.
    pub(super) fn new(frame: &GridFrame) -> Self {
        let numbers = SparseCells::in_blocks(frame.width(), frame.height(), 0);
        Self { numbers, chunks: Vec::new(), default: T::default() }
    }

    /// The value at a place of a grid in blocks.
    #[inline]
    pub(super) fn at(&self, place: Place) -> &T {
        match *self.numbers.at_place(place) as usize {
            0 => &self.default,
            number => &self.chunks[(number - 1) / CHUNK][(number - 1) % CHUNK],
        }
    }

    /// The value of a cell, to be changed, if it was ever changed.
    pub(super) fn changed_mut(&mut self, index: usize) -> Option<&mut T> {
        let number = self.numbers[index].checked_sub(1)? as usize;
        Arc::make_mut(self.chunks.get_mut(number / CHUNK)?).get_mut(number % CHUNK)
    }

    /// The value of a cell, to be changed.
    pub(super) fn get_mut(&mut self, index: usize) -> Option<&mut T> {
        if self.numbers[index] == 0 {
            if self.chunks.last().is_none_or(|chunk| chunk.len() == CHUNK) {
                self.chunks.push(Arc::new(Vec::with_capacity(CHUNK)));
            }
            let before = (self.chunks.len() - 1) * CHUNK;
            let chunk = Arc::make_mut(self.chunks.last_mut()?);
            chunk.push(T::default());
            self.numbers[index] = (before + chunk.len()) as u32;
        }
        self.changed_mut(index)
    }

    /// Moves all values into a larger map.
    pub(super) fn grow(&mut self, growth: &Growth) {
        growth.sparse(&mut self.numbers);
    }

    /// The memory of all values, bytes, without what they own elsewhere.
    pub(super) fn bytes(&self) -> usize {
        self.numbers.bytes() + self.chunks.len() * CHUNK * size_of::<T>()
    }

    /// The values that were ever changed.
    pub(super) fn changed(&self) -> impl Iterator<Item = &T> {
        self.chunks.iter().flat_map(|chunk| chunk.iter())
    }
}

/// In a state file, runs end after this number of cells.
pub(super) const RUN: usize = CHUNK;

impl<T: Clone + Default + PartialEq + Serialize + DeserializeOwned> CellList for &mut SharedCells<T> {
    type Item = T;

    fn len(&self) -> usize {
        self.numbers.len()
    }

    fn write(&self, index: usize, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
        write_value(&self[index], bytes)
    }

    fn alike(&self, index: usize) -> usize {
        self.numbers.alike(index)
    }

    fn set(&mut self, index: usize, value: &T) {
        if self[index] != *value
            && let Some(own) = self.get_mut(index)
        {
            *own = value.clone();
        }
    }
}

impl<T: Clone + Default + PartialEq> Index<usize> for SharedCells<T> {
    type Output = T;

    #[inline]
    fn index(&self, index: usize) -> &T {
        self.at(self.numbers.place(index))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    #[test]
    fn a_change_does_not_reach_a_copy() {
        let frame = GridFrame::new(Point2::origin(), 0.1, 13, 10).unwrap();
        let mut cells = SharedCells::new(&frame);
        *cells.get_mut(129).unwrap() = 1;
        let copy = cells.clone();
        *cells.get_mut(129).unwrap() = 2;
        *cells.get_mut(63).unwrap() = 3;
        assert_eq!([cells[129], cells[63], cells[64]], [2, 3, 0]);
        assert_eq!([copy[129], copy[63], copy[64]], [1, 0, 0]);
        assert_eq!((cells.changed_mut(63), copy.chunks.len()), (Some(&mut 3), 1));
        assert!(cells.changed_mut(64).is_none());
    }
}
