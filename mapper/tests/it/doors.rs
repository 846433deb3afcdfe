//! Doors are found, measured and counted; people in doorways are no doors.

use crate::house::{House, Thing, rectangle};
use interfaces::{CellState, GridFrame};
use mapper::{Door, Leaf, Mapper, MapperSettings};
use nalgebra::{Isometry2, Point2};
use std::f64::consts::FRAC_PI_2;

const PERIOD_S: f64 = 0.1;
/// The door changes at all multiples of this time.
const STAY_S: f64 = 15.0;
const END_S: f64 = 127.0;
/// The leaf in the upper doorway of the lower left room, closed, and open into this room about a hinge at its left end.
const CLOSED: [f64; 4] = [2.5, 5.95, 3.5, 6.0];
const OPEN: [f64; 4] = [2.5, 5.0, 2.55, 6.0];

/// The house in which the closed leaf and the other places of the leaf take turns.
fn house_with_door(turn_deg: f64, open: Option<[f64; 4]>) -> House {
    let mut house = House::new(0.1, turn_deg, 0.005, 360, 3);
    for stay in 0..(END_S / STAY_S) as usize + 1 {
        let from_s = stay as f64 * STAY_S;
        let leaf = if stay % 2 == 0 { Some(CLOSED) } else { open };
        if let Some([x0, y0, x1, y1]) = leaf {
            house.add(Thing { corners: rectangle(x0, y0, x1, y1), from_s, until_s: from_s + STAY_S });
        }
    }
    house
}

/// A slow circle in the lower left room.
fn pose(house: &House, time_s: f64) -> Isometry2<f64> {
    let angle = 0.1 * time_s;
    let at = house.turned(Point2::new(3.0 + 0.8 * angle.cos(), 3.0 + 0.8 * angle.sin()));
    interfaces::pose(at.x, at.y, angle)
}

/// A person who walks from one room to the other while the door is open, and back when it is open again.
fn person(house: &House, time_s: f64) -> (Point2<f64>, f64) {
    let turn_s = time_s % (4.0 * STAY_S);
    let way_m = if turn_s < 2.0 * STAY_S { turn_s - STAY_S - 2.0 } else { 4.0 * STAY_S - 2.0 - turn_s } * 0.6;
    let way_m = way_m.clamp(0.0, 6.0);
    let x = if (1.5..4.5).contains(&way_m) { 3.0 } else { 3.0 - (way_m - 3.0).abs() + 1.5 };
    (house.turned(Point2::new(x, 4.5 + 0.5 * way_m)), 0.22)
}

fn new_mapper(house: &House) -> Mapper {
    Mapper::new(&MapperSettings::default(), house.frame).unwrap()
}

/// Maps the house from a scan on, until before another one.
fn watch(mapper: &mut Mapper, house: &mut House, scans: std::ops::Range<u32>, has_person: bool) {
    for scan in scans {
        let time_s = f64::from(scan) * PERIOD_S;
        let discs = if has_person { vec![person(house, time_s)] } else { vec![] };
        mapper.update(&house.reading(time_s, pose(house, time_s), &discs)).unwrap();
    }
}

fn watched(house: &mut House, has_person: bool) -> Mapper {
    let mut mapper = new_mapper(house);
    watch(&mut mapper, house, 0..(END_S / PERIOD_S) as u32, has_person);
    mapper
}

fn only_door(mapper: &Mapper) -> &Door {
    match mapper.doors() {
        [door] => door,
        others => panic!("{} doors", others.len()),
    }
}

/// Checks the ends of the closed leaf, what was counted, and the state at the end.
fn check_door(house: &House, door: &Door) {
    let ends = [(2.5, 5.975), (3.5, 5.975)].map(|(x, y)| house.turned(Point2::new(x, y)));
    for end in ends {
        let off_m = door.closed.ends.map(|found| (found - end).norm());
        assert!(off_m[0].min(off_m[1]) < 0.1, "{end}: {:?}", door.closed);
    }
    let (seen, motions) = (door.evidence(), (END_S / STAY_S) as u32);
    let moves = seen.events();
    assert!(moves.iter().sum::<u32>() >= motions - 1, "{moves:?}, {motions} motions");
    assert!(moves.iter().all(|moves| *moves <= motions / 2), "{moves:?}, {motions} motions");
    assert!((0.8 * END_S..=END_S).contains(&seen.in_view_s()), "{} s", seen.in_view_s());
    assert_eq!(door.is_open(), motions % 2 == 1);
    let (per_hour, _) = door.openings_per_hour();
    let true_per_hour = 3600.0 / (2.0 * STAY_S);
    assert!((per_hour / true_per_hour).ln().abs() < 0.3, "{per_hour}, not {true_per_hour}");
}

#[test]
fn a_hinged_door_is_found_with_its_hinge() {
    for (turn_deg, has_person) in [(0.0, false), (20.0, false), (0.0, true)] {
        let mut house = house_with_door(turn_deg, Some(OPEN));
        let mapper = watched(&mut house, has_person);
        println!("{turn_deg}°, person {has_person}");
        let door = only_door(&mapper);
        check_door(&house, door);
        let Leaf::Hinged { hinge, length_m, closed_rad, open_rad } = door.leaf else {
            panic!("{turn_deg}°, person {has_person}: {:?}", door.closed)
        };
        let true_hinge = house.turned(Point2::new(2.5, 5.975));
        assert!((hinge - true_hinge).norm() < 0.1 && (length_m - 1.0).abs() < 0.1, "{hinge}, {length_m} m");
        for (found_rad, true_rad) in [(closed_rad, 0.0), (open_rad, -FRAC_PI_2)] {
            let off_rad = interfaces::wrap_rad(found_rad - true_rad - house.turn_rad);
            assert!(off_rad.abs() < 0.1, "{turn_deg}°: {found_rad}, not {true_rad}");
        }
    }
}

#[test]
fn a_look_at_a_part_of_a_door_says_what_its_other_cells_are() {
    let mut house = house_with_door(0.0, Some(OPEN));
    let mut mapper = new_mapper(&house);
    // Until the door is open; then the robot sees nothing but the closed leaf.
    watch(&mut mapper, &mut house, 0..1190, false);
    let open_leaf = mapper.frame().index(mapper.frame().cell_at(&Point2::new(2.525, 5.35))).unwrap();
    let unseen = mapper.blocked_probability_later(open_leaf, 5.0);
    assert!(unseen > 0.5, "{unseen}");
    for scan in 1210..1240 {
        let time_s = f64::from(scan) * PERIOD_S;
        let mut reading = house.reading(time_s, pose(&house, time_s), &[]);
        for beam in 0..reading.scan.ranges_m.len() {
            let bearing_rad = reading.scan.angle_min_rad + beam as f64 * reading.scan.angle_increment_rad;
            let along = reading.pose.rotation * interfaces::rotation(bearing_rad) * nalgebra::Vector2::x();
            let range_m = &mut reading.scan.ranges_m[beam];
            let end = Point2::from(reading.pose.translation.vector) + along * f64::from(*range_m);
            if !(end.y > 5.9 && (2.7..3.4).contains(&end.x)) {
                *range_m = f32::NAN;
            }
        }
        mapper.update(&reading).unwrap();
    }
    assert!(mapper.recency(open_leaf) > 4.0 && mapper.states().cells()[open_leaf] == CellState::Blocked);
    let predicted = mapper.blocked_probability(open_leaf);
    assert!(predicted < 0.5 * unseen, "{predicted}, and {unseen} without the look");
}

/// Seen for some moments in each of its states, 20 minutes apart: it may have moved once between two visits, or often.
#[test]
fn a_door_that_is_hardly_seen_has_a_rate_by_its_gaps() {
    const VISIT_S: f64 = 8.0;
    const BETWEEN_S: f64 = 1200.0;
    let mut house = House::new(0.1, 0.0, 0.005, 360, 3);
    for visit in 0..10 {
        let from_s = f64::from(visit) * BETWEEN_S;
        let [x0, y0, x1, y1] = if visit % 2 == 0 { CLOSED } else { OPEN };
        house.add(Thing {
            corners: rectangle(x0, y0, x1, y1),
            from_s: from_s - 60.0,
            until_s: from_s + 60.0,
        });
    }
    let mut mapper = new_mapper(&house);
    for visit in 0..10 {
        let first = (f64::from(visit) * BETWEEN_S / PERIOD_S) as u32;
        mapper.pause(f64::from(visit) * BETWEEN_S);
        watch(&mut mapper, &mut house, first..first + (VISIT_S / PERIOD_S) as u32, false);
    }
    let door = only_door(&mapper);
    let seen = door.evidence();
    assert!(seen.events() == [0, 0] && seen.changes_after_gap() >= 8, "{seen:?}");
    assert!((40.0..=10.0 * VISIT_S).contains(&seen.in_view_s()), "{} s", seen.in_view_s());
    let (per_hour, [low, high]) = door.openings_per_hour();
    // One motion per gap is the least; nothing shows that it is not many times more.
    assert!((0.5..1.5).contains(&low) && high > 10.0, "{low} to {high} per hour");
    assert!((low..high).contains(&per_hour), "{per_hour}");
}

#[test]
fn a_sliding_door_is_found_without_a_hinge() {
    for turn_deg in [0.0, 20.0] {
        let mut house = house_with_door(turn_deg, None);
        let mapper = watched(&mut house, false);
        let door = only_door(&mapper);
        check_door(&house, door);
        assert_eq!(door.leaf, Leaf::Sliding);
        // The clock was told that it is closed.
        let soon = door.clock.probability(END_S + 1.0, &mapper::Calendar::Relative);
        assert!(soon < 0.3, "{soon}");
    }
}

#[test]
fn a_person_in_a_doorway_is_no_door() {
    let mut house = House::new(0.1, 0.0, 0.005, 360, 3);
    let mapper = watched(&mut house, true);
    assert!(mapper.changed().count() > 500, "the person was seen");
    assert!(mapper.doors().is_empty());
}

#[test]
fn a_door_is_the_same_after_a_snapshot_and_in_a_larger_map() {
    let scans = (END_S / PERIOD_S) as u32;
    let mut house = house_with_door(0.0, Some(OPEN));
    let mut whole = new_mapper(&house);
    watch(&mut whole, &mut house, 0..scans / 2, true);
    let snapshot = whole.snapshot();
    let before = whole.doors().to_vec();
    assert_eq!(before.len(), 1);
    let (mut restored, mut grown, mut same_house) = (new_mapper(&house), new_mapper(&house), house.clone());
    restored.restore(&snapshot).unwrap();
    grown.restore(&snapshot).unwrap();
    watch(&mut whole, &mut house.clone(), scans / 2..scans, true);
    watch(&mut restored, &mut same_house, scans / 2..scans, true);
    assert!(restored.doors() == whole.doors());
    assert!(restored.snapshot() == whole.snapshot());

    let frame = GridFrame::covering(Point2::new(-1.0, -2.0), 15.0, 15.0, house.frame.resolution_m()).unwrap();
    let growth = grown.grow(&MapperSettings::default(), frame).unwrap().unwrap();
    watch(&mut grown, &mut house, scans / 2..scans, true);
    let [was, is] = [&whole, &grown].map(|mapper| &mapper.doors()[0]);
    assert_eq!((is.id, grown.doors().len()), (before[0].id, 1));
    let mut cells: Vec<u32> = was.cells.iter().map(|&cell| growth.index(cell as usize) as u32).collect();
    cells.sort_unstable();
    assert_eq!(is.cells, cells);
    check_door(&house, only_door(&grown));
}
