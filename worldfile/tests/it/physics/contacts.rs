use super::*;
use nalgebra::Point2;

const AHEAD: Twist = Twist { linear_mps: 9.0, angular_radps: 0.0 };

/// The depth by which the driven robot penetrates a wall, m.
fn depth_m(world: &PhysicsWorld) -> f64 {
    let at = Point2::from(world.true_pose().translation.vector);
    world.spec().driven().radius_m - wall_m(world.spec(), &at)
}

/// The four rooms with each model of contacts.
fn both(heading: &str) -> [WorldSpec; 2] {
    let spec = four_rooms_but(&[("heading_deg = 0.0", &format!("heading_deg = {heading}"))], "");
    [ContactModel::RigidBodies, ContactModel::Sliding].map(|contacts| {
        let fleet = FleetSpec { contacts, ..spec.fleet().clone() };
        WorldSpec::new(fleet).unwrap_or_else(|error| panic!("{error}"))
    })
}

#[test]
fn driving_into_a_wall_is_one_contact_and_no_tunnel() {
    for (heading, spec) in ["0.0", "20.0", "45.0", "200.0", "270.0"]
        .into_iter()
        .flat_map(|heading| both(heading).map(|spec| (heading, spec)))
    {
        let mut world = PhysicsWorld::new(&spec, 0);
        let mut deepest_m = f64::NEG_INFINITY;
        let contacts = drive(&mut world, AHEAD, 12.0, |world| deepest_m = deepest_m.max(depth_m(world)));
        assert!(deepest_m > -0.002, "never reached a wall: {deepest_m} m at heading {heading}");
        assert!(deepest_m < 0.001, "{deepest_m} m deep at heading {heading}");
        // One wall, or two where it slid along the first into the second.
        assert!((1..=2).contains(&contacts.len()), "{contacts:?}");
        assert!(contacts.iter().all(|contact| contact.moving));
        assert!(matches!(contacts[0].with, Body::Wall(_)));
    }
}

#[test]
fn a_contact_counts_again_only_after_parting() {
    for spec in both("180.0") {
        let mut world = PhysicsWorld::new(&spec, 0);
        let first = drive(&mut world, AHEAD, 5.0, |_| ());
        assert_eq!(first.len(), 1);
        assert!(first[0].impulse_ns > 0.0 && first[0].own_speed_mps > 0.0);
        assert_eq!(drive(&mut world, Twist { linear_mps: -0.5, angular_radps: 0.0 }, 1.0, |_| ()), []);
        let second = drive(&mut world, AHEAD, 3.0, |_| ());
        assert_eq!(second.len(), 1);
        assert_eq!(first[0].with, second[0].with);
    }
}

#[test]
fn being_run_into_is_no_collision_of_ones_own() {
    // A dummy robot that sees no farther than its own surface.
    let blind =
        [("range_max_m = 5.0", "range_max_m = 0.15"), ("pose_m = [2.0, 2.0]", "pose_m = [8.5, 11.5]")];
    let mut world = PhysicsWorld::new(&four_rooms_but(&blind, ""), 0);
    let contacts = drive(&mut world, Twist::STOP, 6.0, |world| assert!(bodies_apart_m(world) > -0.001));
    assert!(!contacts.is_empty());
    assert!(contacts.iter().all(|contact| contact.with == Body::Robot(1) && !contact.moving));
}
