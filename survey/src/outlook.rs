//! What a map says of other times: P(blocked), doors, for how long a look counts.

use crate::masks::{PERMANENT, share_blocked};
use interfaces::{Cell, CellState, Grid, GridFrame};
use mapper::{Calendar, Clock, Mapper, Waiting};
use nalgebra::{Point2, Vector2};

/// Cells whose centers are at most this far from the closed leaf of a door are blocked by it, in cells.
const LEAF: f64 = 2.0;
/// Cells that are no part of a door are the same obstacle if they are at most this far apart, m.
const SAME_M: f64 = 1.0;

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
        for door in self.mapper.doors() {
            let expiry_s = door.clock.expiry_s(self.calendar).unwrap_or(f64::INFINITY);
            for cell in &door.cells {
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

    /// What can stop a body with this radius, m, on its straight way between two points, m, in the order in which the body comes to it:
    /// the probability that it does is that of the cell on its way that is most probably blocked, if it is there at this time, s. `None`
    /// if no cell of the way was ever seen.
    pub fn stops(
        &self,
        [from, to]: [Point2<f64>; 2],
        radius_m: f64,
        time_s: impl Fn(f64) -> f64,
    ) -> Option<Vec<Stop>> {
        let (frame, way) = (self.mapper.frame(), to - from);
        let (cell_m, length_m) = (frame.resolution_m(), way.norm());
        let (steps, reach) = ((length_m / cell_m).ceil().max(1.0), (radius_m / cell_m).round() as i32);
        let mut found: Option<Vec<Stop>> = None;
        let margin_m = (f64::from(reach) + LEAF + 1.0) * cell_m;
        let [first, last] = part_near(frame, margin_m, from, way)?;
        let mut before: Option<Cell> = None;
        for step in (first * steps).floor() as usize..=(last * steps).ceil() as usize {
            let way_m = step as f64 / steps * length_m;
            let (at, time_s) = (from + way * (step as f64 / steps), time_s(way_m));
            let center = frame.cell_at(&at);
            let is_new = |cell: &Cell| before.is_none_or(|before| !before.is_within(*cell, reach));
            for cell in center.disc(reach).filter(is_new) {
                let Some((obstacle, blocked)) = self.obstacle(cell, time_s) else { continue };
                let stops = found.get_or_insert_default();
                // The body leaves a cell at most its diameter later.
                let ways_m = [way_m, (way_m + 2.0 * radius_m).min(length_m)];
                let stop = Stop { obstacle, at: frame.center(cell), blocked, ways_m, time_s };
                match stops.iter_mut().rev().find(|known| known.continues(&stop)) {
                    _ if blocked <= 0.0 => {}
                    Some(known) => known.join(stop),
                    None => stops.push(stop),
                }
            }
            before = Some(center);
        }
        found
    }

    /// What can block a cell, and the probability that it does at a time, s; `None` for a cell that was never seen. Doors are blocked when
    /// they are closed, as their own clocks say.
    pub fn obstacle(&self, cell: Cell, time_s: f64) -> Option<(Obstacle, f64)> {
        let frame = self.mapper.frame();
        let (center, leaf_m) = (frame.center(cell), LEAF * frame.resolution_m());
        if let Some(door) = self.mapper.doors().iter().find(|door| door.closed.distance_m(&center) <= leaf_m)
        {
            return Some((Obstacle::Door(door.id), 1.0 - door.clock.probability(time_s, self.calendar)));
        }
        let (index, blocked) = (frame.index(cell)?, self.blocked(cell, time_s)?);
        let is_wall = self.mapper.map_changes(index) == 0 || share_blocked(self.mapper, index) >= PERMANENT;
        Some((if is_wall { Obstacle::Wall } else { Obstacle::Cells }, blocked))
    }

    /// How long an obstacle still blocks the way, if it does when the body comes to it; `None` for a wall, and where nothing is known of
    /// that. A door is one that opens and closes alike at all hours.
    pub fn waiting(&self, stop: &Stop) -> Option<Waiting> {
        if let Obstacle::Door(id) = stop.obstacle {
            let door = self.mapper.doors().iter().find(|door| door.id == id)?;
            return Some(door.waiting(stop.time_s - self.mapper.epoch_s()));
        }
        let index = self.mapper.frame().index(self.mapper.frame().cell_at(&stop.at));
        let index = index.filter(|_| stop.obstacle == Obstacle::Cells)?;
        self.mapper.waiting(index, (stop.time_s - self.now_s()).max(0.0))
    }
}

/// What can stop a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// What never changed, or is there nearly all the time.
    Wall,
    /// The door with this number.
    Door(u32),
    /// Other cells that change: an object that comes and goes, or people.
    Cells,
}

/// An obstacle on a way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// What it is.
    pub obstacle: Obstacle,
    /// The center of its cell on the way that is most probably blocked, m.
    pub at: Point2<f64>,
    /// The probability that this cell is blocked when the body comes to it.
    pub blocked: f64,
    /// The distances along the way at which the body meets the obstacle first and last, m.
    pub ways_m: [f64; 2],
    /// The time at which the body comes to the cell, s.
    pub time_s: f64,
}

impl Stop {
    /// Whether both are the same obstacle.
    pub fn is_same(&self, other: &Self) -> bool {
        let is_near = (self.at - other.at).norm() <= SAME_M;
        self.obstacle == other.obstacle && (is_near || matches!(self.obstacle, Obstacle::Door(_)))
    }

    /// Whether another one, farther along the way, is the same obstacle, which the way has not left in between.
    pub fn continues(&self, later: &Self) -> bool {
        later.ways_m[0] <= self.ways_m[1] + SAME_M && self.is_same(later)
    }

    /// Adds what is known of the same obstacle farther along the way.
    pub fn join(&mut self, later: Self) {
        let ways_m = [self.ways_m[0], self.ways_m[1].max(later.ways_m[1])];
        *self = Self { ways_m, ..if later.blocked > self.blocked { later } else { *self } };
    }
}

/// The part of a way that is at most a margin (m) away from a map, as shares of the way at its begin and its end; `None` if there is none.
/// The rest of a way can be very long.
fn part_near(frame: &GridFrame, margin_m: f64, from: Point2<f64>, way: Vector2<f64>) -> Option<[f64; 2]> {
    let size_m = Vector2::new(frame.width() as f64, frame.height() as f64) * frame.resolution_m();
    let low = frame.origin() - Vector2::repeat(margin_m);
    let high = frame.origin() + size_m + Vector2::repeat(margin_m);
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let reached = |side: f64| (side - from[axis]) / way[axis];
        if way[axis] != 0.0 {
            let [one, other] = [reached(low[axis]), reached(high[axis])];
            (first, last) = (first.max(one.min(other)), last.min(one.max(other)));
        } else if !(low[axis]..=high[axis]).contains(&from[axis]) {
            return None;
        }
    }
    (first <= last).then_some([first, last])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::watched;
    use std::cell::RefCell;

    /// A map of 5 × 2 m from (1, 2) on, in cells of 0.1 m: one cell is blocked.
    fn map(blocked: Cell) -> Mapper {
        let frame = GridFrame::new(Point2::new(1.0, 2.0), 0.1, 50, 20).unwrap();
        watched(frame, 9, |cell, _| cell == blocked)
    }

    /// Only the part of a way near the map is looked at, whatever the length of the way, at the times of the whole way.
    #[test]
    fn a_way_from_far_away_is_that_through_the_map() {
        let mapper = map(Cell::new(25, 10));
        let outlook = Outlook::live(&mapper);
        let at = |y_m: f64, [from_m, to_m]: [f64; 2]| {
            let asked_m = RefCell::new(Vec::new());
            let time_s = |way_m: f64| {
                asked_m.borrow_mut().push(way_m);
                outlook.now_s()
            };
            let found = outlook.stops([Point2::new(from_m, y_m), Point2::new(to_m, y_m)], 0.2, time_s);
            let blocked = |found: Vec<Stop>| found.iter().fold(0.0, |most, stop| stop.blocked.max(most));
            (found.map(blocked), asked_m.into_inner())
        };
        for y_m in [2.45, 3.05, 3.3] {
            let (near, _) = at(y_m, [0.0, 7.0]);
            assert_eq!(near.is_some_and(|blocked| blocked > 0.9), y_m > 3.0, "{y_m}: {near:?}");
            for ends_m in [[-9.0e5, 9.9e5], [9.9e5, -9.0e5], [-1e9, 4.0]] {
                let (far, asked_m) = at(y_m, ends_m);
                assert_eq!(far, near, "{y_m}, {ends_m:?}");
                let inside_m =
                    [1.0, 6.0].map(|x_m: f64| (x_m.min(ends_m[1].max(ends_m[0])) - ends_m[0]).abs());
                let [low_m, high_m] = [inside_m[0].min(inside_m[1]), inside_m[0].max(inside_m[1])];
                assert!(asked_m.len() < 8000, "{}", asked_m.len());
                let near_m = low_m - 1.0..high_m + 1.0;
                assert!(asked_m.iter().all(|way_m| near_m.contains(way_m)), "{ends_m:?}");
            }
        }
        // Ways that never come near the map, and one that only comes as near as the radius.
        assert_eq!(at(900.0, [-5.0, 9.0]), (None, Vec::new()));
        assert_eq!(at(3.0, [7.0, 9.9e5]), (None, Vec::new()));
        assert!(at(1.85, [0.0, 7.0]).0.is_some());
    }
}
