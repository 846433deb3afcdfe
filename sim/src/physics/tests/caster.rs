//! The rays of this crate compared with rapier's rays.

use super::oracle::{self, Place, Tally, uniform};
use super::*;
use crate::physics::rays::Scene;
use crate::physics::shape::grid_corners;
use interfaces::{GridFrame, pose, rotation};
use nalgebra::{Point2, Vector2};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// A cluttered, rotated house with boxes at odd angles and several robots.
pub(super) fn cluttered() -> FleetSpec {
    let boxes = [(3.3, 4.1, 0.4, 0.7, 33.0), (8.0, 2.0, 1.5, 0.02, -71.0), (9.0, 8.7, 0.3, 0.3, 45.0)];
    let mut spec = four_rooms();
    spec.obstacles.extend(boxes.map(|(x, y, width, height, heading_deg): (f64, f64, f64, f64, f64)| {
        let size_m = Vector2::new(width, height);
        let shape = Rectangle::around(Point2::new(x, y), size_m, heading_deg.to_radians());
        ObstacleSpec::new("box", shape, Motion::Fixed)
    }));
    spec.turn(10.0_f64.to_radians(), &Point2::new(6.0, 6.0));
    // As large as the rotated house.
    let side_m = 12.0 * (libm::cos(10.0_f64.to_radians()) + libm::sin(10.0_f64.to_radians()));
    let low = Point2::new(6.0, 6.0) - Vector2::repeat(side_m / 2.0);
    spec.frame = GridFrame::covering(low, side_m, side_m, 0.05).unwrap();
    spec
}

#[test]
fn a_million_beams_agree_with_rapier() {
    let place = Place::new(cluttered());
    let laser = place.spec.robots[0].laser;
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
    // Every grazing beam was inspected; if their number changes, the rays have changed.
    assert_eq!((tally.beams, tally.grazing), (1_000_080, 19), "of them grazing");
}

/// Houses side by side with many robots: bodies that the cells hide must really be hidden.
#[test]
fn beams_agree_with_rapier_among_many_houses() {
    let mut stream = ChaCha8Rng::seed_from_u64(3);
    let mut spec = four_rooms();
    let middle = Point2::new(12.0, 12.0);
    spec.walls = [(0.0, 0.0), (12.0, 0.0), (0.0, 12.0), (12.0, 12.0)]
        .into_iter()
        .flat_map(|(x, y)| rooms(x, y))
        .collect();
    let robot = RobotSpec { behavior: BehaviorSpec::Standing, ..spec.robots[0].clone() };
    spec.robots = (0..64)
        .map(|i| {
            // On a grid, but none in a wall.
            let [x, y] = [i % 8, i / 8].map(|k| 1.5 + 3.0 * f64::from(k) + uniform(&mut stream, -1.0..1.0));
            RobotSpec { pose: pose(x, y, 0.0), ..robot.clone() }
        })
        .collect();
    spec.turn(10.0_f64.to_radians(), &middle);
    let side_m = 24.0 * (libm::cos(10.0_f64.to_radians()) + libm::sin(10.0_f64.to_radians()));
    spec.frame = GridFrame::covering(middle - Vector2::repeat(side_m / 2.0), side_m, side_m, 0.1).unwrap();
    let place = Place::new(spec);
    let (mut tally, own) = (Tally::default(), 0);
    let laser = LaserSpec { beams: 359, ..place.spec.robots[0].laser };
    while tally.beams < 150_000 {
        let at = Point2::new(uniform(&mut stream, -1.0..25.0), uniform(&mut stream, -1.0..25.0));
        if place.is_free(&at, own) {
            place.compare(&laser, &pose(at.x, at.y, uniform(&mut stream, -4.0..4.0)), own, &mut tally);
        }
    }
    assert!(tally.grazing < tally.beams / 10_000, "{tally:?}");
}

/// Doors, blocks and boxes in motion, repeatedly.
#[test]
fn moving_bodies_are_seen_at_their_poses() {
    let spec = busy();
    let mut fleet = Fleet::new(&spec, 5);
    let laser = LaserSpec { beams: 360, noise_std_m: 0.0, ..spec.robots[0].laser };
    let mut stream = ChaCha8Rng::seed_from_u64(4);
    let mut tally = Tally::default();
    let mut moved = 0;
    for _ in 0..60 {
        fleet.run_until(fleet.time_s() + 0.35, &mut reckless);
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
    assert!(moved > 300, "too few things move: {moved}");
    assert!(tally.grazing < tally.beams / 5_000, "{tally:?}");
}

#[test]
fn narrow_lasers_see_the_same() {
    let place = Place::new(cluttered());
    let at = place.spec.robots[0].pose.translation.vector;
    let mut stream = ChaCha8Rng::seed_from_u64(2);
    for _ in 0..300 {
        let mut laser = place.spec.robots[0].laser;
        laser.fov_rad = uniform(&mut stream, 1.0..360.0).to_radians();
        laser.beams = uniform(&mut stream, 2.0..50.0) as usize;
        laser.range_max_m = 4.0;
        let heading = uniform(&mut stream, -4.0..4.0);
        place.compare(&laser, &pose(at.x, at.y, heading), 0, &mut Tally::default());
    }
}

/// A narrow field of view with bodies behind it: none of its beams may show these bodies.
#[test]
fn nothing_is_seen_behind_a_narrow_laser() {
    let place = Place::of(Fleet::new(&crowd(), 0));
    let mut stream = ChaCha8Rng::seed_from_u64(6);
    let mut tally = Tally::default();
    for _ in 0..300 {
        let mut laser = LaserSpec { noise_std_m: 0.0, ..place.spec.robots[0].laser };
        laser.fov_rad = uniform(&mut stream, 1.0..40.0).to_radians();
        laser.beams = uniform(&mut stream, 2.0..100.0) as usize;
        let own = (uniform(&mut stream, 0.0..36.0) as usize).min(35);
        let at = place.spec.robots[own].pose.translation.vector;
        place.compare(&laser, &pose(at.x, at.y, uniform(&mut stream, -4.0..4.0)), own, &mut tally);
    }
}

#[test]
fn a_laser_inside_of_a_solid_sees_nothing_else() {
    let spec = four_rooms();
    let scene = Scene::new(grid_corners(&spec.frame), &spec.walls, Vec::new(), 0, 10.0);
    let scan = oracle::scan(&spec.robots[0].laser, &pose(6.0, 1.0, 0.3), &scene, 0);
    assert!(scan.ranges_m.iter().all(|range| *range == 0.0));
}
