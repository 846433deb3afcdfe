//! Furniture that was moved is reported once.

use crate::house::{House, Thing, rectangle};
use mapper::{Furniture, Mapper, MapperSettings, ThingKind};
use nalgebra::{Isometry2, Point2};

const PERIOD_S: f64 = 0.1;
/// A box stands at the first place until the first time, and at the second place from the second time on.
const PLACES: [(f64, f64); 2] = [(1.0, 4.0), (4.5, 0.8)];
const TIMES_S: [f64; 2] = [90.0, 95.0];
const SIDE_M: f64 = 0.5;

fn pose(time_s: f64) -> Isometry2<f64> {
    let angle = 0.2 * time_s;
    interfaces::pose(3.0 + 0.8 * angle.cos(), 3.0 + 0.8 * angle.sin(), angle)
}

/// The furniture after some time in a house with the box; `is_hidden`: the robot sleeps while the box is moved.
fn furniture(until_s: f64, is_hidden: bool) -> Vec<Furniture> {
    let mut house = House::new(0.1, 0.0, 0.005, 360, 4);
    for ((x, y), from_s, until_s) in [(PLACES[0], -1.0, TIMES_S[0]), (PLACES[1], TIMES_S[1], f64::INFINITY)] {
        house.add(Thing { corners: rectangle(x, y, x + SIDE_M, y + SIDE_M), from_s, until_s });
    }
    let mut mapper = Mapper::new(&MapperSettings::default(), house.frame).unwrap();
    for scan in 0..(until_s / PERIOD_S) as u32 {
        let time_s = f64::from(scan) * PERIOD_S;
        if is_hidden && scan == 800 {
            mapper.pause(110.0);
        }
        if !is_hidden || !(80.0..110.0).contains(&time_s) {
            mapper.update(&house.reading(time_s, pose(time_s), &[])).unwrap();
        }
    }
    let things = mapper.things().iter().map(|thing| match &thing.kind {
        ThingKind::Furniture(furniture) => furniture.clone(),
        ThingKind::Door(door) => panic!("{:?}", door.closed),
    });
    things.collect()
}

fn text(found: &[Furniture]) -> String {
    let place = |place: &mapper::Place| format!("{}, {:?}; ", place.center, place.between_s);
    found.iter().flat_map(|furniture| furniture.places()).map(place).collect()
}

#[test]
fn a_box_that_was_moved_once_is_reported_once() {
    for is_hidden in [false, true] {
        let found = furniture(240.0, is_hidden);
        let [Furniture { from: Some(from), to: Some(to) }] = &found[..] else { panic!("{}", text(&found)) };
        for ((place, (x, y)), time_s) in [from, to].into_iter().zip(PLACES).zip(TIMES_S) {
            let middle = Point2::new(x + SIDE_M / 2.0, y + SIDE_M / 2.0);
            assert!((place.center - middle).norm() < 0.3, "{}, not {middle}", place.center);
            let [before_s, after_s] = place.between_s;
            assert!(before_s <= time_s + 1.0 && time_s <= after_s, "{time_s}: {:?}", place.between_s);
            assert!(after_s - before_s < if is_hidden { 32.0 } else { 2.0 }, "{:?}", place.between_s);
        }
    }
}

#[test]
fn a_box_that_stands_is_not_reported() {
    assert_eq!(furniture(85.0, false), []);
}
