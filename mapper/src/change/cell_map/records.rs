//! The records of all cells. That of a cell that never changed is short.

use super::record::Record;
use super::{NEVER, ReadingIndex};
use crate::Growth;
use interfaces::{CellList, GridFrame, Place, SparseCells, ValueError, write_value};

/// The record of a cell that was in view in one state only, or a reference to a long one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Short {
    first: ReadingIndex,
    since: ReadingIndex,
    /// The time in view in the only state.
    watched: f64,
    /// The number of the long record.
    long: u32,
    is_whole: bool,
    was_corrected: bool,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Kind {
    #[default]
    Free,
    Blocked,
    Long,
}

/// The memory of the record of a cell that never changed, bytes.
pub(super) const BYTES_PER_CELL: usize = size_of::<Short>();

/// One record per cell.
#[derive(Clone, Debug)]
pub(super) struct Records {
    short: SparseCells<Short>,
    /// Those of cells that changed.
    long: Vec<Record>,
}

impl Records {
    pub(super) fn new(frame: &GridFrame) -> Self {
        let short = SparseCells::in_blocks(frame.width(), frame.height(), Short::default());
        Self { short, long: Vec::new() }
    }

    /// The record of a cell.
    #[inline]
    pub(super) fn get(&self, index: usize) -> Record {
        self.at(self.short.place(index))
    }

    /// Where the record of a cell is stored: in blocks, as all values that cells have only once they were seen.
    #[inline]
    pub(super) fn place(&self, index: usize) -> Place {
        self.short.place(index)
    }

    /// The record at a place.
    #[inline]
    pub(super) fn at(&self, place: Place) -> Record {
        let Short { first, since, watched, long, is_whole, was_corrected, kind } =
            *self.short.at_place(place);
        let record = Record { first, since, is_whole, was_corrected, ..Record::default() };
        match kind {
            Kind::Free => Record { watched: [watched, 0.0], ..record },
            Kind::Blocked => Record { watched: [0.0, watched], ..record },
            Kind::Long => self.long[long as usize],
        }
    }

    /// [`Record::since`] of a cell.
    #[inline]
    pub(super) fn since(&self, index: usize) -> ReadingIndex {
        self.short[index].since
    }

    /// Whether the state of a cell is known.
    #[inline]
    pub(super) fn is_known(&self, index: usize) -> bool {
        self.short[index].first != NEVER
    }

    /// Replaces the record of a cell.
    pub(super) fn set(&mut self, index: usize, record: Record) {
        let Record { first, since, watched, is_whole, was_corrected, .. } = record;
        let short = Short { first, since, is_whole, was_corrected, ..Short::default() };
        let present = self.short[index];
        if present.kind == Kind::Long {
            self.long[present.long as usize] = record;
            self.short[index] = Short { long: present.long, kind: Kind::Long, ..short };
        } else if let Some(state) = record.only_state() {
            let kind = if state == 0 { Kind::Free } else { Kind::Blocked };
            self.short.set(index, Short { watched: watched[state], kind, ..short });
        } else {
            self.short[index] = Short { long: self.long.len() as u32, kind: Kind::Long, ..short };
            self.long.push(record);
        }
    }

    /// The readings to which the records refer.
    pub(super) fn readings(&self) -> impl Iterator<Item = ReadingIndex> {
        self.short.stored_values().flat_map(|record| [record.first, record.since])
    }

    /// Whether the records of all cells that changed, and only those, have their number among these, and count at most one event per
    /// reading.
    pub(super) fn are_sound(&self, changed: &[u32], open: ReadingIndex) -> bool {
        let slots = self.long.iter().filter_map(|record| record.slot);
        let has_slot = |(slot, index): (usize, &u32)| self.get(*index as usize).slot == Some(slot as u32);
        slots.count() == changed.len()
            && changed.iter().enumerate().all(has_slot)
            && self
                .long
                .iter()
                .flat_map(|record| record.in_view.iter().chain(&record.after_gap))
                .all(|count| *count <= open)
    }

    /// Moves all cells into a larger map.
    pub(super) fn grow(&mut self, growth: &Growth) {
        growth.sparse(&mut self.short);
    }

    /// The memory of all records, bytes.
    pub(super) fn bytes(&self) -> usize {
        self.short.bytes() + self.long.capacity() * size_of::<Record>()
    }
}

impl CellList for &mut Records {
    type Item = Record;

    fn len(&self) -> usize {
        self.short.len()
    }

    fn write(&self, index: usize, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
        write_value(&self.get(index), bytes)
    }

    fn alike(&self, index: usize) -> usize {
        self.short.alike(index)
    }

    fn set(&mut self, index: usize, value: &Record) {
        Records::set(self, index, *value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    #[test]
    fn every_record_comes_back() {
        let frame = GridFrame::new(Point2::origin(), 0.05, 20, 20).unwrap();
        let mut records = Records::new(&frame);
        let seen = Record { watched: [0.0, 3.5], ..Record::since(4) };
        let both = Record { watched: [1.0, 3.5], ..Record::since(4) };
        let negative = Record { watched: [-0.0, 0.0], ..Record::since(2) };
        let event = Record { in_view: [1, 0], ..Record::since(4) };
        let corrected = |first| Record { was_corrected: true, ..Record::since(first) };
        let changed = Record { watched: [1.0, 0.0], slot: Some(0), is_whole: true, ..corrected(9) };
        let all = [Record::default(), Record::since(3), corrected(5), seen, both, negative, event, changed];
        for (index, record) in all.into_iter().enumerate() {
            records.set(index * 40, record);
        }
        for (index, record) in all.into_iter().enumerate() {
            let found = records.get(index * 40);
            assert_eq!(found, record);
            assert_eq!(found.watched.map(f64::to_bits), record.watched.map(f64::to_bits));
            assert_eq!(records.since(index * 40), record.since);
            assert_eq!(records.is_known(index * 40), record.is_known());
        }
        // A long record stays long, and shows the new values.
        records.set(7 * 40, corrected(11));
        assert_eq!((records.get(7 * 40), records.since(7 * 40)), (corrected(11), 11));
        assert_eq!(size_of::<Short>(), 24);
    }
}
