//! Generated rooms in a grid: nothing in one place with anything else, every room always open, and things that act as wholes.

use super::standstill::oracle::Positions;
use super::*;
use std::collections::BTreeMap;

/// The number of worlds of each kind in each test.
const WORLDS: u64 = 60;

fn worlds() -> impl Iterator<Item = WorldSpec> {
    let names = ["rooms", "rooms-day"]
        .into_iter()
        .flat_map(|kind| (0..WORLDS).map(move |seed| format!("{kind}-{seed}")));
    names.map(|name| WorldSpec::generated(&name).unwrap())
}

/// For each thing and place, by the index of its first obstacle: the convex hull.
fn hulls(world: &FleetSpec) -> BTreeMap<(usize, usize), Vec<Point2<f64>>> {
    let mut corners: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for (index, obstacle) in world.obstacles.iter().enumerate() {
        if matches!(obstacle.motion, Motion::Scheduled(_)) {
            corners
                .entry((obstacle.thing(index), obstacle.place()))
                .or_default()
                .extend(obstacle.shape.corners());
        }
    }
    corners.into_iter().map(|(key, corners)| (key, convex::hull(corners))).collect()
}

fn doors(world: &FleetSpec) -> impl Iterator<Item = &ObstacleSpec> {
    world.obstacles.iter().filter(|obstacle| matches!(obstacle.motion, Motion::Door(_)))
}

#[test]
fn rooms_have_what_their_ranges_say() {
    let mut kinds: BTreeMap<String, u32> = BTreeMap::new();
    for world in worlds() {
        assert_eq!(super::parse(&worldfile::physics::to_toml(world.fleet()).unwrap()), world);
        let rooms: usize = world.description.split(' ').next().unwrap().parse().unwrap();
        assert!((4..=64).contains(&rooms), "{}: {rooms} rooms", world.name);
        let laser = &world.driven().laser;
        assert!((2.5..=12.0).contains(&laser.range_max_m) && (90..=720).contains(&laser.beams), "{laser:?}");
        let longest_s = if world.name.contains("day") { 43_200.0 } else { 1800.0 };
        let things = world.things();
        let of_rooms = (0.6 * rooms as f64).max(1.0) * 3.0;
        assert!((1..=of_rooms as usize).contains(&(things.len() - doors(&world).count())), "{}", world.name);
        for thing in &things {
            let [away_s, there_s] = thing.mean_stays_s(&world, 0.0).unwrap();
            assert!((10.0..=longest_s).contains(&there_s), "{}: {}", world.name, thing.name);
            assert!((10.0..=longest_s).contains(&away_s) || away_s == 1e9, "{}: {}", world.name, thing.name);
            assert!(thing.places.len() <= 3);
            // A chair, for example, has cells in each of its places; a door that slid into its wall has none.
            let is_door = thing.name.starts_with("door");
            assert!(
                is_door || thing.places.iter().all(|cells| !cells.is_empty()),
                "{}: {thing:?}",
                world.name
            );
            let number = thing.name.rfind(' ').unwrap();
            *kinds.entry(thing.name[..number].to_owned()).or_default() += 1;
            *kinds.entry(format!("{} places", if is_door { 0 } else { thing.places.len() })).or_default() +=
                1;
            *kinds.entry("for good".into()).or_default() += u32::from(away_s == 1e9);
        }
        let later_s = 3.0 * longest_s;
        let changes =
            things.iter().any(|thing| thing.mean_stays_s(&world, 0.0) != thing.mean_stays_s(&world, later_s));
        *kinds.entry("worlds that change".into()).or_default() += u32::from(changes);
        *kinds.entry("worlds with doors".into()).or_default() += u32::from(doors(&world).next().is_some());
        assert_eq!(changes, world.description.contains("rates change"), "{}", world.name);
    }
    insta::assert_debug_snapshot!(kinds);
}

/// With all things in all of their places, and the doors closed.
#[test]
fn nothing_closes_a_room_or_is_in_the_place_of_another_thing() {
    for world in worlds() {
        let hulls: Vec<_> = hulls(&world).into_values().collect();
        let walls: Vec<_> = world.walls.iter().map(|wall| wall.corners().to_vec()).collect();
        for (index, hull) in hulls.iter().enumerate() {
            let nearest_m =
                hulls[index + 1..].iter().map(|other| convex::gap_m(hull, other)).fold(9.0, f64::min);
            assert!(nearest_m > 0.599, "{}: {nearest_m} m apart", world.name);
            assert!(walls.iter().all(|wall| convex::gap_m(hull, wall) > -shape::TOUCH_M), "{}", world.name);
        }
        let high = Point2::new(world.frame.width() as f64, world.frame.height() as f64) * 0.05;
        let solids = walls.into_iter().chain(hulls).map(Form::Convex);
        let closed = doors(&world).map(|door| Form::Convex(door.shape.corners().to_vec()));
        let solids: Vec<Form> = solids.chain(closed).collect();
        // The robot, with a margin.
        let parts = Positions::new([Point2::origin(), high], solids, 0.25).parts();
        assert_eq!(parts.len(), 1, "{}", world.name);
    }
}

/// While the robot rests where it starts. The truth of the cells is computed from bodies that come and go one by one.
#[test]
fn things_come_and_go_as_wholes_and_as_often_as_their_rates_say() {
    let (mut z, mut moves) = (Vec::new(), 0);
    for seed in 0..3 {
        let spec = WorldSpec::generated(&format!("rooms-{seed}")).unwrap();
        let things: Vec<Thing> =
            spec.things().into_iter().filter(|thing| !thing.name.starts_with("door")).collect();
        let mut world = PhysicsWorld::new(&spec, seed);
        let mut there = vec![0.0; things.len()];
        let mut places = vec![[0; 3]; things.len()];
        const MINUTES: usize = 600;
        for minute in 1..=MINUTES {
            world.rest(60.0 * minute as f64);
            if minute == MINUTES / 2 {
                // Goes on in another world of the same spec.
                let snapshot = world.snapshot().into_bytes();
                world = PhysicsWorld::new(&spec, seed + 1);
                world.restore(&snapshot).unwrap();
            }
            for (number, thing) in things.iter().enumerate() {
                let place = world.fleet().place_of(thing);
                for (index, cells) in thing.places.iter().enumerate() {
                    let is_here = place == Some(index);
                    let is = |cell: &usize| (world.truth().state(*cell) != TrueState::Free) == is_here;
                    assert!(cells.iter().all(is), "{}: {} at {place:?}", spec.name, thing.name);
                }
                there[number] += f64::from(u8::from(place.is_some()));
                place.into_iter().for_each(|place| places[number][place] += 1);
            }
        }
        for ((thing, there), places) in things.iter().zip(&there).zip(places) {
            let is_steady = thing.mean_stays_s(&spec, 0.0) == thing.mean_stays_s(&spec, 36_000.0);
            let [away_s, there_s] = thing.mean_stays_s(&spec, 0.0).unwrap();
            moves += usize::from(thing.places.len() > 1 && there_s < 600.0);
            let visited = places.iter().filter(|visits| **visits > 0).count();
            assert!(there_s >= 600.0 || away_s == 1e9 || visited == thing.places.len(), "{places:?}");
            if is_steady && away_s < 1e9 {
                // Of a two-state chain that is seen for a time T, the share of time there varies by 2 p q τ / T, τ = 1 / (α + β).
                let (p, tau_s) = (there_s / (away_s + there_s), away_s * there_s / (away_s + there_s));
                let variance = p * (1.0 - p) * (2.0 * tau_s / (60.0 * MINUTES as f64) + 1.0 / MINUTES as f64);
                z.push((there / MINUTES as f64 - p) / variance.sqrt());
            }
        }
    }
    assert!(moves > 3 && z.len() > 20, "{moves} {}", z.len());
    let square = z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64;
    assert!((0.4..1.8).contains(&square), "{square}");
}

/// A robot in the notch of an L, or between the places of the legs of a chair, keeps all of the thing away.
#[test]
fn a_thing_waits_as_a_whole() {
    let leg = |name: &str, x: f64, more: &str| {
        format!(
            "[[obstacle]]\nname = \"{name}\"\nmin_m = [{x:?}, 2.0]\nmax_m = [{:?}, 2.05]\n{more}\n",
            x + 0.05
        )
    };
    let schedule = "schedule = { free_s = 1.0, blocked_s = 1e9, starts_blocked = false }";
    let things = leg("chair", 2.0, schedule)
        + &leg("leg", 3.0, "part_of = \"chair\"")
        + &leg("elsewhere", 4.5, "part_of = \"chair\"\nplace = 2");
    let robot = super::fleet::robot("r", [2.5, 2.0], 0.0, super::fleet::DRIVEN);
    let mut fleet = Fleet::new(&super::fleet::house(&[robot], &things), 0);
    let place = |fleet: &Fleet| fleet.place_of(&fleet.spec().things()[0]);
    assert_eq!(fleet.spec().obstacles[0].part, Some(ThingPart { thing: 0, place: 0, places: 2 }));
    // It comes to its second place first.
    fleet.run_until(60.0, &mut ());
    assert_eq!((place(&fleet), fleet.obstacles().count()), (Some(1), 1));
    let alone = things.replace("place = 2", "");
    let robot = super::fleet::robot("r", [2.5, 2.0], 0.0, super::fleet::DRIVEN);
    let mut fleet = Fleet::new(&super::fleet::house(&[robot], &alone), 0);
    fleet.run_until(60.0, &mut ());
    assert_eq!((place(&fleet), fleet.obstacles().count()), (None, 0));
    fleet.run_until(70.0, &mut always(0.0, 0.0));
    fleet.run_until(76.0, &mut |_: &RobotView<'_>, reading: &LaserReading| {
        let turned = interfaces::heading_rad(&reading.pose) > 1.5;
        Twist { linear_mps: if turned { 0.4 } else { 0.0 }, angular_radps: if turned { 0.0 } else { 1.0 } }
    });
    assert_eq!((place(&fleet), fleet.obstacles().count()), (Some(0), 3));
}
