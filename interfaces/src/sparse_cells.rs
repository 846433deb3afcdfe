//! One value per cell of a grid, in memory that grows with what differs.

use crate::values::{CellList, ValueError, write_value};
use serde::{Serialize, de::DeserializeOwned};
use std::ops::{Index, IndexMut};

/// The side of a block, in cells: 0.8 m with cells of 0.05 m. Smaller blocks follow the border of what was seen more closely, and
/// larger ones need a smaller table.
const SIDE: usize = 1 << SHIFT;
const SHIFT: usize = 4;
/// The number of cells of a block.
const BLOCK: usize = SIDE * SIDE;
/// A grid of at most this number of cells has no blocks: its values are in the order of their indices, which is faster to read.
pub const SMALL_GRID: usize = 1 << 17;

/// Where a cell of a grid is stored, in all lists of this grid.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    table: usize,
    offset: usize,
}

/// One value per cell of a grid, addressed by the index of the cell in row-major order.
///
/// The grid is divided into square blocks of 16 × 16 cells. A block exists from the first time that one of its cells gets a value;
/// all other cells have the value of [`fill`](Self::fill). Memory: 4 bytes per 256 cells of the outline, and all cells of the blocks
/// that exist. A grid of at most 2¹⁷ cells (328 m² with cells of 0.05 m) is one block in row-major order, which always exists.
#[derive(Clone, Debug)]
pub struct SparseCells<T> {
    width: usize,
    height: usize,
    /// For the quotient of an index and the width: 2⁶³ / width, rounded up.
    inverse: u64,
    /// The number of blocks beside each other; 0 for a small grid, which has no blocks.
    columns: usize,
    /// The number of each block, or 0 for a block that does not exist.
    table: Vec<u32>,
    /// The values of all blocks. Block 0 is that of all places without a block. Of a small grid: the values of all cells, and that
    /// of [`fill`](Self::fill).
    values: Vec<T>,
}

impl<T: Clone> SparseCells<T> {
    /// The value `fill` for each cell of a grid with this width, at least 1, and height.
    pub fn new(width: usize, height: usize, fill: T) -> Self {
        Self::small_up_to(SMALL_GRID, width, height, fill)
    }

    /// The same in blocks, however small the grid is: for values that most cells of most grids do not have.
    pub fn in_blocks(width: usize, height: usize, fill: T) -> Self {
        Self::small_up_to(0, width, height, fill)
    }

    /// The same, small up to this number of cells.
    fn small_up_to(small: usize, width: usize, height: usize, fill: T) -> Self {
        let (cells, inverse) = (width * height, (1 << 63) / (width as u64) + 1);
        if cells <= small {
            return Self {
                width,
                height,
                inverse,
                columns: 0,
                table: vec![0],
                values: vec![fill; cells + 1],
            };
        }
        let columns = width.div_ceil(SIDE);
        let table = vec![0; columns * height.div_ceil(SIDE)];
        Self { width, height, inverse, columns, table, values: vec![fill; BLOCK] }
    }

    /// The value of a cell, to be changed; `None` outside of the grid.
    #[inline]
    pub fn get_mut(&mut self, index: usize) -> Option<&mut T> {
        (index < self.len()).then(|| &mut self[index])
    }

    /// The values of all cells.
    pub fn to_vec(&self) -> Vec<T> {
        self.iter().cloned().collect()
    }

    /// Adds the block at a place of the table; returns its number.
    #[cold]
    fn add(&mut self, place: usize) -> usize {
        let block = self.values.len() / BLOCK;
        if self.values.len() == self.values.capacity() {
            // Twice as much at a time would leave up to half of the memory unused.
            self.values.reserve_exact((self.values.len() / 8).next_multiple_of(BLOCK).max(BLOCK));
        }
        self.values.extend_from_within(..BLOCK);
        self.table[place] = block as u32;
        block
    }
}

impl<T> SparseCells<T> {
    /// The same cells with other values: `f` is called once for all cells without a block, and for every other cell.
    pub fn map<U: Clone>(&self, f: impl FnMut(&T) -> U) -> SparseCells<U> {
        SparseCells {
            width: self.width,
            height: self.height,
            inverse: self.inverse,
            columns: self.columns,
            table: self.table.clone(),
            values: self.mapped(f),
        }
    }

    fn mapped<U: Clone>(&self, mut f: impl FnMut(&T) -> U) -> Vec<U> {
        if self.is_small() {
            return self.values.iter().map(f).collect();
        }
        let mut values = Vec::with_capacity(self.values.len());
        values.resize(BLOCK, f(&self.values[0]));
        values.extend(self.values[BLOCK..].iter().map(f));
        values
    }

    /// The number of cells.
    #[inline]
    pub fn len(&self) -> usize {
        self.width * self.height
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value of all cells without a block.
    pub fn fill(&self) -> &T {
        &self.values[if self.is_small() { self.len() } else { 0 }]
    }

    /// Whether there are no blocks.
    #[inline(always)]
    pub fn is_small(&self) -> bool {
        self.columns == 0
    }

    /// The memory of all values, bytes, without what they own elsewhere.
    pub fn bytes(&self) -> usize {
        self.values.capacity() * size_of::<T>() + self.table.len() * size_of::<u32>()
    }

    /// Where a cell is stored, for several lists of one grid: to find that takes as long as to read a value.
    #[inline]
    pub fn place(&self, index: usize) -> Place {
        let (table, offset) = self.at(index);
        Place { table, offset }
    }

    /// The value at a place.
    #[inline]
    pub fn at_place(&self, Place { table, offset }: Place) -> &T {
        &self.values[self.table[table] as usize * BLOCK + offset]
    }

    /// The place of a cell in the table, and in its block.
    #[inline(always)]
    fn at(&self, index: usize) -> (usize, usize) {
        if self.is_small() {
            return (0, index);
        }
        let row = ((u128::from(index as u64) * u128::from(self.inverse)) >> 63) as usize;
        let column = index - row * self.width;
        ((row >> SHIFT) * self.columns + (column >> SHIFT), ((row % SIDE) << SHIFT) + column % SIDE)
    }

    /// The value of a cell; `None` outside of the grid.
    #[inline]
    pub fn get(&self, index: usize) -> Option<&T> {
        (index < self.len()).then(|| &self[index])
    }

    /// Whether the block of a cell exists.
    #[inline]
    pub fn is_stored(&self, index: usize) -> bool {
        self.is_small() || self.table[self.at(index).0] != 0
    }

    /// The value of a cell, if its block exists.
    #[inline]
    pub fn stored_mut(&mut self, index: usize) -> Option<&mut T> {
        let (place, offset) = self.at(index);
        let block = self.table[place] as usize;
        (block != 0 || self.is_small()).then(|| &mut self.values[block * BLOCK + offset])
    }

    /// The values of all blocks that exist, in no particular order, and with some that belong to no cell.
    pub fn stored_values(&self) -> impl Iterator<Item = &T> {
        let stored = if self.is_small() { 0..self.len() } else { BLOCK..self.values.len() };
        self.values[stored].iter()
    }

    /// The same, to be changed.
    pub fn stored_values_mut(&mut self) -> impl Iterator<Item = &mut T> {
        let stored = if self.is_small() { 0..self.len() } else { BLOCK..self.values.len() };
        self.values[stored].iter_mut()
    }

    /// The cells of a row that lie in one block: those from `column` on. Also whether the block exists.
    #[inline]
    fn piece(&self, row: usize, column: usize) -> (&[T], bool) {
        if self.is_small() {
            return (&self.values[row * self.width + column..(row + 1) * self.width], true);
        }
        let block = self.table[(row >> SHIFT) * self.columns + (column >> SHIFT)] as usize;
        let start = block * BLOCK + (((row % SIDE) << SHIFT) + column % SIDE);
        let length = (SIDE - column % SIDE).min(self.width - column);
        (&self.values[start..start + length], block != 0)
    }

    /// The pieces of a row: the index of their first cell, their values, and whether their block exists.
    fn pieces(&self, row: usize) -> impl DoubleEndedIterator<Item = (usize, &[T], bool)> {
        (0..self.columns.max(1)).map(move |block| {
            let column = block << SHIFT;
            let (values, is_stored) = self.piece(row, column);
            (row * self.width + column, values, is_stored)
        })
    }

    /// The values of the cells of a row.
    pub fn row(&self, row: usize) -> impl DoubleEndedIterator<Item = &T> {
        self.pieces(row).flat_map(|(_, values, _)| values)
    }

    /// The values of all cells, in the order of their indices.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &T> {
        (0..self.height).flat_map(|row| self.row(row))
    }

    /// The cells whose blocks exist, in the order of their indices, with their values.
    pub fn stored(&self) -> impl Iterator<Item = (usize, &T)> {
        let pieces = (0..self.height).flat_map(|row| self.pieces(row)).filter(|(.., is_stored)| *is_stored);
        pieces.flat_map(|(start, values, _)| (start..).zip(values))
    }

    /// The cells with another value than this one, in the order of their indices, with their values: in a time that is
    /// proportional to the number of cells with blocks, if the value is that of all others.
    pub fn other_than(&self, value: T) -> impl Iterator<Item = (usize, &T)>
    where
        T: PartialEq + Copy,
    {
        let is_fill_other = *self.fill() != value;
        let pieces = (0..self.height).flat_map(|row| self.pieces(row));
        let pieces = pieces.filter(move |(.., is_stored)| is_fill_other || *is_stored);
        pieces.flat_map(|(start, values, _)| (start..).zip(values)).filter(move |(_, other)| **other != value)
    }

    /// Calls `f` with the pieces of a run of cells of one row, from `start` up to, but not including, `end`, that lie in one block
    /// each: the index of the first cell, the index after the last one, and the values; no values where the block does not exist.
    #[inline]
    pub fn each_piece_mut(
        &mut self,
        start: usize,
        end: usize,
        mut f: impl FnMut(usize, usize, Option<&mut [T]>),
    ) {
        if self.is_small() {
            return f(start, end, Some(&mut self.values[start..end]));
        }
        let (mut place, mut offset) = self.at(start);
        let mut from = start;
        while from < end {
            let length = (SIDE - offset % SIDE).min(end - from);
            let first = self.table[place] as usize * BLOCK + offset;
            let values = if first >= BLOCK { Some(&mut self.values[first..first + length]) } else { None };
            f(from, from + length, values);
            (from, place, offset) = (from + length, place + 1, offset & !(SIDE - 1));
        }
    }

    /// The number of cells from this one on that certainly have equal values.
    pub fn alike(&self, index: usize) -> usize {
        if self.is_small() {
            return 1;
        }
        let (mut place, offset) = self.at(index);
        let (mut until, row_end) = (index, (index / self.width + 1) * self.width);
        let mut length = SIDE - offset % SIDE;
        while until < row_end && self.table[place] == 0 {
            (until, place, length) = (until + length, place + 1, SIDE);
        }
        until.min(row_end).max(index + 1) - index
    }
}

impl<T: Clone + PartialEq> SparseCells<T> {
    /// The values of all cells of a grid with this width, in the order of their indices. Blocks exist where values differ from
    /// the first one.
    pub fn from_vec(width: usize, values: Vec<T>) -> Self {
        let Some(first) = values.first().cloned() else { return Self::empty() };
        let mut cells = Self::new(width, values.len() / width, first);
        values.into_iter().enumerate().for_each(|(index, value)| cells.set(index, value));
        cells
    }

    fn empty() -> Self {
        Self { width: 1, height: 0, inverse: 0, columns: 1, table: Vec::new(), values: Vec::new() }
    }

    /// Sets the value of a cell. A value that the cell has already needs no block.
    #[inline]
    pub fn set(&mut self, index: usize, value: T) {
        if self[index] != value {
            self[index] = value;
        }
    }
}

impl<T> Index<usize> for SparseCells<T> {
    type Output = T;

    #[inline(always)] // Otherwise the compiler calls it in the loops over the cells of a scan.
    fn index(&self, index: usize) -> &T {
        if self.is_small() {
            return &self.values[index];
        }
        let (place, offset) = self.at(index);
        &self.values[self.table[place] as usize * BLOCK + offset]
    }
}

impl<T: Clone> IndexMut<usize> for SparseCells<T> {
    #[inline(always)]
    fn index_mut(&mut self, index: usize) -> &mut T {
        if self.is_small() {
            return &mut self.values[index];
        }
        let (place, offset) = self.at(index);
        let block = match self.table[place] as usize {
            0 => self.add(place),
            block => block,
        };
        &mut self.values[block * BLOCK + offset]
    }
}

/// Equal values in all cells, whatever blocks exist.
impl<T: PartialEq> PartialEq for SparseCells<T> {
    fn eq(&self, other: &Self) -> bool {
        (self.width, self.height) == (other.width, other.height) && self.iter().eq(other.iter())
    }
}

impl<T: Clone + PartialEq + Serialize + DeserializeOwned> CellList for &mut SparseCells<T> {
    type Item = T;

    fn len(&self) -> usize {
        SparseCells::len(self)
    }

    fn write(&self, index: usize, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
        write_value(&self[index], bytes)
    }

    fn alike(&self, index: usize) -> usize {
        SparseCells::alike(self, index)
    }

    fn set(&mut self, index: usize, value: &T) {
        SparseCells::set(self, index, value.clone());
    }
}

#[cfg(test)]
mod tests;
