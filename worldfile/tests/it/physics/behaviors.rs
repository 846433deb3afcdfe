//! What the behaviors do: wander, circle, waypoints.

use super::fleet::{STANDING, at, house, nobody, pose, robot};
use super::*;

#[test]
fn alone_a_wanderer_never_touches_anything() {
    let wander = "kind = \"wander\"\nspeed_mps = 0.5\nclearance_m = 0.2";
    let mut fleet = Fleet::new(&house(&[robot("one", [2.0, 2.0], 0.0, wander)], ""), 5);
    let mut rooms = [false; 4];
    for _ in 0..20 * 600 {
        fleet.step(&mut nobody);
        assert_eq!(fleet.contacts(), []);
        let at = at(&fleet, 0);
        rooms[usize::from(at.x > 6.0) + 2 * usize::from(at.y > 6.0)] = true;
    }
    assert!(rooms.iter().filter(|&&was_there| was_there).count() > 1, "it never left its room");
}

#[test]
fn a_circle_is_driven_and_standing_is_not_moving() {
    let circle = "kind = \"circle\"\nspeed_mps = 0.4\nturn_radius_m = 1.0\ndirection = \"right\"";
    let robots = [robot("one", [3.0, 3.0], 90.0, circle), robot("two", [9.0, 9.0], 0.0, STANDING)];
    let mut fleet = Fleet::new(&house(&robots, ""), 0);
    let stands = pose(&fleet, 1);
    fleet.run_until(2.0, &mut nobody);
    let middle = pose(&fleet, 0) * Point2::new(0.0, -1.0);
    for _ in 0..400 {
        fleet.step(&mut nobody);
        assert!(((at(&fleet, 0) - middle).norm() - 1.0).abs() < 1e-3);
        assert_eq!(pose(&fleet, 1), stands);
    }
}

/// The points of a path that the robot came near to, in order.
fn visits(fleet: &mut Fleet, points: &[[f64; 2]], seconds: f64) -> Vec<usize> {
    let mut visits = Vec::new();
    let end_s = fleet.time_s() + seconds;
    while fleet.time_s() < end_s {
        fleet.step(&mut nobody);
        let near = |point: &[f64; 2]| (at(fleet, 0) - Point2::from(*point)).norm() < 0.03;
        visits.extend(points.iter().position(near));
    }
    visits.dedup();
    visits
}

#[test]
fn waypoints_are_visited_in_order() {
    let points = [[3.0, 1.0], [3.0, 8.0], [1.0, 8.0]];
    for (repeat, expected) in [
        ("loop", &[0, 1, 2, 1, 0][..3]),
        ("back_and_forth", &[0, 1, 2, 1, 0, 1, 2, 1, 0]),
        ("once", &[0, 1, 2]),
    ] {
        // A loop back to the first point would lead through a wall.
        let points = if repeat == "loop" { [[3.0, 1.0], [4.5, 4.5], [1.0, 4.0]] } else { points };
        let way =
            format!("kind = \"waypoints\"\npoints_m = {points:?}\nspeed_mps = 0.5\nrepeat = \"{repeat}\"");
        let mut fleet = Fleet::new(&house(&[robot("one", [1.0, 1.0], 90.0, &way)], ""), 0);
        let visits = visits(&mut fleet, &points, 120.0);
        assert!(visits.starts_with(expected), "{repeat}: {visits:?}");
        match repeat {
            "loop" => {
                assert!(visits.len() > 8 && visits.windows(2).all(|w| w[1] == (w[0] + 1) % 3), "{visits:?}")
            }
            "once" => assert_eq!(visits, expected),
            _ => assert!(visits.len() > 8, "{visits:?}"),
        }
        assert_eq!(fleet.contacts(), []);
    }
}

#[test]
fn on_its_way_to_a_waypoint_a_robot_waits_for_what_is_in_its_way() {
    let way = "kind = \"waypoints\"\npoints_m = [[4.5, 1.0]]\nspeed_mps = 0.5\nrepeat = \"once\"";
    let toy = "[[obstacle]]\nname = \"toy\"\nmin_m = [3.0, 0.9]\nmax_m = [3.2, 1.1]\nappears_s = 0.5\ndisappears_s = 8.0\n";
    let mut fleet = Fleet::new(&house(&[robot("one", [1.0, 1.0], 0.0, way)], toy), 0);
    fleet.run_until(7.5, &mut nobody);
    let waits_at = at(&fleet, 0);
    assert!((2.3..2.8).contains(&waits_at.x), "{waits_at}");
    fleet.run_until(25.0, &mut nobody);
    assert!((at(&fleet, 0).x - 4.5).abs() < 0.03);
    assert_eq!(fleet.contacts(), []);
}

#[test]
fn a_robot_that_waited_for_long_visits_its_waypoints_in_reverse_order_or_goes_round() {
    // From the third point on, something stands between the second and the third point.
    let toy = "[[obstacle]]\nname = \"toy\"\nmin_m = [4.4, 2.4]\nmax_m = [4.6, 2.6]\nappears_s = 16.0\n";
    let points = [[1.0, 1.0], [4.5, 1.0], [4.5, 4.5], [1.0, 4.5]];
    let way = format!("kind = \"waypoints\"\npoints_m = {points:?}\nspeed_mps = 0.5");
    let mut fleet = Fleet::new(&house(&[robot("one", points[0], 0.0, &way)], toy), 0);
    let seen = visits(&mut fleet, &points, 150.0);
    assert!(seen.starts_with(&[0, 1, 2, 3, 0, 1, 0, 3, 2, 3, 0, 1]), "{seen:?}");
    assert_eq!(fleet.contacts(), []);
    // The only point is behind the toy.
    let way = "kind = \"waypoints\"\npoints_m = [[4.5, 4.5]]\nspeed_mps = 0.5\nrepeat = \"once\"";
    let mut fleet = Fleet::new(&house(&[robot("one", points[1], 90.0, way)], &toy.replace("16.0", "0.1")), 0);
    let seen = visits(&mut fleet, &[[4.5, 4.5]], 300.0);
    assert_eq!(seen, [0]);
    assert_eq!(fleet.contacts(), []);
}

/// A wall ahead, and one beside the robot: the robot turns to the open side, also if a part of the beams is lost.
#[test]
fn a_wanderer_turns_to_the_open_side_although_beams_are_lost() {
    let ahead = wall([2.5, 2.0], [2.6, 4.0]);
    for (is_left_open, beside) in [(true, [2.4, 2.6]), (false, [3.4, 3.6])] {
        let walls = ahead.clone() + &wall([0.5, beside[0]], [2.5, beside[1]]);
        for dropout in ["0.0", "0.1", "0.3"] {
            let wander = robot("one", [1.5, 3.0], 0.0, "kind = \"wander\"\nspeed_mps = 0.4");
            let wander = wander.replace("beams = 90", &format!("beams = 90\ndropout = {dropout}"));
            let spec = house(&[wander], &walls);
            let turns_left = |seed: &u64| {
                let mut fleet = Fleet::new(&spec, *seed);
                for step in 1..200 {
                    let before = pose(&fleet, 0);
                    fleet.run_until(0.1 * f64::from(step), &mut nobody);
                    let turned_rad = before.rotation.rotation_to(&pose(&fleet, 0).rotation).angle();
                    if turned_rad.abs() > 0.05 {
                        return turned_rad > 0.0;
                    }
                }
                panic!("the robot never turned");
            };
            let left = (0..20).filter(turns_left).count();
            let open = if is_left_open { left } else { 20 - left };
            assert!(open >= 15, "{open} of 20 with dropout {dropout}, left open: {is_left_open}");
        }
    }
}

/// Nearer than the minimum range, a laser measures −∞: something is there, but not where. On short legs, this can be a body as
/// well as a wall.
#[test]
fn what_is_too_close_to_be_measured_is_in_the_way() {
    let legs_m: Vec<[f64; 2]> = (1..24).map(|leg| [1.0 + 0.15 * f64::from(leg), 3.0]).collect();
    let ways = [
        "kind = \"waypoints\"\npoints_m = [[4.5, 3.0], [1.0, 3.0]]",
        "kind = \"wander\"",
        &format!("kind = \"waypoints\"\npoints_m = {legs_m:?}\nclearance_m = 0.15"),
    ];
    for (way, range_min_m) in
        ways.iter().flat_map(|way| [0.0, 0.3, 0.45, 0.6].map(|range_min_m| (way, range_min_m)))
    {
        let driver = robot("driver", [1.0, 3.0], 0.0, &format!("{way}\nspeed_mps = 0.3"));
        let driver = driver.replace("beams = 90", &format!("beams = 180\nrange_min_m = {range_min_m:?}"));
        let spec = house(&[driver, robot("stands", [3.0, 3.0], 0.0, STANDING)], "");
        let mut fleet = Fleet::new(&spec, 1);
        for step in 1..1200 {
            if step % 20 == 0 {
                // What was measured before is in the snapshot.
                fleet = Fleet::restored(&spec, &fleet.snapshot()).unwrap();
            }
            fleet.run_until(0.05 * f64::from(step), &mut nobody);
            assert_eq!(fleet.contacts(), [], "{way}, {range_min_m} m, at {} s", fleet.time_s());
        }
    }
}

/// Walls beside the way are nearer than the minimum range, and are not in the way.
#[test]
fn a_corridor_that_is_too_close_to_be_measured_is_driven_through() {
    let walls = [2.6, 3.3].map(|low_m| wall([1.5, low_m], [3.5, low_m + 0.1])).concat();
    let way = "kind = \"waypoints\"\npoints_m = [[4.5, 3.0]]\nspeed_mps = 0.4\nrepeat = \"once\"";
    let driver = robot("driver", [1.0, 3.0], 0.0, way);
    let driver = driver.replace("beams = 90", "beams = 360\nrange_min_m = 0.5");
    let mut fleet = Fleet::new(&house(&[driver], &walls), 1);
    fleet.run_until(15.0, &mut nobody);
    assert!((at(&fleet, 0).x - 4.5).abs() < 0.03, "{}", at(&fleet, 0));
}

/// The wall behind the end of a way is nearer than the minimum range, and is not in the way; nor if the laser is noisy, or if the
/// robot starts where it does not measure the wall.
#[test]
fn a_way_may_end_before_a_wall_that_is_too_close_to_be_measured() {
    let waypoints = "kind = \"waypoints\"\npoints_m = [[4.5, 0.5], [1.0, 0.5]]";
    let patrol = "kind = \"wall_patrol\"\nfrom_m = [1.0, 0.5]\nto_m = [4.5, 0.5]\nwall_side = \"right\"";
    let close = &patrol.replace("4.5", "4.54");
    for (way, start_m, mount_m, range_min_m, noise_m) in [
        (waypoints, 1.0, 0.0, 0.4, 0.005),
        (waypoints, 1.0, 0.2, 0.12, 0.005),
        (waypoints, 1.0, 0.2, 0.15, 0.005),
        (patrol, 1.0, 0.0, 0.4, 0.005),
        (patrol, 1.0, 0.2, 0.12, 0.005),
        (patrol, 1.0, 0.2, 0.15, 0.005),
        (close, 1.0, 0.0, 0.45, 0.0),
        (close, 1.0, 0.0, 0.45, 0.02),
        (close, 4.44, 0.0, 0.45, 0.0),
    ] {
        let driver = robot("driver", [start_m, 0.5], 0.0, &format!("{way}\nspeed_mps = 0.4"));
        let laser = format!("beams = 360\nrange_min_m = {range_min_m:?}\nmount_m = [{mount_m:?}, 0.0]");
        let driver = driver.replace("beams = 90", &laser);
        let driver = driver.replace("noise_std_m = 0.005", &format!("noise_std_m = {noise_m:?}"));
        let mut fleet = Fleet::new(&house(&[driver], &wall([4.8, 0.2], [4.9, 2.0])), 1);
        let end_m = if way == close { 4.54 } else { 4.5 };
        let visits = visits(&mut fleet, &[[1.0, 0.5], [end_m, 0.5]], 300.0);
        assert!(
            visits.len() > 20,
            "{way} from {start_m} m, {mount_m} m, {range_min_m} m, {noise_m} m: {visits:?}"
        );
    }
}
