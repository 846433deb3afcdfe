//! A world in the frame of its driven robot is the same world.

use super::*;
use interfaces::{GroundTruth, LaserReading, TrueState, World, pose};
use nalgebra::{Isometry2, Point2};

/// The busy house with one robot that is driven.
fn house() -> WorldSpec {
    WorldSpec::driving(busy(), 0).unwrap()
}

fn apart_m(a: &Isometry2<f64>, b: &Isometry2<f64>) -> f64 {
    (a.translation.vector - b.translation.vector).norm() + a.rotation.angle_to(&b.rotation).abs()
}

#[test]
fn the_robot_starts_at_the_origin_and_the_frame_covers_the_place_in_whole_cells() {
    for heading_rad in [0.0, 0.4, -2.9] {
        let (moved, by) = house().around_robot(heading_rad).unwrap();
        assert_eq!(moved.driven().pose.translation, pose(0.0, 0.0, 0.0).translation);
        assert!((moved.driven().pose.rotation.angle() - heading_rad).abs() < 1e-12);
        let cells = moved.frame.origin() / moved.frame.resolution_m();
        assert!(cells.iter().all(|cells| (cells - cells.round()).abs() < 1e-9), "{cells}");
        for [x, y] in [[0.0, 0.0], [12.0, 0.0], [0.0, 12.0], [12.0, 12.0]] {
            let corner = by.point(&Point2::new(x, y));
            let inside = corner + (moved.driven().pose.translation.vector - corner.coords) * 1e-9;
            assert!(moved.frame.contains(moved.frame.cell_at(&inside)), "{corner}");
        }
    }
}

/// The oracle is the world that was not moved, until rounding has grown: rapier counts in 32 bits.
#[test]
fn everything_moves_and_is_seen_as_before() {
    let here = house();
    let (moved, by) = here.around_robot(1.1).unwrap();
    let (mut here, mut there) = (PhysicsWorld::new(&here, 5), PhysicsWorld::new(&moved, 5));
    let (mut contacts, mut beams, mut other) = (0, 0, 0);
    for _ in 0..60 {
        let (a, b): (LaserReading, LaserReading) = (here.sense(), there.sense());
        for (a, b) in here.fleet().robots().zip(there.fleet().robots()) {
            assert!(apart_m(&by.pose(&a.pose), &b.pose) < 2e-3, "{} at {} s", a.index, here.time_s());
        }
        for (a, b) in here.fleet().obstacles().zip(there.fleet().obstacles()) {
            let off = a.corners.iter().zip(&b.corners).map(|(a, b)| (by.point(a) - b).norm());
            assert!(off.fold(0.0, f64::max) < 5e-3, "a thing at {} s", here.time_s());
        }
        let with = |world: &PhysicsWorld| world.contacts().iter().map(|at| at.with).collect::<Vec<_>>();
        assert_eq!(with(&here), with(&there), "at {} s", here.time_s());
        contacts += here.contacts().len();
        beams += a.scan.ranges_m.len();
        let pairs = a.scan.ranges_m.iter().zip(&b.scan.ranges_m);
        other += pairs
            .filter(|(a, b)| a != b && (*a - *b).abs().partial_cmp(&0.02) != Some(std::cmp::Ordering::Less))
            .count();
        let phase = here.time_s();
        let drive =
            interfaces::Twist { linear_mps: 0.5 * libm::cos(phase * 0.7), angular_radps: libm::sin(phase) };
        here.act(&drive);
        there.act(&drive);
    }
    assert!(contacts > 0 && other * 100 < beams, "{contacts} contacts, {other} of {beams} beams differ");
}

/// A cell that is wholly free or blocked cannot hold a point for which the truth of the other frame is the opposite.
#[test]
fn the_truth_is_the_same_place() {
    let here = house();
    for heading_rad in [0.3, 1.6, -2.0] {
        let (moved, by) = here.around_robot(heading_rad).unwrap();
        let back = Isometry2::from_parts(by.point(&Point2::origin()).into(), by.turn).inverse();
        let (here, there) = (PhysicsWorld::new(&here, 0), PhysicsWorld::new(&moved, 0));
        let (a, b) = (here.truth(), there.truth());
        let mut area_m2 = [[0.0; 3]; 2];
        for (truth, area_m2) in [a, b].into_iter().zip(&mut area_m2) {
            for index in 0..truth.frame().len() {
                area_m2[truth.state(index) as usize] += truth.frame().resolution_m().powi(2);
            }
        }
        for index in 0..b.frame().len() {
            let at = back * b.frame().center(b.frame().cell(index));
            let Some(before) = a.frame().index(a.frame().cell_at(&at)) else { continue };
            match (a.state(before), b.state(index)) {
                (TrueState::Free, TrueState::Blocked) | (TrueState::Blocked, TrueState::Free) => {
                    panic!("{at} is {:?} and {:?}", a.state(before), b.state(index))
                }
                _ => {}
            }
        }
        let solid =
            |of: [f64; 3]| of[TrueState::Blocked as usize] + of[TrueState::PartlyCovered as usize] / 2.0;
        let [a, b] = area_m2.map(solid);
        assert!((a - b).abs() < 0.15 * a, "solid area {a} m² and {b} m²");
    }
}
