//! The map of what is permanent, and masks for the costmap filters of Nav2, values from 0 to 100.

use interfaces::{CellState, Grid, GridFrame};
use mapper::Mapper;
use std::collections::BTreeSet;

/// The names of the masks, in the order of [`masks`] and of [`Forecast::masks`](crate::Forecast::masks).
pub const MASKS: [&str; 2] = ["speed_mask", "keepout_mask"];

/// The largest value of the speed mask. The speed filter takes the mask value v as a limit of 100 − v percent of the full speed,
/// and a limit of 0 % as no limit: the value stays below 100.
const SLOWEST: f64 = 80.0;
/// The robot slows down at this distance from what changes, m: it stops from 1 m/s within 0.5 m at 1 m/s².
const DISTANCE_M: f64 = 0.5;
/// The time that a robot takes to pass a place, s: 1 m, the distance before and behind it, at 0.25 m/s.
const PASSING_S: f64 = 4.0;
/// Robots slow down where something comes into the way of at least one in 40 that pass (23 times per hour)…
const RARELY: f64 = 1.0 / 40.0;
/// …and most where it comes into the way of one in 10 (95 times per hour).
const OFTEN: f64 = 1.0 / 10.0;
/// The mass of the credible interval whose lower end is the rate that was earned: the true rate is higher with a probability of 95 %.
const MASS: f64 = 0.9;
/// A cell that changes is kept out of if it is blocked with at least this probability.
const PROBABLY: f64 = 0.5;
/// The value of a cell that must not be entered.
const KEEP_OUT: u8 = 100;
/// A cell that changes is permanent in a state if it is in this state for at least this share of the time.
pub(crate) const PERMANENT: f64 = 0.9;

/// The value of the speed mask for the number of times per second that something comes into the way: 0 up to one in 40 passing
/// robots, 80 from one in 10 on, in proportion to the logarithm of this share in between.
fn slowness(rate_hz: f64) -> u8 {
    let share = -libm::expm1(-rate_hz * PASSING_S);
    let part = libm::log(share / RARELY) / libm::log(OFTEN / RARELY);
    (SLOWEST * part.clamp(0.0, 1.0)).round() as u8 // the logarithm of 0 is below all limits
}

/// The cells of doors.
pub(crate) fn cells_of_doors(mapper: &Mapper) -> Vec<u32> {
    let mut cells: Vec<u32> = mapper.doors().iter().flat_map(|door| door.cells.iter().copied()).collect();
    cells.sort_unstable();
    cells
}

/// The cells that came and went at least this often, in ascending order.
fn came_and_went(mapper: &Mapper, times: u32) -> Vec<usize> {
    let mut cells: Vec<usize> = mapper.changed().collect();
    cells.retain(|index| {
        let seen = mapper.statistics(*index);
        let came = seen.block_events + seen.block_events_after_gap;
        came.min(seen.free_events + seen.free_events_after_gap) >= times
    });
    cells.sort_unstable();
    cells
}

/// The speed mask: [`slowness`], the largest value within 0.5 m. Only what came and went counts, as a patch of the size of a thing, as
/// the front of a thing that came and went twice, or as a door, with the rate that was earned. The pace of a cell is its rate at a
/// time of the week, divided by its mean rate.
pub(crate) fn speed_mask(mapper: &Mapper, pace: impl Fn(usize) -> f64) -> Grid<u8> {
    let frame = *mapper.frame();
    let [once, twice] = [1, 2].map(|times| came_and_went(mapper, times));
    let doors = cells_of_doors(mapper);
    let (areas, fronts) = (areas(&frame, &once), fronts(&frame, &twice));
    let is_in = |cells: &[usize], cell: &usize| cells.binary_search(cell).is_ok();
    let is_door = |cell: &usize| doors.binary_search(&(*cell as u32)).is_ok();
    let counted = once.iter().filter(|cell| is_in(&areas, cell) || is_in(&fronts, cell) || is_door(cell));
    let mut mask = Grid::filled(frame, 0);
    let reach = (DISTANCE_M / frame.resolution_m()).round() as i32;
    for &index in counted {
        let value = slowness(mapper.credible_interval(index, MASS).0 * pace(index));
        if value == 0 {
            continue;
        }
        for near in frame.cell(index).disc(reach) {
            if let Some(near) = mask.get_mut(near) {
                *near = value.max(*near);
            }
        }
    }
    mask
}

/// The keepout mask: 100 for a cell that changes and is probably blocked, by its index, otherwise 0. Such cells count where they
/// are a patch of the size of a thing, or belong to a door or to an object that comes and goes. Cells that never change are in the static map.
pub(crate) fn keepout_mask(mapper: &Mapper, blocked: impl Fn(usize) -> f64) -> Grid<u8> {
    let mut mask = Grid::filled(*mapper.frame(), 0);
    let mut probable: Vec<usize> = mapper.changed().filter(|index| blocked(*index) >= PROBABLY).collect();
    probable.sort_unstable();
    let mut things = cells_of_doors(mapper);
    things.extend(mapper.objects().flat_map(|object| object.cells));
    things.sort_unstable();
    let areas = areas(mapper.frame(), &probable);
    for index in probable {
        if areas.binary_search(&index).is_ok() || things.binary_search(&(index as u32)).is_ok() {
            mask.cells_mut()[index] = KEEP_OUT;
        }
    }
    mask
}

/// The speed mask and the keepout mask for any time: with mean rates, and the share of the time that a cell is blocked.
pub fn masks(mapper: &Mapper) -> [Grid<u8>; 2] {
    [speed_mask(mapper, |_| 1.0), keepout_mask(mapper, |index| share_blocked(mapper, index))]
}

/// The speed mask for any time, and the keepout mask of what is probably blocked this time after the last reading, s.
pub fn masks_ahead(mapper: &Mapper, ahead_s: f64) -> [Grid<u8>; 2] {
    let blocked = |index| mapper.blocked_probability_later(index, ahead_s);
    [speed_mask(mapper, |_| 1.0), keepout_mask(mapper, blocked)]
}

/// The map of what is permanent: a cell that never changed is as it was seen; a cell that changes is free where it is
/// free or will be free again, and blocked only where it is blocked nearly all the time. Movers, and their trails, are not
/// in this map.
pub fn permanent(mapper: &Mapper) -> Grid<CellState> {
    let mut map = mapper.states().clone();
    let changed: Vec<usize> = mapper.changed().collect();
    for index in changed {
        let share = share_blocked(mapper, index);
        map.cells_mut()[index] = if share >= PERMANENT { CellState::Blocked } else { CellState::Free };
    }
    map
}

/// The share of the time that a cell that changed is blocked, from 0 to 1: by its learned rates, or by the time in view
/// where there are no rates.
pub(crate) fn share_blocked(mapper: &Mapper, index: usize) -> f64 {
    let seen = mapper.statistics(index);
    let watched = seen.watched_free + seen.watched_blocked;
    match mapper.transition_rates(index) {
        Some((block, free)) if block + free > 0.0 => block / (block + free),
        _ if watched > 0.0 => seen.watched_blocked / watched,
        _ => f64::from(u8::from(mapper.states().cells()[index] == CellState::Blocked)),
    }
}

// Cells that are together as large as a thing, out of cells that change.
//
// The noise of a laser makes cells change one by one or a few together. What a robot can meet is larger: the two legs of a person, a
// chair, the leaf of a door.

/// A patch has at least this length and width, m, or this area in another form: as the legs of a person.
const PATCH_M: [f64; 2] = [0.3, 0.1];

/// The cells that are connected to an area of at least 0.1 m × 0.3 m; `cells` and the result are in ascending order.
pub(crate) fn areas(frame: &GridFrame, cells: &[usize]) -> Vec<usize> {
    let least = (PATCH_M[0] * PATCH_M[1] / frame.resolution_m().powi(2)).round().max(1.0) as usize;
    connected_where(frame, cells, |patch| patch.len() >= least)
}

/// The cells that are connected over at least 0.3 m along an axis of the grid, in ascending order as `cells`: of a thing that is seen
/// from one side, only the front changes, which is one cell deep.
fn fronts(frame: &GridFrame, cells: &[usize]) -> Vec<usize> {
    let least = (PATCH_M[0] / frame.resolution_m()).round().max(1.0) as i32;
    connected_where(frame, cells, |patch| frame.longer_side(patch) >= least)
}

/// The cells of all connected patches that are kept, in ascending order as `cells`.
fn connected_where(frame: &GridFrame, cells: &[usize], is_kept: impl Fn(&[usize]) -> bool) -> Vec<usize> {
    let mut left: BTreeSet<usize> = cells.iter().copied().collect();
    let mut found = Vec::new();
    while let Some(patch) = frame.take_connected(&mut left, 1) {
        if is_kept(&patch) {
            found.extend(patch);
        }
    }
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Cell, GridFrame};
    use nalgebra::Point2;

    #[test]
    fn the_value_grows_with_the_logarithm_of_the_share_of_robots_that_meet_something() {
        let per_hour = |rate: f64| slowness(rate / 3600.0);
        assert_eq!([0.0, 1.0, 22.0, 47.0, 95.0, 1e9].map(per_hour), [0, 0, 0, 41, 80, 80]);
        assert!(per_hour(23.5) > 0 && (0..200).map(|rate| per_hour(f64::from(rate))).is_sorted());
    }

    /// A map of 2 m × 2 m in cells of 0.05 m after 10 min: per cell, whether it is blocked at a time, s.
    fn watched(is_blocked: impl Fn(Cell, u32) -> bool) -> Mapper {
        let frame = GridFrame::new(Point2::origin(), 0.05, 40, 40).unwrap();
        crate::tests::watched(frame, 600, is_blocked)
    }

    fn most(mask: &Grid<u8>) -> u8 {
        mask.cells().iter().copied().max().unwrap_or_default()
    }

    fn is_in(cell: Cell, [width, height]: [i32; 2]) -> bool {
        (2..2 + width).contains(&cell.x) && (2..2 + height).contains(&cell.y)
    }

    #[test]
    fn only_what_came_and_went_as_a_thing_slows_a_robot() {
        let passing = |size: [i32; 2]| watched(move |cell, time| is_in(cell, size) && time % 60 < 6);
        // Once per minute, which 10 min of looking earn 25 times per hour or more of.
        let [slow, keepout] = masks(&passing([6, 6]));
        assert!((1..80).contains(&most(&slow)) && most(&keepout) == 0, "{}", most(&slow));
        // Within 0.5 m alone.
        let at = |x: i32| slow.cells()[(4 * 40 + x) as usize];
        assert!(at(17) > 0 && at(18) == 0, "{} and {}", at(17), at(18));
        // The front of a thing, and noise.
        assert!(most(&masks(&passing([7, 1]))[0]) > 0);
        for size in [[1, 1], [5, 1], [3, 3]] {
            assert_eq!(masks(&passing(size)).map(|mask| most(&mask)), [0, 0], "{size:?}");
        }
        // At hours in which little happens.
        assert_eq!(most(&speed_mask(&passing([6, 6]), |_| 0.1)), 0);
    }

    #[test]
    fn what_came_to_stay_is_kept_out_of_and_slows_nobody() {
        let came = |size: [i32; 2]| watched(move |cell, time| is_in(cell, size) && time > 100);
        for (size, keepout) in [([6, 6], 100), ([6, 2], 100), ([20, 1], 100), ([1, 1], 0), ([11, 1], 0)] {
            assert_eq!(masks(&came(size)).map(|mask| most(&mask)), [0, keepout], "{size:?}");
        }
    }
}

#[cfg(test)]
mod patches_tests {
    use super::*;
    use nalgebra::Point2;

    type Filter = fn(&GridFrame, &[usize]) -> Vec<usize>;

    /// The cells that are left of a drawing in cells of 0.05 m.
    fn left<const ROWS: usize>(filter: Filter, drawing: [&str; ROWS]) -> [String; ROWS] {
        let frame = GridFrame::new(Point2::origin(), 0.05, drawing[0].len(), ROWS).unwrap();
        let text = drawing.concat();
        let cells: Vec<usize> = text.match_indices('#').map(|(index, _)| index).collect();
        let kept = filter(&frame, &cells);
        let mark = |index: usize| if kept.binary_search(&index).is_ok() { '#' } else { '.' };
        let width = drawing[0].len();
        std::array::from_fn(|row| (row * width..(row + 1) * width).map(mark).collect())
    }

    #[test]
    fn single_cells_and_small_patches_are_no_things() {
        let drawing = [
            "#.........#######...",
            "....................",
            "######........###...",
            "######........###...",
            "..............###..#",
            "############........",
        ];
        let expected = [
            "....................",
            "....................",
            "######..............",
            "######..............",
            "....................",
            "############........",
        ];
        assert_eq!(left(areas, drawing), expected);
    }

    #[test]
    fn fronts_are_wide() {
        let drawing =
            ["######.#####", "............", "#...........", ".#..........", "..#.###.....", "...#...##..."];
        let expected =
            ["######......", "............", "#...........", ".#..........", "..#.###.....", "...#...##..."];
        assert_eq!(left(fronts, drawing), expected);
    }
}
