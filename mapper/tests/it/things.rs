//! Things that appear, disappear, and move past.

use crate::house::{House, Thing, rectangle};
use crate::observed::changes;
use interfaces::CellState;
use mapper::{Mapper, MapperSettings, SurfaceGridSettings};
use nalgebra::{Isometry2, Point2};

const PERIOD_S: f64 = 0.1;
/// The times at which things appear and disappear.
const MOMENT_S: f64 = 30.0;

/// Half a meter of slow circling in the lower left room.
fn circle(house: &House, time_s: f64) -> Isometry2<f64> {
    let angle = 0.1 * time_s;
    let at = house.turned(Point2::new(3.0 + 0.8 * angle.cos(), 2.0 + 0.8 * angle.sin()));
    interfaces::pose(at.x, at.y, angle)
}

/// Scans the house up to `until_s`, and calls the closure after every scan.
fn watch(house: &mut House, until_s: f64, mut after: impl FnMut(f64, &Mapper, &House)) {
    let mut mapper = Mapper::new(&MapperSettings::default(), house.frame).unwrap();
    for scan in 0..(until_s / PERIOD_S) as u32 {
        let time_s = f64::from(scan) * PERIOD_S;
        let reading = house.reading(time_s, circle(house, time_s), &[]);
        mapper.update(&reading).unwrap();
        after(time_s, &mapper, house);
    }
}

/// The houses for the things: aligned with the grid, and rotated with noise.
fn houses() -> [House; 2] {
    [House::new(0.1, 0.0, 0.0, 360, 2), House::new(0.1, 10.0, 0.01, 360, 2)]
}

/// A box in the open, and one beside a wall.
const BOXES: [(f64, f64); 2] = [(1.5, 3.0), (0.1, 1.0)];

#[test]
fn a_box_that_goes_is_cleared_soon() {
    for (x, y) in BOXES {
        for mut house in houses() {
            house.add(Thing { corners: rectangle(x, y, x + 0.4, y + 0.4), from_s: -1.0, until_s: MOMENT_S });
            let (mut cells, mut half_s, mut most_s) = (Vec::new(), f64::INFINITY, f64::INFINITY);
            watch(&mut house, MOMENT_S + 5.0, |time_s, mapper, house| {
                let is_blocked = |index: &usize| mapper.states().cells()[*index] == CellState::Blocked;
                if time_s < MOMENT_S - PERIOD_S / 2.0 {
                    cells = (0..house.frame.len()).filter(is_blocked).collect();
                    return;
                }
                cells.retain(|&index| house.truth(index, time_s) == CellState::Free);
                let left = cells.iter().filter(|index| is_blocked(index)).count();
                let since_s = time_s - MOMENT_S + PERIOD_S;
                if 2 * left <= cells.len() {
                    half_s = since_s.min(half_s);
                }
                if 10 * left <= cells.len() {
                    most_s = since_s.min(most_s);
                }
            });
            assert!(cells.len() >= 10, "the box was on the map: {} cells", cells.len());
            assert!(half_s <= 2.0 && most_s <= 3.0, "box at {x}, {y}: half {half_s} s, 90 % {most_s} s");
        }
    }
}

#[test]
fn a_box_that_comes_is_noticed_at_once() {
    for (x, y) in BOXES {
        for mut house in houses() {
            house.add(Thing { corners: rectangle(x, y, x + 0.4, y + 0.4), from_s: MOMENT_S, until_s: 1e9 });
            let mut noticed_s = f64::INFINITY;
            watch(&mut house, MOMENT_S + 5.0, |time_s, mapper, _| {
                if time_s >= MOMENT_S - PERIOD_S / 2.0 && changes(mapper).next().is_some() {
                    noticed_s = noticed_s.min(time_s - MOMENT_S + PERIOD_S);
                }
            });
            assert!(noticed_s <= 0.4, "box at {x}, {y}: noticed after {noticed_s} s");
        }
    }
}

/// A robot of radius 0.2 m that drives along a wall at 0.3 m/s, 5 cm away from it.
#[test]
fn cells_are_free_again_behind_a_disc_that_passes_along_a_wall() {
    for mut house in houses() {
        let mut mapper = Mapper::new(&MapperSettings::default(), house.frame).unwrap();
        let radius_m = 0.2;
        let (mut swept, mut noticed) = (0, 0);
        for scan in 0..350 {
            let time_s = f64::from(scan) * PERIOD_S;
            let x = 0.5 + 0.3 * (time_s - 20.0);
            let disc = house.turned(Point2::new(x, 0.1 + 0.05 + radius_m));
            let discs = if time_s < 20.0 { vec![] } else { vec![(disc, radius_m)] };
            mapper.update(&house.reading(time_s, circle(&house, time_s), &discs)).unwrap();
            noticed += changes(&mapper).count();
            if scan % 10 != 0 || time_s < 25.0 {
                continue;
            }
            // The places where the disc was until 2 s ago.
            let mut blocked = Vec::new();
            for index in 0..house.frame.len() {
                let middle = house.frame.center(house.frame.cell(index));
                let path = (0..(time_s - 22.0) as usize * 10)
                    .map(|tick| house.turned(Point2::new(0.5 + 0.03 * tick as f64, 0.1 + 0.05 + radius_m)));
                let was_covered = path.into_iter().any(|at| (at - middle).norm() < radius_m);
                if was_covered && house.truth(index, time_s) == CellState::Free {
                    swept += 1;
                    if mapper.states().cells()[index] == CellState::Blocked {
                        blocked.push(middle);
                    }
                }
            }
            assert!(blocked.len() <= 2, "at {time_s} s still blocked: {blocked:?}");
        }
        assert!(swept > 500 && noticed > 200, "{noticed} changes, {swept} cells behind the disc");
    }
}

/// One nonsense scan among good ones, for a mapper that is configured for spurious returns.
#[test]
fn a_single_scan_of_noise_changes_nothing() {
    let mut house = House::new(0.1, 0.0, 0.0, 360, 2);
    let mut wild = House::new(0.1, 0.0, 1.0, 360, 9);
    let steady = SurfaceGridSettings { hits_to_block_in_open: 2, ..SurfaceGridSettings::default() };
    let settings = MapperSettings { steady, ..MapperSettings::default() };
    let mut mapper = Mapper::new(&settings, house.frame).unwrap();
    for scan in 0..600 {
        let time_s = f64::from(scan) * PERIOD_S;
        let pose = circle(&house, time_s);
        let is_wild = scan >= 300 && scan % 30 == 0;
        let house = if is_wild { &mut wild } else { &mut house };
        mapper.update(&house.reading(time_s, pose, &[])).unwrap();
        let changed: Vec<_> = changes(&mapper).collect();
        assert!(changed.is_empty(), "at {time_s} s: {changed:?}");
    }
}
