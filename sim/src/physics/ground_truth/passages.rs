//! What moving things did to a cell.

use crate::physics::report::Body;
use interfaces::{SparseCells, Value, ValueError, runs, value};

/// What moving things did to a cell so far, and do now.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Passages {
    /// The number of robots that overlap the cell, and the number of robots that cover all of the cell.
    pub(super) overlapped: u16,
    pub(super) covered: u16,
    pub(super) block_events: u32,
    /// How often the cell was free and then overlapped.
    pub(super) pass_events: u32,
    pub(super) mover: Mover,
}

impl Passages {
    /// The same without events.
    pub(super) fn without_events(self) -> Self {
        Self { block_events: 0, pass_events: 0, ..self }
    }
}

/// The first moving thing that touched a cell, in four bytes: 0 for none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Mover(u32);

impl Mover {
    pub(super) fn of(body: Body) -> Self {
        let (kind, index) = match body {
            Body::Wall(index) => (1, index),
            Body::Obstacle(index) => (2, index),
            Body::Robot(index) => (3, index),
        };
        Self(3 * index as u32 + kind)
    }

    pub(super) fn body(self) -> Option<Body> {
        let number = self.0.checked_sub(1)?;
        let index = (number / 3) as usize;
        Some(match number % 3 {
            0 => Body::Wall(index),
            1 => Body::Obstacle(index),
            _ => Body::Robot(index),
        })
    }
}

/// The passages of all cells as states hold them: a list for each field, with two other fields of the ground truth between them.
pub(super) struct SavedPassages<'a> {
    pub(super) passages: &'a mut SparseCells<Passages>,
    pub(super) under: &'a mut Vec<Vec<(u32, bool)>>,
    pub(super) armed: &'a mut [bool],
}

impl SavedPassages<'_> {
    fn list<T>(&self, field: impl Fn(&Passages) -> T) -> Vec<T> {
        self.passages.iter().map(field).collect()
    }
}

impl Value for SavedPassages<'_> {
    fn write(&self, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
        runs(&mut self.list(|passages| passages.overlapped)).write(bytes)?;
        runs(&mut self.list(|passages| passages.covered)).write(bytes)?;
        value(&mut self.under.clone()).write(bytes)?;
        runs(&mut self.armed.to_vec()).write(bytes)?;
        runs(&mut self.list(|passages| passages.block_events)).write(bytes)?;
        runs(&mut self.list(|passages| passages.pass_events)).write(bytes)?;
        runs(&mut self.list(|passages| passages.mover.body())).write(bytes)
    }

    fn read(&mut self, bytes: &mut &[u8]) -> Result<(), ValueError> {
        let cells = self.passages.len();
        let (mut overlapped, mut covered) = (vec![0; cells], vec![0; cells]);
        let (mut block_events, mut pass_events, mut movers) =
            (vec![0; cells], vec![0; cells], vec![None; cells]);
        runs(&mut overlapped).read(bytes)?;
        runs(&mut covered).read(bytes)?;
        value(self.under).read(bytes)?;
        runs(self.armed).read(bytes)?;
        runs(&mut block_events).read(bytes)?;
        runs(&mut pass_events).read(bytes)?;
        runs(&mut movers).read(bytes)?;
        for index in 0..cells {
            let passages = Passages {
                overlapped: overlapped[index],
                covered: covered[index],
                block_events: block_events[index],
                pass_events: pass_events[index],
                mover: movers[index].map_or(Mover::default(), Mover::of),
            };
            self.passages.set(index, passages);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mover_is_its_body() {
        assert_eq!(Mover::default().body(), None);
        for body in
            [Body::Wall(0), Body::Obstacle(0), Body::Robot(0), Body::Obstacle(7), Body::Robot(1 << 20)]
        {
            assert_eq!(Mover::of(body).body(), Some(body));
        }
        assert_eq!(size_of::<Passages>(), 16);
    }
}
