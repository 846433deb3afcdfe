//! Where something changes: square tiles of half a meter, each with a [`Clock`].
//!
//! A tile is blocked while a cell of it that ever changed is blocked: somebody stands there, a door is closed. Its clock predicts
//! that for hours and days ahead; each of its cells keeps how often it was blocked while the tile was.

mod predicted;

pub(crate) use predicted::HALF_HOURS;

use crate::change::{CellMap, Slot};
use crate::clock::Dates;
use crate::look_counts::LookCounts;
use crate::{Calendar, Clock, Growth, Look, MapperSettings};
use interfaces::{Cell, CellState, Value, value};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The side of a tile, m.
const SIDE_M: f64 = 0.5;
/// Every tile in view is looked at once in this time, s: a clock counts the looks of its half hours, and with looks at every
/// change a tile through which people pass would seem blocked for too much of the time.
const SPACING_S: f64 = 5.0;
/// The farthest corner, in cells: that of the largest map that has grown.
const MAX_CORNER: u32 = 1 << 28;
/// A look needs this share of the cells of a tile in view.
const MIN_SEEN: f64 = 0.5;

/// A square of half a meter in which a cell ever changed.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Tile {
    clock: Clock,
    /// The cells that ever changed.
    cells: Vec<Slot>,
    last: Option<Look>,
    /// The looks at all of these cells.
    counts: LookCounts,
}

impl Tile {
    /// When a cell of the tile is blocked: somebody stands there, a door is closed.
    pub fn clock(&self) -> &Clock {
        &self.clock
    }

    /// Its cells that ever changed, as positions in [`Mapper::changed`](crate::Mapper::changed).
    pub fn changed(&self) -> impl Iterator<Item = usize> {
        self.cells.iter().map(|slot| *slot as usize)
    }

    /// The last look, with the time of the mapper; `None` before the first one.
    pub fn last(&self) -> Option<Look> {
        self.last
    }

    /// The state that the cells in view show; `None` if they do not tell.
    fn state(&self, cells: &CellMap) -> Option<bool> {
        let (mut seen, mut is_blocked, mut is_hidden) = (0, false, false);
        for index in self.cells.iter().map(|slot| cells.changed[*slot as usize] as usize) {
            let is = cells.state(index) == CellState::Blocked;
            if cells.is_seen_now(index) {
                (seen, is_blocked) = (seen + 1, is_blocked | is);
            } else {
                is_hidden |= is;
            }
        }
        let is_seen = f64::from(seen) >= MIN_SEEN * self.cells.len() as f64;
        (is_seen && (is_blocked || !is_hidden)).then_some(is_blocked)
    }
}

/// A cell that ever changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
struct TileCell {
    tile: u32,
    counts: LookCounts,
}

/// What readings change.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
struct Learned {
    /// Copies share the tiles until one of them changes one.
    #[serde(with = "shared")]
    tiles: Vec<Arc<Tile>>,
    /// The number of the tile at each place, in tiles from the corner of the first map.
    places: BTreeMap<(i32, i32), u32>,
    corner: (i32, i32),
    /// In the order of [`CellMap::changed`].
    cells: Vec<TileCell>,
    /// The tile that is looked at next, and the part of it that is due.
    next: usize,
    due: f64,
    time: f64,
}

/// All tiles of a map; none without [`MapperSettings::clocks`].
#[derive(Clone, Debug)]
pub(crate) struct Tiles {
    is_on: bool,
    /// The cells along the side of a tile.
    side: i32,
    zone: Calendar,
    pub(crate) epoch_s: f64,
    pub(crate) is_dated: bool,
    learned: Learned,
}

impl Tiles {
    pub(crate) fn new(settings: &MapperSettings, resolution_m: f64) -> Self {
        let side = (SIDE_M / resolution_m).round().clamp(1.0, 1000.0) as i32;
        let zone = settings.calendar().unwrap_or_default();
        let learned = Learned::default();
        Self { is_on: settings.clocks, side, zone, epoch_s: 0.0, is_dated: true, learned }
    }

    pub(crate) fn set_epoch(&mut self, epoch_s: f64, is_dated: bool) {
        (self.epoch_s, self.is_dated) = (epoch_s, is_dated);
    }

    pub(crate) fn calendar(&self) -> &Calendar {
        if self.is_dated { &self.zone } else { &Calendar::Relative }
    }

    pub(crate) fn dates(&self) -> Dates<'_> {
        Dates { calendar: self.calendar(), epoch_s: self.epoch_s }
    }

    /// Whether all tiles and cells to which values refer exist.
    pub(crate) fn is_sound(&self, cells: &CellMap) -> bool {
        let Learned { tiles, places, corner, cells: own, next, .. } = &self.learned;
        let is_cell = |slot: &Slot| (*slot as usize) < own.len();
        own.len() <= cells.changed.len()
            && own.iter().all(|cell| (cell.tile as usize) < tiles.len())
            && places.values().all(|tile| (*tile as usize) < tiles.len())
            && tiles.iter().all(|tile| tile.cells.iter().all(is_cell))
            && *next <= tiles.len()
            && [corner.0, corner.1].iter().all(|at| at.unsigned_abs() <= MAX_CORNER)
    }

    /// Looks at some of the tiles, each in turn.
    pub(crate) fn note(&mut self, cells: &CellMap) {
        if !self.is_on {
            return;
        }
        for slot in self.learned.cells.len()..cells.changed.len() {
            self.add(slot, cells);
        }
        let (learned, now) = (&mut self.learned, cells.time());
        let count = learned.tiles.len();
        let due = learned.due + count as f64 * (now - learned.time) / SPACING_S;
        (learned.due, learned.time) = (due.min(count as f64), now);
        while self.learned.due >= 1.0 {
            self.learned.due -= 1.0;
            self.learned.next = (self.learned.next + 1) % count;
            self.look(self.learned.next, cells);
        }
    }

    /// Adds a cell that changed for the first time to its tile.
    fn add(&mut self, slot: usize, cells: &CellMap) {
        let place = self.place(cells.frame().cell(cells.changed[slot] as usize));
        let Learned { tiles, places, cells, .. } = &mut self.learned;
        let tile = *places.entry(place).or_insert(tiles.len() as u32);
        if tile as usize == tiles.len() {
            tiles.push(Arc::default());
        }
        Arc::make_mut(&mut tiles[tile as usize]).cells.push(slot as Slot);
        cells.push(TileCell { tile, ..TileCell::default() });
    }

    fn look(&mut self, number: usize, cells: &CellMap) {
        let (time_s, calendar) = (cells.time(), self.calendar().clone());
        let learned = &mut self.learned;
        let Some(is_blocked) = learned.tiles[number].state(cells) else { return };
        let tile = Arc::make_mut(&mut learned.tiles[number]);
        tile.last = Some(Look { time_s, is_blocked });
        tile.clock.observe(Look { time_s: self.epoch_s + time_s, is_blocked }, &calendar);
        for slot in tile.cells.iter().map(|slot| *slot as usize).filter(|_| is_blocked) {
            let index = cells.changed[slot] as usize;
            if cells.is_seen_now(index) {
                let is_blocked = cells.state(index) == CellState::Blocked;
                learned.cells[slot].counts.add(is_blocked);
                tile.counts.add(is_blocked);
            }
        }
    }

    fn place(&self, cell: Cell) -> (i32, i32) {
        let (x, y) = self.learned.corner;
        ((cell.x - x).div_euclid(self.side), (cell.y - y).div_euclid(self.side))
    }

    fn number(&self, cell: Cell) -> Option<u32> {
        self.learned.places.get(&self.place(cell)).copied()
    }

    /// The tile at a cell.
    pub(crate) fn at(&self, cell: Cell) -> Option<&Tile> {
        Some(&self.learned.tiles[self.number(cell)? as usize])
    }

    /// All tiles, in the order of their first change.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Tile> {
        self.learned.tiles.iter().map(|tile| &**tile)
    }

    /// Moves all tiles into a larger map.
    pub(crate) fn grow(&mut self, growth: &Growth) {
        let Cell { x, y } = growth.frame().cell(growth.index(0));
        let corner = &mut self.learned.corner;
        *corner = (corner.0 + x, corner.1 + y);
    }

    /// The tiles as a value of a snapshot.
    pub(crate) fn value(&mut self) -> Box<dyn Value + '_> {
        value(&mut self.learned)
    }
}

/// A list of shared items.
mod shared {
    use super::{Arc, Tile};
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(tiles: &[Arc<Tile>], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(tiles.iter().map(|tile| &**tile))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Vec<Arc<Tile>>, D::Error> {
        Ok(Vec::<Tile>::deserialize(deserializer)?.into_iter().map(Arc::new).collect())
    }
}
