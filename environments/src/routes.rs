//! What the way to a goal promises: the view from the whole route, and not from its end alone.

use crate::explorer::MOVE_M;
use crate::task::Part;
use interfaces::{Cell, CellState};
use mapper::Mapper;
use nalgebra::{Point2, Vector2};
use std::f64::consts::TAU;

/// The features of a route, each from 0 to 1.
pub(crate) const FEATURES: [(&str, usize); 7] = [
    // The travel time to the reachable cell nearest to the goal, a share of a minute; 1 if nothing is reachable.
    ("travel", 1),
    // The distance d from that cell to the goal: d / (d + 1 m).
    ("gap", 1),
    // The unknown area that may come into view on the way: u / (u + 5 m²).
    ("unseen", 1),
    // The known area in view from the way that is stale, a change of which would count as found: a / (a + 20 m²).
    ("stale", 1),
    // How long ago the stale area was seen, the mean of 1 − e^(−time / 60 s).
    ("age", 1),
    // The expected changes among stale cells that changed before: n / (n + 20).
    ("expected_changes", 1),
    // The number of these cells: n / (n + 50).
    ("changing", 1),
];
/// The features of one route.
pub(crate) type Route = [f32; FEATURES.len()];

/// The distance between two places on a route from which the robot looks, m.
const LOOK_M: f64 = 1.0;
/// The rays from a place, their greatest length and their steps, m.
const RAYS: usize = 48;
const RAY_M: f64 = 6.0;
const STEP_M: f64 = 0.1;
/// How far a ray goes on in unknown space, m: behind that, walls may be.
const UNKNOWN_M: f64 = 1.5;
/// The side of the squares that are counted once, in cells.
const TILE: i32 = 4;
/// A change counts as found in a cell that was out of view for longer than the `max_gap` of the mapper of a laser, s.
const GAP_S: f64 = 8.0;

/// The part of the observation.
pub(crate) fn part(goals: usize) -> Part {
    Part { slices: FEATURES.to_vec(), ..Part::new("routes", vec![goals, FEATURES.len()]) }
}

/// The map, the travel times to its cells, and from where its cells were last seen.
pub(crate) struct Routes<'a, F> {
    mapper: &'a Mapper,
    times: &'a [f64],
    seen_from: F,
    /// The cells that ever changed and are stale: tile, expected changes, and from where each was last seen.
    changing: Vec<(usize, f64, Point2<f64>)>,
    tiles_wide: usize,
    /// Per tile the route that has it in view, counted from 1, and the place on the route that saw it first.
    views: Vec<(u32, u32)>,
    count: u32,
}

impl<'a, F: Fn(usize) -> Point2<f64>> Routes<'a, F> {
    pub(crate) fn new(mapper: &'a Mapper, times: &'a [f64], seen_from: F) -> Self {
        let frame = mapper.frame();
        let [wide, high] = [frame.width(), frame.height()].map(|cells| cells.div_ceil(TILE as usize));
        let views = vec![(0, 0); wide * high];
        let mut routes =
            Self { mapper, times, seen_from, changing: Vec::new(), tiles_wide: wide, views, count: 0 };
        let stale = mapper.changed().filter(|&index| mapper.recency(index) >= GAP_S);
        routes.changing = stale
            .map(|index| {
                let tile = routes.tile(frame.cell(index));
                (tile, mapper.change_probability(index), (routes.seen_from)(index))
            })
            .collect();
        routes
    }

    fn tile(&self, cell: Cell) -> usize {
        (cell.y / TILE) as usize * self.tiles_wide + (cell.x / TILE) as usize
    }

    /// The route to a goal.
    pub(crate) fn to(&mut self, goal: Cell) -> Route {
        let Some(end) = self.nearest_reachable(goal) else { return [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0] };
        let frame = self.mapper.frame();
        let gap_m = nalgebra::distance(&frame.center(goal), &frame.center(frame.cell(end)));
        let places = self.places(end);
        self.count += 1;
        let mut seen = Seen::default();
        for number in 0..places.len() {
            for ray in 0..RAYS {
                self.cast(&places, number, TAU * ray as f64 / RAYS as f64, &mut seen);
            }
        }
        let (mut expected, mut changing) = (0.0, 0.0);
        for &(tile, probability, from) in &self.changing {
            let (route, place) = self.views[tile];
            if route == self.count && nalgebra::distance(&from, &places[place as usize]) >= MOVE_M {
                expected += probability;
                changing += 1.0;
            }
        }
        let share = |value: f64, half: f64| value / (value + half);
        [
            self.times[end] / 60.0,
            share(gap_m, 1.0),
            share(seen.unknown_m2, 5.0),
            share(seen.stale_m2, 20.0),
            seen.age / seen.stale_m2.max(1e-9),
            share(expected, 20.0),
            share(changing, 50.0),
        ]
        .map(|value| value.clamp(0.0, 1.0) as f32)
    }

    /// The index of the reachable cell nearest to a goal: the controller drives there.
    fn nearest_reachable(&self, goal: Cell) -> Option<usize> {
        let frame = self.mapper.frame();
        if let Some(index) = frame.index(goal).filter(|&index| self.times[index].is_finite()) {
            return Some(index);
        }
        let squared = |index: usize| {
            let cell = frame.cell(index);
            (cell.x - goal.x).pow(2) + (cell.y - goal.y).pow(2)
        };
        (0..self.times.len())
            .filter(|&index| self.times[index].is_finite())
            .min_by_key(|&index| squared(index))
    }

    /// Places on the route, from the robot to the end: down the travel times from the end.
    fn places(&self, end: usize) -> Vec<Point2<f64>> {
        let frame = self.mapper.frame();
        let mut places = vec![frame.center(frame.cell(end))];
        let mut at = end;
        let time = |index: usize| self.times[index];
        while time(at) > 0.0 {
            let cell = frame.cell(at);
            let around = (-1..=1).flat_map(|row| (-1..=1).map(move |column| (row, column)));
            let next = around
                .filter_map(|(row, column)| frame.index(Cell { x: cell.x + column, y: cell.y + row }))
                .min_by(|a, b| time(*a).total_cmp(&time(*b)));
            match next {
                Some(next) if time(next) < time(at) => at = next,
                _ => break,
            }
            let place = frame.center(frame.cell(at));
            if places.last().is_some_and(|last| nalgebra::distance(last, &place) >= LOOK_M) {
                places.push(place);
            }
        }
        places.reverse();
        places
    }

    /// Notes what a ray from a place of the route meets.
    fn cast(&mut self, places: &[Point2<f64>], number: usize, angle_rad: f64, seen: &mut Seen) {
        let (frame, (sin, cos)) = (self.mapper.frame(), libm::sincos(angle_rad));
        let from = &places[number];
        let tile_m2 = (f64::from(TILE) * frame.resolution_m()).powi(2);
        let mut unknown_m = 0.0;
        for step in 0..(RAY_M / STEP_M) as usize {
            let along_m = (step as f64 + 0.5) * STEP_M;
            let cell = frame.cell_at(&(from + Vector2::new(cos, sin) * along_m));
            let Some(index) = frame.index(cell) else { return };
            let state = self.mapper.states().cells()[index];
            let tile = self.tile(cell);
            let is_new = self.views[tile].0 != self.count;
            if is_new {
                self.views[tile] = (self.count, number as u32);
            }
            if state == CellState::Unknown {
                unknown_m += STEP_M;
                if unknown_m > UNKNOWN_M {
                    return;
                }
                seen.unknown_m2 += if is_new { tile_m2 } else { 0.0 };
                continue;
            }
            let age_s = if is_new { self.mapper.recency(index) } else { 0.0 };
            if age_s >= GAP_S && nalgebra::distance(&(self.seen_from)(index), from) >= MOVE_M {
                seen.stale_m2 += tile_m2;
                seen.age += tile_m2 * (1.0 - libm::exp(-age_s / 60.0));
            }
            if state == CellState::Blocked && along_m > 0.3 {
                return;
            }
        }
    }
}

/// Sums over the squares in view from a route.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    unknown_m2: f64,
    stale_m2: f64,
    /// The sum of 1 − e^(−time / 60 s) over the stale area, m².
    age: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Grid, GridFrame};
    use mapper::MapperSettings;

    /// Two rooms, a door between them, and unknown space behind the right one; the lowest row is the last one. A sign is a square of
    /// 0.5 m, which is counted once.
    const MAP: [&str; 5] = ["###########", "#...#....??", "#........??", "#...#....??", "###########"];
    /// The side of a cell, m.
    const CELL_M: f64 = 0.125;
    /// The columns and rows of the map, and the row of the robot.
    const SIZE: [usize; 2] = [44, 20];
    const ROW: usize = 10;

    fn map() -> Mapper {
        let frame = GridFrame::new(Point2::origin(), CELL_M, SIZE[0], SIZE[1]).unwrap();
        let state = |cell: char| match cell {
            '.' => CellState::Free,
            '#' => CellState::Blocked,
            _ => CellState::Unknown,
        };
        let side = TILE as usize;
        let sign = |index: usize| MAP[4 - index / SIZE[0] / side].as_bytes()[index % SIZE[0] / side] as char;
        let cells = (0..SIZE[0] * SIZE[1]).map(|index| state(sign(index))).collect();
        Mapper::with_prior(&MapperSettings::default(), Grid::from_cells(frame, cells).unwrap()).unwrap()
    }

    /// Travel times along the row of the robot, which is in column 4, in steps of 0.25 s; nothing else is reachable.
    fn times() -> Vec<f64> {
        let mut times = vec![f64::INFINITY; SIZE[0] * SIZE[1]];
        (4..36).for_each(|column| times[ROW * SIZE[0] + column] = 0.25 * (column as f64 - 4.0));
        times
    }

    fn route(goal: Cell) -> Route {
        let (mapper, times) = (map(), times());
        Routes::new(&mapper, &times, |_| Point2::new(-10.0, 0.0)).to(goal)
    }

    #[test]
    fn a_goal_without_a_path_has_the_time_to_the_nearest_reachable_cell() {
        let (here, above) = (route(Cell { x: 28, y: 10 }), route(Cell { x: 28, y: 14 }));
        assert_eq!((here[0], here[1]), (6.0 / 60.0, 0.0));
        // 0.5 m above: d / (d + 1 m).
        assert_eq!((above[0], above[1]), (6.0 / 60.0, 1.0 / 3.0));
        assert_eq!(above[2..], here[2..]);
    }

    #[test]
    fn places_go_from_the_robot_to_the_end() {
        let (mapper, times) = (map(), times());
        let routes = Routes::new(&mapper, &times, |_| Point2::origin());
        let columns: Vec<f64> =
            routes.places(ROW * SIZE[0] + 28).iter().map(|place| place.x / CELL_M - 0.5).collect();
        assert_eq!(columns, [4.0, 12.0, 20.0, 28.0]);
    }

    #[test]
    fn unknown_squares_in_view_from_several_places_count_once() {
        let far = route(Cell { x: 34, y: 10 });
        // Six squares of 0.25 m²: u / (u + 5 m²).
        assert_eq!(far[2], (1.5 / 6.5) as f32);
    }

    #[test]
    fn nothing_is_promised_where_nothing_is_reachable() {
        let (mapper, times) = (map(), vec![f64::INFINITY; SIZE[0] * SIZE[1]]);
        let mut routes = Routes::new(&mapper, &times, |_| Point2::origin());
        assert_eq!(routes.to(Cell { x: 2, y: 2 }), [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    }
}
