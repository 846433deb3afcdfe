//! Generated buildings: all rooms connected, nothing inside another thing, and the same as ever.

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

/// The leaf of a door; `None` for furniture.
fn leaf(obstacle: &ObstacleSpec, openness: f64) -> Option<Rectangle> {
    match &obstacle.motion {
        Motion::Door(door) => Some(door.shape(&obstacle.shape, openness)),
        _ => None,
    }
}

/// Furniture never divides a house; an open door can hide a place behind it, but never a room or a robot.
#[test]
fn every_place_where_a_robot_fits_can_be_reached() {
    for house in buildings() {
        let radius_m = building_ranges::HOUSE.person_radius_m[1] + 0.03;
        let mut without_doors = house.fleet().clone();
        without_doors.obstacles.retain(|obstacle| leaf(obstacle, 0.0).is_none());
        assert_eq!(FreeSpace::new(&without_doors, radius_m).areas_m2().len(), 1, "{}", house.name);
        let opened = FreeSpace::new(&house, radius_m);
        let areas_m2 = opened.areas_m2();
        let whole = (0..areas_m2.len()).max_by(|a, b| areas_m2[*a].total_cmp(&areas_m2[*b])).unwrap();
        let hidden_m2 = areas_m2.iter().sum::<f64>() - areas_m2[whole];
        assert!(50.0 * hidden_m2 < areas_m2[whole], "{}: {hidden_m2} m² of {}", house.name, areas_m2[whole]);
        let points = house.robots.iter().flat_map(|robot| match &robot.behavior {
            BehaviorSpec::Waypoints(way) => way.points.clone(),
            _ => vec![robot.pose.translation.vector.into()],
        });
        for point in points {
            assert_eq!(opened.region_near(&point, 0.1), Some(whole), "{}: {point}", house.name);
        }
    }
}

/// The reader of world files checks that robots, rounds, furniture and walls do not overlap.
#[test]
fn a_file_has_the_same_building() {
    let kinds = calendar::Kind::ALL.into_iter();
    let calendars =
        kinds.flat_map(|(_, kind)| (0..20).map(move |seed| WorldSpec::generate_calendar(kind, seed)));
    for house in buildings().chain(calendars) {
        let text = worldfile::physics::to_toml(house.fleet()).unwrap();
        let read =
            worldfile::physics::parse_world("house.toml", &text).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(read, house);
    }
}

#[test]
fn no_thing_is_inside_another() {
    for house in buildings() {
        let (doors, furniture): (Vec<_>, Vec<_>) =
            house.obstacles.iter().partition(|obstacle| leaf(obstacle, 0.0).is_some());
        for (index, piece) in furniture.iter().enumerate() {
            let mut others =
                house.walls.iter().chain(furniture[index + 1..].iter().map(|other| &other.shape));
            assert!(!others.any(|other| other.overlaps(&piece.shape)), "{}: {}", house.name, piece.name);
            for part in 0..=10 {
                let overlaps = |door: &&&ObstacleSpec| {
                    leaf(door, f64::from(part) / 10.0).is_some_and(|leaf| leaf.overlaps(&piece.shape))
                };
                let door = doors.iter().find(overlaps).map(|door| &door.name);
                assert_eq!(door, None, "{}: {}", house.name, piece.name);
            }
        }
    }
}

#[test]
fn houses_have_what_their_ranges_say() {
    let mut robots = [0_usize; 3];
    let (mut rooms, mut doors, mut furniture) = (Vec::new(), 0, 0);
    for house in houses() {
        rooms.push(house.description.split(' ').next().unwrap().parse::<usize>().unwrap());
        for obstacle in &house.obstacles {
            match &obstacle.motion {
                Motion::Door(DoorSpec { opening, .. }) => {
                    doors += 1;
                    let (Opening::Periodic { closed_s, open_s } | Opening::Random { closed_s, open_s }) =
                        opening
                    else {
                        panic!("{opening:?}")
                    };
                    let [closed, open] = [building_ranges::HOUSE.closed_s, building_ranges::HOUSE.open_s];
                    assert!(
                        (closed[0]..=closed[1]).contains(closed_s) && (open[0]..=open[1]).contains(open_s)
                    );
                }
                _ => furniture += 1,
            }
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
    // FNV-1a.
    let hash = |text: &str| {
        text.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
    };
    let line = |name: String| {
        let house = WorldSpec::generated(&name).unwrap();
        let text = worldfile::physics::to_toml(house.fleet()).unwrap();
        format!("{:016x} {}", hash(&text), house.description)
    };
    let names = (0..4).chain([u64::MAX]).map(|seed| format!("house-{seed}"));
    let names = names.chain((0..2).map(|seed| format!("office-{seed}")));
    let lines: Vec<String> = names.map(line).collect();
    insta::assert_snapshot!(lines.join("\n"), @"
    4a6acc224a820235 5 rooms at a corridor, doors: 3, people: 1; made at random from the seed 0.
    623c028a48dfd156 5 rooms at a corridor, doors: 4, people: 2; made at random from the seed 1.
    c7efbdc2bfb7bacb 5 rooms at a corridor, doors: 4, people: 1; made at random from the seed 2.
    b6e9a7065e488320 8 rooms at a corridor, doors: 7, people: 1; made at random from the seed 3.
    d0c92e7d66d505fd 6 rooms at a corridor, doors: 3, people: 1; made at random from the seed 18446744073709551615.
    0179d7028a9bd438 13 rooms at a corridor, doors: 10, people: 5; made at random from the seed 0.
    1a04b80498095062 11 rooms at a corridor, doors: 11, people: 6; made at random from the seed 1.
    ");
}
