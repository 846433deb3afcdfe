//! Robots that are not round, and their contacts.

use super::fleet::{house, robot};
use super::*;
use nalgebra::Point2;

/// A robot of 0.6 × 0.3 m at [3, 3]; its center is 0.1 m behind the center of its outline.
fn long(heading_deg: f64) -> String {
    let outline = "footprint_m = [[-0.2, -0.15], [0.4, -0.15], [0.4, 0.15], [-0.2, 0.15]]\nmass_kg = 5.0";
    robot("long", [3.0, 3.0], heading_deg, "kind = \"driven\"").replace("radius_m = 0.2", outline)
}

fn corners(fleet: &Fleet) -> Vec<Point2<f64>> {
    let robot = fleet.robots().next().unwrap();
    robot.corners.iter().map(|corner| robot.pose * corner).collect()
}

#[test]
fn its_corners_stay_out_of_walls_and_it_says_where_it_touches() {
    for heading_deg in [0.0, 25.0, 180.0, 300.0] {
        let spec = house(&[long(heading_deg)], "");
        let mut fleet = Fleet::new(&spec, 0);
        let mut contacts = Vec::new();
        while fleet.time_s() < 30.0 {
            let turn = libm::sin(fleet.time_s() * 0.7);
            fleet.step(&mut always(0.5, turn));
            contacts.extend_from_slice(fleet.contacts());
            for corner in corners(&fleet) {
                let depth_m = spec.walls.iter().map(|wall| depth_m(wall, &corner)).fold(f64::MIN, f64::max);
                // The maximum was 11 mm when this test was written; for round robots it is less than 1 mm.
                assert!(depth_m < 0.02, "{depth_m} m at {} s", fleet.time_s());
            }
            if let Some(contact) = fleet.contacts().first() {
                let Body::Wall(wall) = contact.with else { panic!("{contact:?}") };
                assert!(spec.walls[wall].distance_m(&contact.at) < 0.01, "{contact:?}");
                assert!(contact.impulse_ns > 0.0 && contact.moving);
            }
        }
        assert!(!contacts.is_empty());
    }
}

/// The depth of a point inside of a box, m.
fn depth_m(shape: &Rectangle, point: &Point2<f64>) -> f64 {
    let local = shape.pose.inverse_transform_point(point);
    (shape.half_m.x - local.x.abs()).min(shape.half_m.y - local.y.abs())
}

#[test]
fn others_see_its_sides_and_truth_knows_its_cells() {
    let other = robot("other", [5.0, 3.0], 180.0, "kind = \"driven\"").replace("noise_std_m = 0.005", "");
    let parked = long(0.0).replace("\"driven\"", "\"standing\"");
    let rooms = &FOUR_ROOMS[..FOUR_ROOMS.find("[[robot]]").unwrap()];
    let mut world = PhysicsWorld::new(&parse(&format!("{rooms}\n{parked}\n{other}")), 0);
    // 90 beams over a full turn: beam 45 looks straight ahead, at the front 0.4 m before its middle.
    let range_m = f64::from(world.sense().scan.ranges_m[45]);
    assert!((range_m - 1.6).abs() < 1e-6, "{range_m}");
    for (x, y, expected) in [
        (2.82, 2.87, TrueState::Blocked),
        (3.38, 3.12, TrueState::Blocked),
        (3.42, 3.0, TrueState::Free),
        (2.78, 3.0, TrueState::Free),
        (3.0, 3.17, TrueState::Free),
    ] {
        assert_eq!(state_at(&world, x, y), expected, "[{x}, {y}]");
    }
}

#[test]
fn it_can_be_set_down_where_it_fits() {
    let mut fleet = Fleet::new(&house(&[long(0.0)], ""), 0);
    // The outer wall ends at 0.1 m.
    let put = |fleet: &mut Fleet, y: f64, heading: f64| fleet.teleport(0, &interfaces::pose(3.0, y, heading));
    assert_eq!(put(&mut fleet, 0.26, 0.0), Ok(()));
    assert!(matches!(put(&mut fleet, 0.26, 1.57), Err(TeleportError::Occupied { .. })));
    assert!(matches!(put(&mut fleet, 0.1, 1.57), Err(TeleportError::Outside { .. })));
}
