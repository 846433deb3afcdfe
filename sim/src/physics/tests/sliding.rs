//! Both models of contacts.

use super::*;
use interfaces::{Purpose, RandomStream, Twist};
use nalgebra::{Point2, Vector2};

/// Four rooms, turned, with boxes at odd angles; the other robot is far away.
fn hall(contacts: ContactModel) -> FleetSpec {
    let mut spec = four_rooms();
    let block = |x: f64, y: f64, heading_deg: f64| {
        let shape = Rectangle::around(Point2::new(x, y), Vector2::new(0.5, 0.3), heading_deg.to_radians());
        ObstacleSpec::new(&format!("block {x}"), shape, Motion::Fixed)
    };
    spec.obstacles.extend([block(1.5, 3.5, 20.0), block(3.5, 1.5, 45.0), block(4.6, 4.4, 80.0)]);
    spec.turn(0.3, &Point2::new(6.0, 6.0));
    spec.contacts = contacts;
    spec
}

#[test]
fn one_step_ends_where_a_step_of_rigid_bodies_ends() {
    let [mut sliding, mut rigid] =
        [ContactModel::Sliding, ContactModel::RigidBodies].map(|contacts| Fleet::new(&hall(contacts), 1));
    let poses = FreePoses::reachable(sliding.spec(), 0).unwrap();
    let mut random = RandomStream::new(5, Purpose::Task);
    let (mut held, mut most_m) = (0, 0.0_f64);
    for _ in 0..3000 {
        let Some(pose) = sliding.draw_pose(&poses, 0, &mut random) else { continue };
        let twist = Twist { linear_mps: random.uniform(-0.5..0.5), angular_radps: random.uniform(-1.0..1.0) };
        for fleet in [&mut sliding, &mut rigid] {
            fleet.teleport(0, &pose).unwrap();
            fleet.command(0, twist);
        }
        // Until something is met, or for two seconds.
        for _ in 0..40 {
            sliding.step(&mut ());
            rigid.step(&mut ());
            let [slid, solved] = [&sliding, &rigid].map(|fleet| fleet.robot(0).unwrap());
            let apart_m = (slid.pose.translation.vector - solved.pose.translation.vector).norm();
            if slid.is_stalled || solved.is_stalled {
                held += 1;
                most_m = most_m.max(apart_m);
                break;
            }
            // Without contacts, both move in the same way.
            let turned_rad = slid.pose.rotation.angle_to(&solved.pose.rotation).abs();
            assert!(apart_m < 1e-5 && turned_rad < 1e-5, "{apart_m} m, {turned_rad} rad");
        }
    }
    assert!(held > 200, "{held}");
    assert!(most_m < 0.002, "{most_m} m in a step with a contact");
}
