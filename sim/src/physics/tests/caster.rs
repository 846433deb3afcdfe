//! Our rays against rapier's.

use super::*;
use crate::physics::laser::{Laser, Scene};
use crate::physics::{bodies::Bodies, chance};
use geometry::{pose, rotation};
use nalgebra::{Isometry2, Point2, Vector2};
use proptest::prelude::*;

/// A beam whose target does not survive a turn of this much is grazing, rad.
const GRAZE_RAD: f64 = 1e-6;

/// The range to the nearest thing, m, by a slab or a root per thing and beam: slow and simple.
fn brute_force_m(
    from: &Point2<f64>,
    along: &Vector2<f64>,
    spec: &WorldSpec,
    discs: &[(Point2<f64>, f64)],
) -> f64 {
    let boxes = spec.walls().iter().chain(spec.obstacles().iter().map(|obstacle| &obstacle.shape));
    let box_m = boxes.filter_map(|shape| shape.ray_m(from, along)).fold(f64::INFINITY, f64::min);
    let disc_m = discs.iter().filter_map(|(center, radius_m)| {
        let (to, r2) = (center - from, radius_m * radius_m);
        let (b, miss2) = (to.dot(along), to.perp(along).powi(2));
        (miss2 <= r2 && b > 0.0).then(|| b - (r2 - miss2).sqrt())
    });
    disc_m.fold(box_m, f64::min)
}

/// A cluttered house, turned, with boxes at odd angles and several robots.
fn cluttered() -> WorldSpec {
    let boxes = [(3.3, 4.1, 0.4, 0.7, 33.0), (8.0, 2.0, 1.5, 0.02, -71.0), (9.0, 8.7, 0.3, 0.3, 45.0)];
    let obstacles = boxes.iter().enumerate().map(|(i, (x, y, w, h, turn))| {
        format!("[[obstacle]]\nname = \"b{i}\"\ncenter_m = [{x}, {y}]\nsize_m = [{w}, {h}]\nheading_deg = {turn}\n")
    });
    four_rooms_but(&[("turn_deg = 0.0", "turn_deg = 10.0")], &obstacles.collect::<String>())
}

/// What a scan from `laser` on robot `own` shows against both oracles; counts grazing beams.
fn compare(spec: &WorldSpec, laser: &mut Laser, at: &Isometry2<f64>, own: usize, grazing: &mut usize) {
    let mut bodies = Bodies::new(spec.step_s);
    let mut scene = Scene::default();
    for (i, shape) in spec.walls.iter().chain(spec.obstacles.iter().map(|o| &o.shape)).enumerate() {
        bodies.add_box(Body::Wall(i), shape);
        scene.boxes.push(shape.corners());
    }
    for (i, robot) in spec.robots.iter().enumerate() {
        bodies.add_robot(robot, spec.step_s);
        // As rapier has it, so that both see the same.
        scene.discs.push((bodies.pose(i).translation.vector.into(), f64::from(robot.radius_m as f32)));
    }
    bodies.step();
    let mut scan = spec.robots[own].laser.empty_scan();
    laser.scan(at, &scene, own, &mut scan);
    let from = Point2::from(at.translation.vector);
    let others: Vec<_> =
        scene.discs.iter().enumerate().filter(|(i, _)| *i != own).map(|(_, disc)| *disc).collect();
    let max_m = scan.range_max_m;
    for (beam, range_m) in scan.ranges_m.iter().enumerate() {
        let direction =
            |turn_rad: f64| rotation(scan.angle_rad(beam) + turn_rad) * (at.rotation * Vector2::x());
        let exact = |turn_rad: f64| brute_force_m(&from, &direction(turn_rad), spec, &others);
        let [low, range, high] = [-GRAZE_RAD, 0.0, GRAZE_RAD].map(exact);
        // Where the target stays the same, so does the range, within what a turn can shift it.
        if (low - range).abs() > 1e-3 || (high - range).abs() > 1e-3 || (range - max_m).abs() < 1e-3 {
            *grazing += 1;
            let near =
                [low, range, high].iter().any(|e| (e.min(1e9) - f64::from(*range_m).min(1e9)).abs() < 1e-3);
            assert!(
                near || *range_m == f32::INFINITY && range > max_m - 1e-3,
                "grazing beam {beam}: {range_m}"
            );
            continue;
        }
        let expected = if range > max_m { f32::INFINITY } else { range as f32 };
        assert!(
            *range_m == expected || (range_m - expected).abs() < 1e-5,
            "beam {beam}: {range_m}, not {expected}"
        );
        let rapier = bodies.ray_m(&from, &direction(0.0), own, max_m);
        let rapier = rapier.map_or(f64::INFINITY, |range| range);
        let ours = f64::from(*range_m);
        assert!(
            ours == rapier || (ours - rapier).abs() < 1e-3,
            "beam {beam}: ours {ours} m, rapier's {rapier} m"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    #[test]
    fn every_beam_is_where_rapier_has_it(x in 0.2..11.8_f64, y in 0.2..11.8_f64, heading in -4.0..4.0_f64) {
        let spec = cluttered();
        let middle = Point2::new(6.0, 6.0);
        let at = middle + rotation(10.0_f64.to_radians()) * (Point2::new(x, y) - middle);
        let free_m = spec.walls.iter().chain(spec.obstacles.iter().map(|o| &o.shape)).map(|s| s.distance_m(&at));
        prop_assume!(free_m.fold(f64::INFINITY, f64::min) > 0.001);
        prop_assume!(spec.robots.iter().skip(1).all(|r| (r.pose.translation.vector - at.coords).norm() > 0.201));
        let mut laser = Laser::new(&spec.driven().laser, chance::Gaussian::new(0, chance::Purpose::Laser, 0));
        let mut grazing = 0;
        compare(&spec, &mut laser, &pose(at.x, at.y, heading), 0, &mut grazing);
        prop_assert!(grazing < 8, "{grazing} of 720 beams graze");
    }

    #[test]
    fn narrow_lasers_see_the_same(fov in 1.0..360.0_f64, beams in 2_usize..50, heading in -4.0..4.0_f64) {
        let mut spec = cluttered();
        spec.robots[0].laser.fov_rad = fov.to_radians();
        spec.robots[0].laser.beams = beams;
        spec.robots[0].laser.range_max_m = 4.0;
        let at = spec.robots[0].pose.translation.vector;
        let mut laser = Laser::new(&spec.driven().laser, chance::Gaussian::new(0, chance::Purpose::Laser, 0));
        compare(&spec, &mut laser, &pose(at.x, at.y, heading), 0, &mut 0);
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
    let dummy = world.robots().nth(1).and_then(|robot| robot.sweep).map(|sweep| &sweep.reading.scan);
    let down = dummy.map(|scan| scan.ranges_m[45]).unwrap();
    assert!((down - 0.8).abs() < 1e-6, "{down}");
}

#[test]
fn a_laser_inside_of_a_solid_sees_nothing_else() {
    let mut spec = four_rooms();
    spec.robots[0].pose = pose(6.0, 1.0, 0.3);
    let mut laser = Laser::new(&spec.driven().laser, chance::Gaussian::new(0, chance::Purpose::Laser, 0));
    let scene = Scene { boxes: spec.walls.iter().map(Rectangle::corners).collect(), discs: Vec::new() };
    let mut scan = spec.driven().laser.empty_scan();
    laser.scan(&spec.robots[0].pose, &scene, 0, &mut scan);
    assert!(scan.ranges_m.iter().all(|range| *range == 0.0));
}
