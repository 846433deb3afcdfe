//! Generated buildings: all rooms connected, nothing inside another thing, and the same as ever.

use super::standstill::oracle::{CELL_M, Positions};
use nalgebra::Point2;
use sim::physics::*;

/// The number of houses, and of offices, in each test.
const HOUSES: u64 = 300;
const OFFICES: u64 = 60;

fn houses() -> impl Iterator<Item = WorldSpec> {
    (0..HOUSES).map(WorldSpec::generate_house)
}

fn buildings() -> impl Iterator<Item = WorldSpec> {
    houses().chain((0..OFFICES).map(WorldSpec::generate_office))
}

/// Walls and furniture, and the leaves of open doors if they are asked for.
fn solids(house: &FleetSpec, with_doors: bool) -> Vec<Rectangle> {
    let obstacles = house.obstacles.iter().filter_map(|obstacle| match leaf(obstacle, 1.0) {
        Some(leaf) => with_doors.then_some(leaf),
        None => Some(obstacle.shape),
    });
    house.walls.iter().copied().chain(obstacles).collect()
}

/// The leaf of a door; `None` for furniture.
fn leaf(obstacle: &ObstacleSpec, openness: f64) -> Option<Rectangle> {
    match &obstacle.motion {
        Motion::Door(door) => Some(door.shape(&obstacle.shape, openness)),
        _ => None,
    }
}

/// The parts of the house in which a disc is free.
fn parts(house: &WorldSpec, radius_m: f64, with_doors: bool) -> Vec<Vec<Point2<f64>>> {
    let [width, height] = [house.frame.width(), house.frame.height()].map(|cells| cells as f64);
    let high = Point2::new(width, height) * house.frame.resolution_m();
    let solids = solids(house, with_doors).into_iter().map(|solid| Form::Convex(solid.corners().to_vec()));
    Positions::new([Point2::origin(), high], solids, radius_m).parts()
}

/// Furniture never divides a house; an open door can hide a place behind it, but never a room or a robot.
#[test]
fn every_place_where_a_robot_fits_can_be_reached() {
    for house in buildings() {
        let radius_m = building_ranges::HOUSE.person_radius_m[1] + 0.03;
        assert_eq!(parts(&house, radius_m, false).len(), 1, "{}", house.name);
        let mut parts = parts(&house, radius_m, true);
        parts.sort_by_key(Vec::len);
        let (whole, pockets) = parts.split_last().unwrap();
        let hidden: usize = pockets.iter().map(Vec::len).sum();
        assert!(50 * hidden < whole.len(), "{}: {hidden} of {}", house.name, whole.len());
        let points = house.robots.iter().flat_map(|robot| match &robot.behavior {
            BehaviorSpec::Waypoints(way) => way.points.clone(),
            _ => vec![robot.pose.translation.vector.into()],
        });
        for point in points {
            let is_near = |place: &Point2<f64>| (place - point).norm() < 2.0 * CELL_M;
            assert!(whole.iter().any(is_near), "{}: {point}", house.name);
        }
    }
}

/// The reader of world files checks that robots, rounds, furniture and walls do not overlap, but not doors.
#[test]
fn a_file_has_the_same_building() {
    let kinds = calendar::Kind::ALL.into_iter();
    let calendars =
        kinds.flat_map(|(_, kind)| (0..20).map(move |seed| WorldSpec::generate_calendar(kind, seed)));
    for house in buildings().chain(calendars) {
        assert_eq!(super::parse(&worldfile::physics::to_toml(house.fleet()).unwrap()), house);
    }
}

#[test]
fn no_door_meets_furniture() {
    for house in buildings() {
        let is_door = |obstacle: &&ObstacleSpec| leaf(obstacle, 0.0).is_some();
        let (doors, furniture): (Vec<_>, Vec<_>) = house.obstacles.iter().partition(is_door);
        for (door, part) in doors.iter().flat_map(|door| (0..=10).map(move |part| (door, part))) {
            let leaf = leaf(door, f64::from(part) / 10.0).unwrap();
            let met = furniture.iter().find(|piece| leaf.overlaps(&piece.shape)).map(|piece| &piece.name);
            assert_eq!(met, None, "{}: {}", house.name, door.name);
        }
    }
}

#[test]
fn houses_have_what_their_ranges_say() {
    let mut robots = [0_usize; 3];
    let (mut rooms, mut doors, mut furniture) = (Vec::new(), 0, 0);
    let is_in = |[low, high]: [f64; 2], value: f64| (low..=high).contains(&value);
    for house in houses() {
        rooms.push(house.description.split(' ').next().unwrap().parse::<usize>().unwrap());
        for obstacle in &house.obstacles {
            let Motion::Door(DoorSpec { opening, .. }) = &obstacle.motion else {
                furniture += 1;
                continue;
            };
            doors += 1;
            let (Opening::Periodic { closed_s, open_s } | Opening::Random { closed_s, open_s }) = *opening
            else {
                panic!("{opening:?}")
            };
            let ranges = building_ranges::HOUSE;
            assert!(is_in(ranges.closed_s, closed_s) && is_in(ranges.open_s, open_s));
        }
        for robot in &house.robots {
            let kind = match robot.behavior {
                BehaviorSpec::Driven => 0,
                BehaviorSpec::Waypoints(_) => 1,
                _ => 2,
            };
            robots[kind] += 1;
        }
    }
    let houses = HOUSES as usize;
    assert!(rooms.iter().all(|rooms| (2..=9).contains(rooms)) && rooms.iter().sum::<usize>() > 4 * houses);
    assert!(doors > 3 * houses && furniture > 7 * houses, "{doors} {furniture}");
    assert_eq!(robots[0], houses);
    assert!(robots[1] > 3 * houses / 2 && robots[2] > houses / 3, "{robots:?}");
}

/// Results on houses depend on every number in them: a change must be intended.
#[test]
fn houses_are_what_they_always_were() {
    let line = |name: String| {
        let house = WorldSpec::generated(&name).unwrap();
        let text = worldfile::physics::to_toml(house.fleet()).unwrap();
        format!("{:016x} {}", crate::fnv(text.bytes().map(u64::from)), house.description)
    };
    let names = (0..4).chain([u64::MAX]).map(|seed| format!("house-{seed}"));
    let names = names.chain((0..2).map(|seed| format!("office-{seed}")));
    let names = names.chain(["rooms-0", "rooms-1", "rooms-5", "rooms-day-2"].map(str::to_owned));
    let lines: Vec<String> = names.map(line).collect();
    insta::assert_snapshot!(lines.join("\n"), @"
    4a6acc224a820235 5 rooms at a corridor, doors: 3, people: 1; made at random from the seed 0.
    623c028a48dfd156 5 rooms at a corridor, doors: 4, people: 2; made at random from the seed 1.
    c7efbdc2bfb7bacb 5 rooms at a corridor, doors: 4, people: 1; made at random from the seed 2.
    b6e9a7065e488320 8 rooms at a corridor, doors: 7, people: 1; made at random from the seed 3.
    d0c92e7d66d505fd 6 rooms at a corridor, doors: 3, people: 1; made at random from the seed 18446744073709551615.
    0179d7028a9bd438 13 rooms at a corridor, doors: 10, people: 5; made at random from the seed 0.
    1a04b80498095062 11 rooms at a corridor, doors: 11, people: 6; made at random from the seed 1.
    7928d773fa8e061e 18 rooms, things: 7, doors: 0; made at random from the seed 0.
    7ef94c1342176d6c 6 rooms, things: 7, doors: 0; made at random from the seed 1.
    fcd8a3a8a61294f3 14 rooms, things: 20, doors: 1; made at random from the seed 5.
    3ead6cc57edfb451 28 rooms, things: 19, doors: 2; made at random from the seed 2.
    ");
}
