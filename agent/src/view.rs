//! What the robot would see from where, by what the map says.
//!
//! A strategy that looks ahead asks this of every place that it might go to, so views are kept, and
//! cast anew only where a wall has come or gone since. A fine grid under a far sensor is judged by
//! squares of cells, since the view from one cell is that from the next.

use interfaces::{Cell, CellState, GridFrame};
use mapper::Mapper;

/// A view reaches at most this many places far: more would cost much and tell little.
const REACH_PLACES: f64 = 40.0;

/// The map cut into square places of `side` × `side` cells, from its lower left corner on; those at
/// the right and upper border can be smaller. Places are numbered in row-major order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Places {
    frame: GridFrame,
    side: usize,
    columns: usize,
    rows: usize,
}

impl Places {
    fn new(frame: GridFrame, radius_m: f64) -> Self {
        let reach_cells = radius_m / frame.resolution_m();
        // At least one, and at most the whole map; the cast of a number too large is the largest.
        let side = ((reach_cells / REACH_PLACES).ceil() as usize).clamp(1, frame.width().max(frame.height()));
        Self { frame, side, columns: frame.width().div_ceil(side), rows: frame.height().div_ceil(side) }
    }

    /// The number of places; at least one.
    pub(crate) fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// The place that holds a cell, both by their numbers in row-major order.
    #[inline]
    pub(crate) fn of(&self, index: usize) -> usize {
        let width = self.frame.width();
        index / width / self.side * self.columns + index % width / self.side
    }

    /// Whether each place is a cell.
    pub(crate) fn are_cells(&self) -> bool {
        self.side == 1
    }

    /// The place that holds a cell; `None` outside of the map.
    pub(crate) fn at_cell(&self, cell: Cell) -> Option<usize> {
        self.frame.index(cell).map(|index| self.of(index))
    }

    /// The cells of a place by their numbers, row by row.
    pub(crate) fn cells(&self, place: usize) -> impl Iterator<Item = usize> {
        let (width, side) = (self.frame.width(), self.side);
        let (left, bottom) = (place % self.columns * side, place / self.columns * side);
        let right = (left + side).min(width);
        let rows = bottom..(bottom + side).min(self.frame.height());
        rows.flat_map(move |row| row * width + left..row * width + right)
    }

    #[inline]
    fn at(&self, column: i32, row: i32) -> Option<usize> {
        let inside = (0..self.columns as i32).contains(&column) && (0..self.rows as i32).contains(&row);
        inside.then(|| row as usize * self.columns + column as usize)
    }
}

/// The view from every place, within the radius of the robot's sensor.
///
/// What hides is a cell that is blocked and never changed; one that changed is likely to change
/// again, and what is unknown is seen through, for hope.
#[derive(Clone, Debug)]
pub(crate) struct Outlook {
    radius_m: f64,
    places: Option<Places>,
    /// Which places hide what lies behind.
    opaque: Vec<bool>,
    /// The places in view from each; `None` until asked for.
    views: Vec<Option<Vec<u32>>>,
}

impl Outlook {
    /// A robot that sees as far as `radius_m`, m, and knows no map yet.
    pub(crate) fn new(radius_m: f64) -> Self {
        Self { radius_m, places: None, opaque: Vec::new(), views: Vec::new() }
    }

    /// Takes the map in, and gives the places it is cut into. To be called before the views are asked
    /// for; one pass over the map.
    pub(crate) fn follow(&mut self, mapper: &Mapper) -> Places {
        let places = Places::new(*mapper.frame(), self.radius_m);
        if self.places != Some(places) {
            self.places = Some(places);
            self.opaque = vec![false; places.count()];
            self.views = vec![None; places.count()];
        }
        let mut walls = vec![0u32; places.count()];
        for (index, state) in mapper.states().cells().iter().enumerate() {
            if *state == CellState::Blocked {
                walls[places.of(index)] += 1;
            }
        }
        for index in mapper.changed() {
            if mapper.states().cells()[index] == CellState::Blocked {
                walls[places.of(index)] -= 1;
            }
        }
        // As many cells as a straight wall of one cell has: a wall across the place.
        for (place, &walls) in walls.iter().enumerate() {
            let is_opaque = walls as usize >= places.side;
            if is_opaque != self.opaque[place] {
                self.opaque[place] = is_opaque;
                self.forget_around(&places, place);
            }
        }
        places
    }

    /// The places in view from a place by their numbers in order, itself included.
    pub(crate) fn seen_from(&mut self, place: usize) -> &[u32] {
        let Self { places: Some(places), opaque, views, .. } = self else { return &[] };
        let reach = self.radius_m / (places.frame.resolution_m() * places.side as f64);
        views[place].get_or_insert_with(|| cast(places, opaque, place, reach))
    }

    /// Forgets the views that a place lies in.
    fn forget_around(&mut self, places: &Places, place: usize) {
        let reach = self.reach_places(places);
        let (column, row) = (place % places.columns, place / places.columns);
        for row in row.saturating_sub(reach)..(row + reach + 1).min(places.rows) {
            let columns = column.saturating_sub(reach)..(column + reach + 1).min(places.columns);
            self.views[row * places.columns..][columns].fill(None);
        }
    }

    /// How far a view reaches, in whole places.
    fn reach_places(&self, places: &Places) -> usize {
        (self.radius_m / (places.frame.resolution_m() * places.side as f64)) as usize
    }
}

/// A slope as a fraction; the denominator is positive.
#[derive(Clone, Copy, Debug)]
struct Slope(i32, i32);

impl Slope {
    fn is_below(self, other: Self) -> bool {
        self.0 * other.1 < other.0 * self.1
    }
}

/// A row of a quadrant that is in view between two slopes, so far away from the origin.
#[derive(Clone, Copy, Debug)]
struct Row {
    depth: i32,
    start: Slope,
    end: Slope,
}

impl Row {
    /// The columns whose places lie in the row's view or stick out into it, and some more.
    fn columns(&self) -> std::ops::RangeInclusive<i32> {
        let first = (self.depth * self.start.0).div_euclid(self.start.1) - 1;
        let last = (self.depth * self.end.0).div_euclid(self.end.1) + 2;
        first.max(-self.depth)..=last.min(self.depth)
    }

    fn shows(&self, column: i32) -> bool {
        let middle = Slope(column, self.depth);
        !middle.is_below(self.start) && !self.end.is_below(middle)
    }

    /// The slopes between which a place of this row hides what lies behind.
    fn shadow(&self, column: i32) -> (Slope, Slope) {
        let (left, right, near, far) =
            (2 * column - 1, 2 * column + 1, 2 * self.depth - 1, 2 * self.depth + 1);
        (Slope(left, if left > 0 { far } else { near }), Slope(right, if right > 0 { near } else { far }))
    }
}

/// Shadow casting by rows: a place is in view unless the straight line between the centres passes
/// through the inside of an opaque one. Sight is mutual.
fn cast(places: &Places, opaque: &[bool], origin: usize, reach: f64) -> Vec<u32> {
    let (x, y) = ((origin % places.columns) as i32, (origin / places.columns) as i32);
    let mut seen = vec![origin as u32];
    let mut rows = Vec::new();
    for quadrant in 0..4 {
        let tile = |depth: i32, column: i32| match quadrant {
            0 => places.at(x + column, y + depth),
            1 => places.at(x + column, y - depth),
            2 => places.at(x + depth, y + column),
            _ => places.at(x - depth, y + column),
        };
        rows.push(Row { depth: 1, start: Slope(-1, 1), end: Slope(1, 1) });
        while let Some(mut row) = rows.pop() {
            let depth = row.depth;
            if f64::from(depth) > reach {
                continue;
            }
            // Within a quadrant no place hides the middle of another in its row.
            for column in row.columns() {
                let place = tile(depth, column);
                let is_near = f64::from(depth * depth + column * column) <= reach * reach;
                if let Some(place) = place.filter(|_| is_near && row.shows(column)) {
                    seen.push(place as u32);
                }
                let (start, end) = row.shadow(column);
                let is_hiding = row.start.is_below(end) && start.is_below(row.end);
                if is_hiding && place.is_none_or(|place| opaque[place]) {
                    if !start.is_below(row.start) {
                        rows.push(Row { depth: depth + 1, start: row.start, end: start });
                    }
                    row.start = end;
                }
            }
            if !row.end.is_below(row.start) {
                rows.push(Row { depth: depth + 1, ..row });
            }
        }
    }
    // Two quadrants share a diagonal.
    seen.sort_unstable();
    seen.dedup();
    seen
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::CellReading;
    use mapper::MapperSettings;
    use nalgebra::{Isometry2, Point2};
    use proptest::prelude::*;

    /// A map of cells of 1 m: `#` a wall, `.` free, a blank unknown; the top line has the highest y.
    fn map(rows: &[&str]) -> Mapper {
        let frame = GridFrame::new(Point2::origin(), 1.0, rows[0].len(), rows.len()).unwrap();
        let mut mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
        look(&mut mapper, 0.0, rows);
        mapper
    }

    fn look(mapper: &mut Mapper, time: f64, rows: &[&str]) {
        let cells = rows.iter().rev().zip(0..).flat_map(|(row, y)| {
            let known = row.chars().zip(0..).filter(|&(letter, _)| letter != ' ');
            known.map(move |(letter, x)| (Cell::new(x, y), letter == '#'))
        });
        let cells = cells.collect();
        mapper.update(&CellReading { time, pose: Isometry2::identity(), cells }).unwrap();
    }

    /// What is seen from a cell: `o` in view, `-` not.
    fn drawn(outlook: &mut Outlook, mapper: &Mapper, from: Cell) -> Vec<String> {
        let places = outlook.follow(mapper);
        let frame = mapper.frame();
        let seen = outlook.seen_from(places.of(frame.index(from).unwrap())).to_vec();
        let letter = |index: usize| if seen.contains(&(places.of(index) as u32)) { 'o' } else { '-' };
        let row = |y: usize| (0..frame.width()).map(|x| letter(y * frame.width() + x)).collect();
        (0..frame.height()).rev().map(row).collect()
    }

    #[test]
    fn walls_are_seen_and_hide_what_is_behind() {
        let rows = [
            "...#...", //
            "...#...", ".......", "...#...",
        ];
        assert_eq!(
            drawn(&mut Outlook::new(9.0), &map(&rows), Cell::new(1, 1)),
            [
                "oooo---", //
                "oooo--o", "ooooooo", "oooo--o",
            ]
        );
    }

    #[test]
    fn the_radius_is_round_and_the_unknown_is_seen_through() {
        let rows = ["     ", "     ", "  .  ", "     ", "     "];
        assert_eq!(
            drawn(&mut Outlook::new(2.0), &map(&rows), Cell::new(2, 2)),
            ["--o--", "-ooo-", "ooooo", "-ooo-", "--o--"]
        );
    }

    #[test]
    fn what_moves_does_not_hide_and_walls_found_later_do() {
        let mut mapper = map(&["....."]);
        let mut outlook = Outlook::new(9.0);
        assert_eq!(drawn(&mut outlook, &mapper, Cell::new(0, 0)), ["ooooo"]);
        look(&mut mapper, 1.0, &["..#.."]);
        assert_eq!(drawn(&mut outlook, &mapper, Cell::new(0, 0)), ["ooooo"]);
        let mut mapper = map(&[".. .."]);
        assert_eq!(drawn(&mut outlook, &mapper, Cell::new(0, 0)), ["ooooo"]);
        look(&mut mapper, 1.0, &["..#.."]);
        assert_eq!(drawn(&mut outlook, &mapper, Cell::new(0, 0)), ["ooo--"]);
    }

    #[test]
    fn a_fine_grid_is_judged_by_squares() {
        let frame = GridFrame::new(Point2::origin(), 0.05, 243, 100).unwrap();
        let mut mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
        let wall = (0..100).map(|y| (Cell::new(122, y), true)).collect();
        mapper.update(&CellReading { time: 0.0, pose: Isometry2::identity(), cells: wall }).unwrap();
        let mut outlook = Outlook::new(10.0);
        let places = outlook.follow(&mapper);
        assert_eq!((places.side, places.columns, places.rows), (5, 49, 20));
        let mut cells: Vec<usize> = (0..places.count()).flat_map(|place| places.cells(place)).collect();
        assert!((0..places.count()).all(|place| places.cells(place).all(|cell| places.of(cell) == place)));
        cells.sort_unstable();
        assert_eq!(cells, (0..frame.len()).collect::<Vec<_>>());
        assert_eq!(outlook.seen_from(0).len(), 25 * 20, "up to the wall, the wall included");
    }

    /// Whether the line from the centre of `from` to that of `to` passes through the inside of the
    /// unit square around `cell`: cut by the square's sides, some of it is left.
    fn crosses(from: Cell, to: Cell, cell: Cell) -> bool {
        let (mut enter, mut leave) = (0.0f64, 1.0f64);
        for (from, to, at) in [(from.x, to.x, cell.x), (from.y, to.y, cell.y)] {
            let (way, gap) = (f64::from(to - from), f64::from(at - from));
            if way == 0.0 {
                if gap != 0.0 {
                    return false;
                }
            } else {
                let (one, other) = ((gap - 0.5) / way, (gap + 0.5) / way);
                enter = enter.max(one.min(other));
                leave = leave.min(one.max(other));
            }
        }
        leave - enter > 1e-9
    }

    proptest! {
        #[test]
        fn in_view_is_what_no_wall_parts_from_the_origin(
            walls in prop::collection::vec(prop::bool::weighted(0.3), 99),
            reach in 0.0..12.0,
        ) {
            let rows: Vec<String> = walls
                .chunks(11)
                .map(|row| row.iter().map(|&wall| if wall { '#' } else { '.' }).collect())
                .collect();
            let mapper = map(&rows.iter().map(String::as_str).collect::<Vec<_>>());
            let frame = *mapper.frame();
            let mut outlook = Outlook::new(reach);
            let places = outlook.follow(&mapper);
            for origin in 0..places.count() {
                let from = frame.cell(origin);
                let expected: Vec<u32> = (0..places.count())
                    .filter(|&index| {
                        let to = frame.cell(index);
                        let is_between = |&wall: &usize| {
                            let cell = frame.cell(wall);
                            outlook.opaque[wall] && cell != from && cell != to && crosses(from, to, cell)
                        };
                        f64::from((to.x - from.x).pow(2) + (to.y - from.y).pow(2)) <= reach * reach
                            && !(0..places.count()).any(|wall| is_between(&wall))
                    })
                    .map(|index| index as u32)
                    .collect();
                prop_assert_eq!(outlook.seen_from(origin), &expected, "from {:?}", from);
            }
        }
    }
}
