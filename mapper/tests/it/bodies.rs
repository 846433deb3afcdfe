//! Bodies: what the map says about the cells that a thing covers, and about those that the thing only hides.

use crate::house::{House, Thing, rectangle};
use crate::observed::changes;
use interfaces::CellState;
use mapper::{Mapper, MapperSettings};
use nalgebra::{Isometry2, Point2, Vector2};
use proptest::prelude::{ProptestConfig, proptest};
use std::collections::BTreeSet;
use std::f64::consts::TAU;

const PERIOD_S: f64 = 0.1;
/// The number of scans of the empty house before anything moves.
const EMPTY_SCANS: u32 = 50;

/// What a mapper made of a house in which things moved.
struct Watched {
    mapper: Mapper,
    house: House,
    /// The cells that a thing touched at any time.
    touched: BTreeSet<usize>,
    /// The cells that changed in the map.
    changed: BTreeSet<usize>,
}

/// The outline of a thing.
type Outline = Vec<Point2<f64>>;

/// The house, empty at first, then with `things(scan)`, seen by a robot at rest.
fn watch(at: (f64, f64), scans: u32, things: impl Fn(u32) -> Vec<Outline>) -> Watched {
    watch_from(|_| at, scans, things)
}

/// The same, seen by a robot at `at(scan)`.
fn watch_from(at: impl Fn(u32) -> (f64, f64), scans: u32, things: impl Fn(u32) -> Vec<Outline>) -> Watched {
    let mut house = House::new(0.1, 0.0, 0.0, 720, 1);
    let walls = house.things.len();
    let mut mapper = Mapper::new(&MapperSettings::default(), house.frame).unwrap();
    let (mut touched, mut changed) = (BTreeSet::new(), BTreeSet::new());
    for scan in 0..EMPTY_SCANS + scans {
        house.things.truncate(walls);
        for corners in scan.checked_sub(EMPTY_SCANS).map(&things).unwrap_or_default() {
            touched.extend((0..house.frame.len()).filter(|&index| touches(&house, index, &corners)));
            house.add(Thing::always(corners));
        }
        let at = at(scan.saturating_sub(EMPTY_SCANS));
        let pose = Isometry2::translation(at.0, at.1);
        mapper.update(&house.reading(f64::from(scan) * PERIOD_S, pose, &[])).unwrap();
        if scan >= EMPTY_SCANS {
            changed.extend(changes(&mapper).filter_map(|cell| house.frame.index(cell)));
        }
    }
    Watched { mapper, house, touched, changed }
}

/// A beam that ends near the edge of a thing counts this far behind the surface, m: half the depth of a hit.
const EDGE_M: f64 = 0.01;

/// Whether a convex outline overlaps a cell or is nearer than [`EDGE_M`]: no side of either separates them.
fn touches(house: &House, index: usize, corners: &[Point2<f64>]) -> bool {
    let (middle, half_m) = (house.frame.center(house.frame.cell(index)), house.frame.resolution_m() / 2.0);
    let cell = rectangle(middle.x - half_m, middle.y - half_m, middle.x + half_m, middle.y + half_m);
    let separates = |a: &[Point2<f64>], b: &[Point2<f64>]| {
        (0..a.len()).any(|side| {
            let (from, along) = (a[side], a[(side + 1) % a.len()] - a[side]);
            b.iter().all(|point| along.perp(&(point - from)) <= (1e-9 - EDGE_M) * along.norm())
        })
    };
    !separates(&cell, corners) && !separates(corners, &cell)
}

/// A rectangle about `middle` with a length and a thickness, turned.
fn turned_box(middle: Point2<f64>, length_m: f64, thickness_m: f64, turn_rad: f64) -> Vec<Point2<f64>> {
    let (x, y) = (length_m / 2.0, thickness_m / 2.0);
    let corners = rectangle(-x, -y, x, y);
    corners.into_iter().map(|corner| middle + interfaces::rotation(turn_rad) * corner.coords).collect()
}

/// A disc, as a polygon.
fn disc(middle: Point2<f64>, radius_m: f64) -> Vec<Point2<f64>> {
    let rim = Vector2::new(radius_m, 0.0);
    let corner = |corner: i32| middle + interfaces::rotation(f64::from(corner) * TAU / 48.0) * rim;
    (0..48).map(corner).collect()
}

impl Watched {
    /// Of the cells that changed in the map, which are some, every one was touched by a thing.
    #[track_caller]
    fn check(&self, least: usize, case: &str) {
        let changed = self.changed.len();
        assert!(changed >= least, "{case}: {changed} changes");
        let center = |&index: &usize| self.house.frame.center(self.house.frame.cell(index));
        let found: Vec<Point2<f64>> = self.changed.difference(&self.touched).map(center).collect();
        assert!(found.is_empty(), "{case}: {found:?} changed");
    }

    /// The share of the cells inside of an outline that are blocked in the map.
    fn blocked_share(&self, corners: &[Point2<f64>]) -> f64 {
        let mut house = self.house.clone();
        house.things = vec![Thing::always(corners.to_vec())];
        let inside = |&index: &usize| house.truth(index, 0.0) == CellState::Blocked;
        let cells: Vec<usize> = (0..house.frame.len()).filter(inside).collect();
        let blocked =
            cells.iter().filter(|&&index| self.mapper.states().cells()[index] == CellState::Blocked);
        blocked.count() as f64 / cells.len() as f64
    }
}

#[test]
fn things_of_any_thickness_block_no_cell_behind_them() {
    for thickness_m in [0.02, 0.05, 0.1, 0.3, 1.0] {
        for turn_rad in [0.0, 0.3, 0.8] {
            let slides = |scan: u32| {
                let middle = Point2::new(2.0 + 0.03 * f64::from(scan), 3.5 + thickness_m / 2.0);
                vec![turned_box(middle, 0.8, thickness_m, turn_rad)]
            };
            let watched = watch((3.0, 1.5), 60, slides);
            watched.check(21, &format!("{thickness_m} m thick, turned {turn_rad}"));
        }
    }
}

#[test]
fn a_swinging_door_changes_only_the_sector_that_it_sweeps() {
    for at in [(3.0, 1.5), (3.0, 8.0), (1.0, 5.2)] {
        let swings = |scan: u32| {
            let angle = 0.04 * f64::from(scan.min(39));
            let along = interfaces::rotation(angle) * Vector2::new(0.5, 0.0);
            vec![turned_box(Point2::new(2.5, 5.975) + along, 1.0, 0.05, angle)]
        };
        watch(at, 80, swings).check(21, &format!("from {at:?}"));
    }
}

#[test]
fn the_space_between_the_legs_of_a_person_stays_free() {
    let walks = |scan: u32| {
        let step_m = 0.15 * (0.3 * f64::from(scan)).sin();
        let leg = |y: f64, ahead_m: f64| disc(Point2::new(1.5 + 0.04 * f64::from(scan) + ahead_m, y), 0.06);
        vec![leg(3.4, step_m), leg(3.7, -step_m)]
    };
    watch((3.0, 1.5), 70, walks).check(101, "a person");
}

/// Only a part of each body can be seen from one place.
#[test]
fn a_body_is_known_from_its_visible_side() {
    let bodies = [
        ("disc", disc(Point2::new(3.0, 3.5), 0.3), 0.7),
        ("box with a corner in front", turned_box(Point2::new(3.0, 3.5), 0.6, 0.4, 0.7), 0.95),
    ];
    for (name, corners, least) in bodies {
        let watched = watch((3.0, 1.5), 10, |_| vec![corners.clone()]);
        let share = watched.blocked_share(&corners);
        assert!(share >= least, "{name}: {share}");
        watched.check(0, name);
    }
}

/// From the side, the gap between two boxes seems to be a part of one body. A look through the gap shows that it is not.
#[test]
fn a_gap_between_two_bodies_at_rest_stays_free_once_it_was_seen_free() {
    let boxes = || vec![rectangle(2.5, 3.5, 2.95, 3.9), rectangle(3.03, 3.5, 3.5, 3.9)];
    let (aside, through) = ((1.5, 1.5), (2.99, 1.5));
    let gap = |watched: &Watched| {
        let cells = (0..8).map(|row| Point2::new(2.975, 3.525 + 0.05 * f64::from(row)));
        let is_blocked = |at: &Point2<f64>| {
            watched.mapper.states().get(watched.house.frame.cell_at(at)) == Some(&CellState::Blocked)
        };
        cells.filter(is_blocked).count()
    };
    let first = watch_from(|_| aside, 130, |_| boxes());
    assert!(gap(&first) > 0, "the gap seems to be a part of a body");
    let again = watch_from(|scan| if (130..190).contains(&scan) { through } else { aside }, 250, |_| boxes());
    assert_eq!(gap(&again), 0);
}

#[test]
fn a_thing_that_comes_behind_a_leaf_at_rest_is_a_body_of_its_own() {
    for y in [3.74, 3.76, 3.78, 3.8] {
        let beside = disc(Point2::new(3.38, y), 0.17);
        let comes = |scan: u32| {
            let leaf = rectangle(2.5, 3.5, 3.4, 3.55);
            if scan < 120 { vec![leaf] } else { vec![leaf, beside.clone()] }
        };
        let watched = watch((3.7, 1.5), 125, comes);
        assert!(watched.blocked_share(&beside) > 0.0, "{y}: not seen");
        watched.check(0, &format!("beside {y}"));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]
    /// A thing changes nothing but the cells that it touches, wherever it stands: hidden cells keep their states.
    #[test]
    fn hidden_cells_keep_their_states(x in 1.0f64..5.0, y in 3.0f64..5.0, length_m in 0.1f64..1.0,
                                      thickness_m in 0.02f64..1.0, turn_rad in 0.0f64..3.2, round: bool) {
        let middle = Point2::new(x, y);
        let corners = match round {
            true => disc(middle, length_m / 2.0),
            false => turned_box(middle, length_m, thickness_m, turn_rad),
        };
        watch((3.0, 1.5), 3, |_| vec![corners.clone()]).check(0, "a thing");
    }
}
