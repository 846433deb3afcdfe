//! What a map says of other times: P(blocked), doors, for how long a look counts.

use interfaces::{Cell, CellState, Grid};
use mapper::{Calendar, Clock, Door, Mapper, Segment, ThingKind};
use nalgebra::{Point2, Vector2};

/// Cells whose centers are at most this far from the closed leaf of a door are blocked by it, in cells.
const LEAF: f64 = 2.0;

/// A map, and how its times relate to local civil time. Times are those of the calendar, s.
#[derive(Clone, Copy, Debug)]
pub struct Outlook<'a> {
    /// The map.
    pub mapper: &'a Mapper,
    /// How its times relate to local civil time.
    pub calendar: &'a Calendar,
}

impl<'a> Outlook<'a> {
    /// The map of a robot that lives now.
    pub fn live(mapper: &'a Mapper) -> Self {
        Self { mapper, calendar: mapper.calendar() }
    }

    /// The time of the last reading, s.
    pub fn now_s(&self) -> f64 {
        self.mapper.epoch_s() + self.mapper.time()
    }

    /// The probability that a cell is blocked at a time, s; `None` for a cell that was never seen, and outside of the map. A time
    /// before the last reading counts as that of the last reading.
    pub fn blocked(&self, cell: Cell, time_s: f64) -> Option<f64> {
        let index = self.mapper.frame().index(cell)?;
        let is_known = self.mapper.states().cells()[index] != CellState::Unknown;
        let ahead_s = (time_s - self.now_s()).max(0.0);
        is_known.then(|| self.mapper.blocked_probability_later(index, ahead_s))
    }

    /// For how long a look at a cell says more than the usual hours, s; NaN where nothing ever changed, and `longer_s` where it is longer
    /// than four weeks.
    pub fn expiry(&self, longer_s: f64) -> Grid<f64> {
        self.by_tile(f64::NAN, |clock| clock.expiry_s(self.calendar).unwrap_or(longer_s))
    }

    /// For how long a look at a cell is worth something, s: as [`expiry`](Self::expiry) where there is a clock, of the tile or of the
    /// door; elsewhere, the half-life of the memory of the two-state chain, which is the same for a chain. NaN where nothing ever
    /// changed, infinite where it is longer than four weeks.
    pub fn worth(&self) -> Grid<f64> {
        let mut grid = self.expiry(f64::INFINITY);
        for index in self.mapper.changed() {
            if let (true, Some((block, free))) =
                (grid.cells()[index].is_nan(), self.mapper.transition_rates(index))
            {
                grid.cells_mut()[index] = std::f64::consts::LN_2 / (block + free).max(f64::MIN_POSITIVE);
            }
        }
        for thing in self.mapper.things() {
            let ThingKind::Door(door) = &thing.kind else { continue };
            let expiry_s = door.clock.expiry_s(self.calendar).unwrap_or(f64::INFINITY);
            for cell in &thing.cells {
                grid.cells_mut()[*cell as usize] = expiry_s;
            }
        }
        grid
    }

    /// A value of each cell that ever changed, by the clock of its tile; of other cells, `other`.
    pub(crate) fn by_tile(&self, other: f64, value: impl Fn(&Clock) -> f64) -> Grid<f64> {
        let mut grid = Grid::filled(*self.mapper.frame(), other);
        let changed: Vec<usize> = self.mapper.changed().collect();
        for tile in self.mapper.tiles() {
            let value = value(tile.clock());
            tile.changed().for_each(|cell| grid.cells_mut()[changed[cell]] = value);
        }
        grid
    }

    /// The probability that a body with this radius, m, is stopped on its straight way between two points, m: that of the cell on
    /// its way that is most probably blocked, if it is there at this time, s. Doors are blocked when they are closed, as their own
    /// clocks say. `None` if no cell of the way was ever seen.
    pub fn stopped(
        &self,
        [from, to]: [Point2<f64>; 2],
        radius_m: f64,
        time_s: impl Fn(f64) -> f64,
    ) -> Option<f64> {
        let (frame, way) = (self.mapper.frame(), to - from);
        let (cell_m, length_m) = (frame.resolution_m(), way.norm());
        let (steps, reach) = ((length_m / cell_m).ceil().max(1.0), (radius_m / cell_m).round() as i32);
        let doors: Vec<&Door> =
            doors(self.mapper).map(|(_, door)| door).filter(|door| door.is_open.is_some()).collect();
        let mut largest: Option<f64> = None;
        for step in 0..=steps as usize {
            let share = step as f64 / steps;
            let (at, time_s) = (from + way * share, time_s(share * length_m));
            for offset in (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| Vector2::new(x, y))) {
                if offset.dot(&offset) <= reach * reach {
                    let Cell { x, y } = frame.cell_at(&at);
                    let cell = Cell::new(x + offset.x, y + offset.y);
                    let is_leaf =
                        |door: &&&Door| distance_m(&door.closed, frame.center(cell)) <= LEAF * cell_m;
                    let found = match doors.iter().find(is_leaf) {
                        Some(door) => Some(1.0 - door.clock.probability(time_s, self.calendar)),
                        None => self.blocked(cell, time_s),
                    };
                    largest = largest.into_iter().chain(found).reduce(f64::max);
                }
            }
        }
        largest
    }
}

/// The doors of a map, with their numbers.
pub fn doors(mapper: &Mapper) -> impl Iterator<Item = (u32, &Door)> {
    mapper.things().iter().filter_map(|thing| match &thing.kind {
        ThingKind::Door(door) => Some((thing.id, &**door)),
        ThingKind::Furniture(_) => None,
    })
}

/// The distance of a point from a segment, m.
pub(crate) fn distance_m(segment: &Segment, point: Point2<f64>) -> f64 {
    let [from, to] = segment.ends;
    let along = to - from;
    let share = (along.dot(&(point - from)) / along.norm_squared()).clamp(0.0, 1.0);
    (point - from - along * share).norm()
}
