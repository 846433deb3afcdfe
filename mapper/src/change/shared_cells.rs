use crate::Growth;
use interfaces::{Values, runs};
use serde::{Serialize, de::DeserializeOwned};
use std::ops::Index;
use std::sync::Arc;

/// The number of cells that are copied at once.
const CHUNK: usize = 64;

/// One value per cell that copies share until one of them changes it: a copy of a large map must not stop the loop of a
/// robot for longer than a few milliseconds.
#[derive(Clone, Debug)]
pub(super) struct SharedCells<T>(Vec<Arc<Vec<T>>>);

impl<T: Clone + Default> SharedCells<T> {
    /// The default value for each of this number of cells.
    pub(super) fn new(cells: usize) -> Self {
        let chunk = |first| Arc::new(vec![T::default(); CHUNK.min(cells - first)]);
        Self((0..cells).step_by(CHUNK).map(chunk).collect())
    }

    /// Whether there is no cell.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The value of a cell; `None` if there is no such cell.
    #[inline]
    pub(super) fn get(&self, index: usize) -> Option<&T> {
        self.0.get(index / CHUNK).and_then(|chunk| chunk.get(index % CHUNK))
    }

    /// The value of a cell, to be changed; `None` if there is no such cell.
    #[inline]
    pub(super) fn get_mut(&mut self, index: usize) -> Option<&mut T> {
        self.0.get_mut(index / CHUNK).and_then(|chunk| Arc::make_mut(chunk).get_mut(index % CHUNK))
    }

    /// Moves all values into a larger map.
    pub(super) fn grow(&mut self, growth: &Growth) {
        if self.is_empty() {
            return;
        }
        let mut moved = Self::new(growth.frame().len());
        for (index, value) in self.0.iter().flat_map(|chunk| chunk.iter()).enumerate() {
            if let Some(to) = moved.get_mut(growth.index(index)) {
                *to = value.clone();
            }
        }
        *self = moved;
    }

    /// All values, as runs.
    pub(super) fn values(&mut self) -> Values<'_>
    where
        T: Serialize + DeserializeOwned,
    {
        self.0.iter_mut().map(|chunk| runs(Arc::make_mut(chunk).as_mut_slice())).collect()
    }
}

impl<T> Index<usize> for SharedCells<T> {
    type Output = T;

    #[inline]
    fn index(&self, index: usize) -> &T {
        &self.0[index / CHUNK][index % CHUNK]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_does_not_reach_a_copy() {
        let mut cells = SharedCells::new(130);
        *cells.get_mut(129).unwrap() = 1;
        let copy = cells.clone();
        *cells.get_mut(129).unwrap() = 2;
        *cells.get_mut(63).unwrap() = 3;
        assert_eq!([cells[129], cells[63], cells[64]], [2, 3, 0]);
        assert_eq!([copy[129], copy[63], copy[64]], [1, 0, 0]);
        assert!(cells.get_mut(130).is_none() && SharedCells::<u8>::new(0).is_empty());
    }
}
