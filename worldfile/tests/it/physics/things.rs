//! Boxes that are pushed, blocks on their paths, doors.

use super::fleet::{DRIVEN, at, house, robot};
use super::*;

/// A heavy robot at [1, 2] that drives straight along x, and obstacles.
fn yard(things: &str) -> Fleet {
    yard_from([1.0, 2.0], things)
}

/// The same, with another start of the robot.
fn yard_from(start: [f64; 2], things: &str) -> Fleet {
    let driver = robot("driver", start, 0.0, DRIVEN).replace("radius_m", "mass_kg = 20.0\nradius_m");
    Fleet::new(&house(&[driver], things), 0)
}

pub(super) fn pushed(name: &str, center_m: [f64; 2], mass_kg: f64, friction: f64) -> String {
    format!(
        "[[obstacle]]\nname = \"{name}\"\nkind = \"box\"\ncenter_m = {center_m:?}\nsize_m = [0.3, 0.3]\nmass_kg = {mass_kg:?}\nfriction = {friction:?}\n"
    )
}

fn middle(fleet: &Fleet, thing: usize) -> Point2<f64> {
    let corners = fleet.obstacles().nth(thing).unwrap().corners;
    nalgebra::center(&corners[0], &corners[2])
}

#[test]
fn a_light_box_is_pushed_and_a_heavy_one_is_not() {
    // The driver can push with 20 kg · 1 m/s²; the boxes rub with 0.5 · 9.81 m/s² · their mass. What
    // they are hit with at 0.5 m/s moves the second one 0.06 m.
    for (mass_kg, goes_m) in [(1.0, 1.0..2.0), (10.0, 0.04..0.07), (100.0, 0.0..0.003)] {
        let mut fleet = yard(&pushed("crate", [1.8, 2.0], mass_kg, 0.5));
        fleet.run_until(4.0, &mut always(0.5, 0.0));
        let gone_m = middle(&fleet, 0).x - 1.8;
        assert!(goes_m.contains(&gone_m), "{mass_kg} kg: {gone_m} m");
        let robot = fleet.robots().next().unwrap();
        assert_eq!(robot.twist.linear_mps > 0.4, mass_kg < 5.0, "{mass_kg} kg: {:?}", robot.twist);
        // In contact, without penetration.
        let gap_m = middle(&fleet, 0).x - 0.15 - robot.pose.translation.x - 0.2;
        assert!(gap_m.abs() < 0.003, "{mass_kg} kg: {gap_m} m");
    }
}

#[test]
fn a_light_box_holds_a_heavy_robot_where_something_holds_the_box() {
    // A wall begins at x = 5.95; between it and a robot of 20 kg is a box.
    for (side_m, mass_kg) in [([0.3, 0.3], 0.02), ([0.3, 0.05], 0.02), ([0.3, 0.3], 1.0)] {
        let box_ = pushed("crate", [5.7, 2.05], mass_kg, 0.2)
            .replace("[0.3, 0.3]", &format!("{side_m:?}"))
            .replace("mass_kg", "heading_deg = 20.0\nmass_kg");
        let mut fleet = yard(&box_);
        let mut deepest_m = f64::NEG_INFINITY;
        while fleet.time_s() < 15.0 {
            fleet.step(&mut always(0.5, 0.0));
            let corners = fleet.obstacles().next().unwrap().corners;
            let at = at(&fleet, 0);
            deepest_m = deepest_m.max(-convex::disc_gap_m(&corners, &at, 0.2)).max(at.x + 0.2 - 5.95);
        }
        assert!(deepest_m > -0.002, "{mass_kg} kg: they never met: {deepest_m} m");
        assert!(deepest_m < 0.0051, "{mass_kg} kg: {deepest_m} m");
        // The robot can drive away again.
        let met = at(&fleet, 0);
        fleet.run_until(18.0, &mut always(-0.5, 0.0));
        assert!((met - at(&fleet, 0)).norm() > 1.0, "{mass_kg} kg: stuck at {met}");
    }
}

#[test]
fn a_box_slows_down_by_its_friction() {
    for friction in [0.03, 0.08] {
        let mut fleet = yard(&pushed("puck", [1.8, 2.0], 0.5, friction));
        fleet.run_until(2.0, &mut always(0.5, 0.0));
        let from = middle(&fleet, 0).x;
        fleet.run_until(5.0, &mut always(0.0, 0.0));
        // v²/2µg, from 0.5 m/s.
        let glides_m = 0.25 / (2.0 * friction * 9.80665);
        let gone_m = middle(&fleet, 0).x - from;
        assert!((gone_m - glides_m).abs() < 0.06 * glides_m + 0.013, "{gone_m} m, not {glides_m} m");
    }
}

fn block(keys: &str) -> String {
    format!("[[obstacle]]\nname = \"block\"\nkind = \"block\"\nsize_m = [0.4, 0.4]\n{keys}\n")
}

/// The positions of the block at some times, s.
fn places(keys: &str, times_s: &[f64]) -> Vec<[f64; 2]> {
    let mut fleet = yard(&block(keys));
    let mut place = |time_s: &f64| {
        fleet.run_until(*time_s, &mut ());
        middle(&fleet, 0).coords.map(|x| (x * 1e6).round() / 1e6).into()
    };
    times_s.iter().map(&mut place).collect()
}

#[test]
fn blocks_keep_their_schedule() {
    let dwelling = "path_m = [[3.0, 3.0], [4.0, 3.0]]\ndwell_s = 2.0\nspeed_mps = 0.5";
    // Two seconds here, two seconds of motion, two seconds there, two seconds back.
    let expected = [[3.0, 3.0], [3.5, 3.0], [4.0, 3.0], [3.5, 3.0], [3.0, 3.0], [3.5, 3.0]];
    for repeat in ["", "repeat = \"back_and_forth\""] {
        assert_eq!(places(&format!("{dwelling}\n{repeat}"), &[2.0, 3.0, 5.0, 7.0, 9.0, 11.0]), expected);
    }
    let once = format!("{dwelling}\nrepeat = \"once\"");
    assert_eq!(places(&once, &[3.0, 7.0, 100.0]), [[3.5, 3.0], [4.0, 3.0], [4.0, 3.0]]);
    let timed = "path_m = [[3.0, 3.0], [3.0, 4.0], [3.0, 4.0], [3.0, 3.0]]\ntimes_s = [0.0, 1.0, 5.0, 7.0]";
    assert_eq!(
        places(timed, &[0.5, 3.0, 6.0, 7.5, 14.5]),
        [[3.0, 3.5], [3.0, 4.0], [3.0, 3.5], [3.0, 3.5], [3.0, 3.5]]
    );
}

#[test]
fn a_block_waits_for_a_robot_and_is_later_then() {
    let mut fleet = yard(&block("path_m = [[1.0, 3.5], [1.0, 0.6]]\nspeed_mps = 1.0\nrepeat = \"once\""));
    fleet.run_until(5.0, &mut always(0.0, 0.0));
    let gap_m = middle(&fleet, 0).y - 0.2 - 2.2;
    assert!((0.0..0.06).contains(&gap_m), "{gap_m}");
    assert!((at(&fleet, 0) - Point2::new(1.0, 2.0)).norm() < 1e-6);
    fleet.run_until(7.0, &mut always(0.5, 0.0));
    fleet.run_until(12.0, &mut always(0.0, 0.0));
    assert!((middle(&fleet, 0) - Point2::new(1.0, 0.6)).norm() < 1e-6);
}

fn door(kind: &str, keys: &str) -> String {
    format!(
        "[[obstacle]]\nname = \"door\"\nkind = \"{kind}\"\nfrom_m = [3.0, 1.0]\nto_m = [3.0, 2.0]\nthickness_m = 0.04\n{keys}\n"
    )
}

#[test]
fn doors_turn_and_slide_by_their_script() {
    let script = "opening = \"scripted\"\nswitches_s = [1.0, 5.0]\nmove_s = 2.0";
    let aside_m = 0.5 * 0.5_f64.sqrt();
    for (kind, more, half_way, open) in [
        ("hinged_door", "", [3.0 - aside_m, 1.0 + aside_m], [2.5, 1.0]),
        ("hinged_door", "open_deg = -90.0", [3.0 + aside_m, 1.0 + aside_m], [3.5, 1.0]),
        ("sliding_door", "", [3.0, 1.0], [3.0, 0.5]),
        ("sliding_door", "slide_m = -0.6", [3.0, 1.8], [3.0, 2.1]),
    ] {
        let mut fleet = yard(&door(kind, &format!("{script}\n{more}")));
        for (time_s, expected) in
            [(1.0, [3.0, 1.5]), (2.0, half_way), (4.0, open), (6.0, half_way), (9.0, [3.0, 1.5])]
        {
            fleet.run_until(time_s, &mut always(0.0, 0.0));
            let off_m = (middle(&fleet, 0) - Point2::from(expected)).norm();
            assert!(off_m < 1e-6, "{kind} {more} at {time_s} s: {off_m} m off");
        }
    }
}

#[test]
fn a_door_never_closes_on_a_robot() {
    let script = "opening = \"scripted\"\nswitches_s = [8.0]\nstarts_open = true";
    for kind in ["hinged_door", "sliding_door"] {
        // The doorway is ahead of the robot.
        let mut fleet = yard_from([1.0, 1.5], &door(kind, script));
        // It stops in the doorway.
        let mut into = |_: &RobotView<'_>, reading: &LaserReading| Twist {
            linear_mps: if reading.pose.translation.x < 2.9 { 0.5 } else { 0.0 },
            angular_radps: 0.0,
        };
        fleet.run_until(7.9, &mut into);
        let before = at(&fleet, 0);
        fleet.run_until(20.0, &mut always(0.0, 0.0));
        assert_eq!(at(&fleet, 0), before, "{kind}");
        assert_eq!(fleet.contacts(), []);
        fleet.run_until(30.0, &mut always(0.5, 0.0));
        assert!((middle(&fleet, 0) - Point2::new(3.0, 1.5)).norm() < 1e-9, "{kind} is still open");
    }
}

#[test]
fn a_door_that_cannot_move_moves_back_and_tries_again() {
    // The robot stands where the leaf wants to be when the door is closed, or when it is open.
    for (starts_open, stands) in [(true, [2.9, 1.7]), (false, [2.4, 1.3])] {
        let script = format!("opening = \"scripted\"\nswitches_s = [2.0]\nstarts_open = {starts_open}");
        let mut fleet = yard_from(stands, &door("hinged_door", &script));
        let start = middle(&fleet, 0);
        // Moves for less than a second, waits for 2 s, moves back, and stays for 5 s.
        let is_back = |fleet: &Fleet| (middle(fleet, 0) - start).norm() < 1e-9;
        for (time_s, back) in
            [(1.9, true), (3.5, false), (6.0, true), (9.0, true), (11.5, false), (14.0, true)]
        {
            fleet.run_until(time_s, &mut always(0.0, 0.0));
            assert_eq!(is_back(&fleet), back, "starts open: {starts_open}, {time_s} s");
        }
        assert_eq!(fleet.contacts(), []);
        fleet.run_until(18.0, &mut always(-0.5, 0.0));
        fleet.run_until(35.0, &mut always(0.0, 0.0));
        let end = if starts_open { [3.0, 1.5] } else { [2.5, 1.0] };
        assert!((middle(&fleet, 0) - Point2::from(end)).norm() < 1e-6, "starts open: {starts_open}");
    }
}

#[test]
fn random_doors_have_their_means_and_their_seed() {
    let keys = "opening = \"random\"\nclosed_s = 6.0\nopen_s = 2.0\nmove_s = 0.1\nslide_m = 0.2";
    let spec = yard(&door("sliding_door", keys)).spec().clone();
    let run = |seed: u64| {
        let mut fleet = Fleet::new(&spec, seed);
        let (mut switches, mut open_s, mut was_open) = (0, 0.0_f64, false);
        while fleet.time_s() < 4000.0 {
            fleet.step(&mut always(0.0, 0.0));
            let is_open = middle(&fleet, 0).y < 1.4;
            open_s += if is_open { 0.05 } else { 0.0 };
            switches += u32::from(is_open && !was_open);
            was_open = is_open;
        }
        (switches, open_s)
    };
    let (switches, open_s) = run(1);
    // 500 cycles of 8 s; the standard deviations are those of sums of exponential times. Stays that are shorter
    // than the duration of a move are not visible.
    assert!((400..560).contains(&switches), "{switches}");
    assert!(f64::abs(open_s - 1000.0) < 4.0 * 75.0, "{open_s}");
    assert_eq!(run(1), (switches, open_s));
    assert_ne!(run(2).1, open_s);
}

#[test]
fn what_moves_is_truth_and_contact() {
    let things = pushed("crate", [2.0, 2.0], 0.02, 0.1);
    let spec = four_rooms_but(&[("pose_m = [2.0, 2.0]", "pose_m = [1.0, 2.0]")], &things);
    let mut world = PhysicsWorld::new(&spec, 0);
    let state = |world: &PhysicsWorld, x: f64| state_at(world, x, 2.01);
    assert_eq!((state(&world, 2.01), state(&world, 2.51)), (TrueState::Blocked, TrueState::Free));
    let contacts = drive(&mut world, Twist { linear_mps: 0.4, angular_radps: 0.0 }, 4.5, |_| ());
    assert!(contacts.iter().any(|contact| contact.with == Body::Obstacle(0)), "{contacts:?}");
    let is_crate = |index: &usize| world.truth().mover(*index) == Some(Body::Obstacle(0));
    let cells = (0..spec.frame.len()).filter(is_crate).count();
    // It has swept more than its own 7 × 7 cells.
    assert!(cells > 60, "{cells}");
    assert_eq!(state(&world, 1.86), TrueState::Free);
}
