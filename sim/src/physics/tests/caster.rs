//! Our rays against rapier's.

use super::oracle::{self, Place, Tally, uniform};
use super::*;
use crate::physics::fleet::corners;
use crate::physics::rays::Scene;
use interfaces::{pose, rotation};
use nalgebra::Point2;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// A cluttered house, turned, with boxes at odd angles and several robots.
fn cluttered() -> WorldSpec {
    let boxes = [(3.3, 4.1, 0.4, 0.7, 33.0), (8.0, 2.0, 1.5, 0.02, -71.0), (9.0, 8.7, 0.3, 0.3, 45.0)];
    let obstacles = boxes.iter().enumerate().map(|(i, (x, y, w, h, turn))| {
        format!("[[obstacle]]\nname = \"b{i}\"\ncenter_m = [{x}, {y}]\nsize_m = [{w}, {h}]\nheading_deg = {turn}\n")
    });
    four_rooms_but(&[("turn_deg = 0.0", "turn_deg = 10.0")], &obstacles.collect::<String>())
}

#[test]
fn a_million_beams_are_where_rapier_has_them() {
    let place = Place::new(cluttered().fleet);
    let laser = place.spec.robots()[0].laser;
    let mut stream = ChaCha8Rng::seed_from_u64(1);
    let mut tally = Tally::default();
    let middle = Point2::new(6.0, 6.0);
    while tally.beams < 1_000_000 {
        let [x, y] = [(); 2].map(|()| uniform(&mut stream, 0.1..11.9));
        let at = middle + rotation(10.0_f64.to_radians()) * (Point2::new(x, y) - middle);
        if place.is_free(&at, 0) {
            let heading = uniform(&mut stream, -4.0..4.0);
            place.compare(&laser, &pose(at.x, at.y, heading), 0, &mut tally);
        }
    }
    // Every grazing beam was looked at above; a change of their number is a change of the rays.
    assert_eq!((tally.beams, tally.grazing), (1_000_080, 19), "of them grazing");
}

/// Houses side by side with many robots: what the cells hide must be hidden.
#[test]
fn in_a_crowd_of_houses_every_beam_is_right() {
    let rooms = &FOUR_ROOMS[FOUR_ROOMS.find("\n[[wall]]\n").unwrap()..FOUR_ROOMS.find("[[robot]]").unwrap()];
    let robot = FOUR_ROOMS[FOUR_ROOMS.find("[[robot]]").unwrap()..].replace("wall_patrol", "standing");
    let robot = &robot[..robot.find("# The dummy").unwrap()];
    let mut text =
        "name = \"houses\"\n[map]\nsize_m = [24.0, 24.0]\ncell_m = 0.1\nturn_deg = 10.0\n".to_owned();
    for (x, y) in [(0.0, 0.0), (12.0, 0.0), (0.0, 12.0), (12.0, 12.0)] {
        let moved = rooms.lines().filter(|line| !line.starts_with('#')).map(|line| {
            let Some((key, pair)) = line.split_once(" = [") else { return format!("{line}\n") };
            let numbers: Vec<f64> =
                pair.split(']').next().unwrap().split(',').map(|n| n.trim().parse().unwrap()).collect();
            format!("{key} = [{}, {}]\n", numbers[0] + x, numbers[1] + y)
        });
        text.extend(moved);
    }
    let mut stream = ChaCha8Rng::seed_from_u64(3);
    for i in 0..64 {
        // On a grid, but none in a wall.
        let at = [i % 8, i / 8].map(|k| 1.5 + 3.0 * f64::from(k) + uniform(&mut stream, -1.0..1.0));
        let robot = robot.replace("curious", &format!("r{i}")).replace("[2.0, 2.0]", &format!("{at:?}"));
        text.push_str(&robot);
    }
    let spec = FleetSpec::parse("houses.toml", &text).unwrap_or_else(|error| panic!("{error}"));
    let place = Place::new(spec);
    let (mut tally, own) = (Tally::default(), 0);
    let laser = LaserSpec { beams: 359, ..place.spec.robots()[0].laser };
    while tally.beams < 150_000 {
        let at = Point2::new(uniform(&mut stream, -1.0..25.0), uniform(&mut stream, -1.0..25.0));
        if place.is_free(&at, own) {
            place.compare(&laser, &pose(at.x, at.y, uniform(&mut stream, -4.0..4.0)), own, &mut tally);
        }
    }
    assert!(tally.grazing < tally.beams / 10_000, "{tally:?}");
}

/// Doors, blocks and boxes on the move, again and again.
#[test]
fn whatever_moves_is_seen_where_it_is() {
    let spec = super::things::busy();
    let mut fleet = Fleet::new(&spec, 5);
    let laser = LaserSpec { beams: 360, noise_std_m: 0.0, ..spec.robots()[0].laser };
    let mut stream = ChaCha8Rng::seed_from_u64(4);
    let mut tally = Tally::default();
    let mut moved = 0;
    for _ in 0..60 {
        fleet.run_until(fleet.time_s() + 0.35, &mut super::things::reckless);
        moved += fleet.moved().len();
        let place = Place::of(fleet.clone());
        let goal = tally.beams + 10_000;
        while tally.beams < goal {
            // Beyond the borders, too.
            let at = Point2::new(uniform(&mut stream, -0.5..12.5), uniform(&mut stream, -0.5..12.5));
            if place.is_free(&at, 0) {
                place.compare(&laser, &pose(at.x, at.y, uniform(&mut stream, -4.0..4.0)), 0, &mut tally);
            }
        }
    }
    assert!(moved > 300, "hardly anything moves: {moved}");
    assert!(tally.grazing < tally.beams / 5_000, "{tally:?}");
}

#[test]
fn narrow_lasers_see_the_same() {
    let place = Place::new(cluttered().fleet);
    let at = place.spec.robots()[0].pose.translation.vector;
    let mut stream = ChaCha8Rng::seed_from_u64(2);
    for _ in 0..300 {
        let mut laser = place.spec.robots()[0].laser;
        laser.fov_rad = uniform(&mut stream, 1.0..360.0).to_radians();
        laser.beams = uniform(&mut stream, 2.0..50.0) as usize;
        laser.range_max_m = 4.0;
        let heading = uniform(&mut stream, -4.0..4.0);
        place.compare(&laser, &pose(at.x, at.y, heading), 0, &mut Tally::default());
    }
}

/// A narrow view with things behind it: what lies there is in none of its beams.
#[test]
fn nothing_is_seen_behind_a_narrow_laser() {
    let place = Place::of(Fleet::new(&super::fleet::crowd(), 0));
    let mut stream = ChaCha8Rng::seed_from_u64(6);
    let mut tally = Tally::default();
    for _ in 0..300 {
        let mut laser = LaserSpec { noise_std_m: 0.0, ..place.spec.robots()[0].laser };
        laser.fov_rad = uniform(&mut stream, 1.0..40.0).to_radians();
        laser.beams = uniform(&mut stream, 2.0..100.0) as usize;
        let own = (uniform(&mut stream, 0.0..36.0) as usize).min(35);
        let at = place.spec.robots()[own].pose.translation.vector;
        place.compare(&laser, &pose(at.x, at.y, uniform(&mut stream, -4.0..4.0)), own, &mut tally);
    }
}

#[test]
fn limits_follow_rep_117() {
    let limits = "range_min_m = 2.0\nrange_max_m = 3.0";
    let spec = four_rooms_but(&[("range_min_m = 0.0 ", ""), ("range_max_m = 10.0", limits)], "");
    let text = spec.driven().laser;
    assert_eq!((text.range_min_m, text.range_max_m), (2.0, 3.0));
    let scan = PhysicsWorld::new(&spec, 0).sense().scan;
    // At [2, 2]: walls 1.9 m to the left and 3.95 m to the right.
    assert_eq!(scan.ranges_m[0], f32::NEG_INFINITY);
    assert_eq!(scan.ranges_m[360], f32::INFINITY);
    assert!((scan.ranges_m[90] - 1.9 * 2.0_f32.sqrt()).abs() < 1e-5);
}

#[test]
fn a_robot_sees_the_other_but_not_itself() {
    let spec = four_rooms_but(&[("pose_m = [2.0, 2.0]", "pose_m = [7.2, 10.5]")], "");
    let mut world = PhysicsWorld::new(&spec, 0);
    let scan = world.sense().scan;
    // The dummy stands 1 m above, and is 0.2 m in radius.
    assert!((scan.ranges_m[540] - 0.8).abs() < 1e-6, "{}", scan.ranges_m[540]);
    assert!(scan.ranges_m.iter().all(|range| *range > 0.5));
    world.act(&Twist::STOP);
    let dummy = world.robots().nth(1).and_then(|robot| robot.reading).map(|reading| &reading.scan);
    let down = dummy.map(|scan| scan.ranges_m[45]).unwrap();
    assert!((down - 0.8).abs() < 1e-6, "{down}");
}

#[test]
fn a_laser_inside_of_a_solid_sees_nothing_else() {
    let mut spec = four_rooms();
    spec.fleet.robots[0].pose = pose(6.0, 1.0, 0.3);
    let mut scene = Scene::new(corners(spec.frame()), spec.walls(), Vec::new(), 0, 10.0);
    scene.sort();
    let scan = oracle::scan(&spec.driven().laser, &spec.driven().pose, &scene, 0);
    assert!(scan.ranges_m.iter().all(|range| *range == 0.0));
}
