//! What is left out changes no bit.

use super::*;
use crate::physics::rays::Ring;
use interfaces::{Purpose, RandomStream, pose};
use nalgebra::{Rotation2, Vector2};
use std::f64::consts::TAU;

/// Without any culling: every edge and every disc is compared with all beams that could hit it.
fn slow(scene: &Scene, beams: &Beams, laser: &Isometry2<f64>, own: usize) -> Vec<f64> {
    let (Walls { solids, edges, visible }, Sorted { polygons, .. }) = (&*scene.moving.walls, scene.sorted());
    let mut inverse = Vec::new();
    let mut hits = Hits::new(beams, laser, &mut inverse);
    edges.iter().for_each(|edge| hits.add_edge(edge));
    let seen = (0..polygons.len() as u32).map(|index| polygons.get(index));
    for polygon in seen.filter(|polygon| polygon.is_seen_by(own)) {
        polygons.edges(polygon).iter().for_each(|edge| hits.add_edge(edge));
    }
    let discs = scene.moving.discs.iter().enumerate().filter(|(robot, _)| *robot != own);
    for (_, disc) in discs.filter(|(_, disc)| disc.radius_m > 0.0) {
        let to = disc.center - laser.translation.vector;
        let power = to.coords.norm_squared() - disc.radius_m * disc.radius_m;
        if power <= 0.0 {
            hits.add_inside();
            continue;
        }
        let center = laser.rotation.inverse() * to.coords;
        hits.add_disc_to(0..beams.count, &center, power, f64::INFINITY);
    }
    let at = Point2::from(laser.translation.vector);
    if is_in_wall(solids, visible, visible.cell_at(&at), &at) || polygons.contains(None, own, &at) {
        hits.add_inside();
    }
    inverse
}

/// A hall with walls at any angle, round robots, and convex bodies, some of them of robots; some reach beyond the
/// border. With few bodies, these are not sorted into cells.
fn scene(random: &mut RandomStream, range_m: f64, are_few: bool) -> Scene {
    let (round, cornered, others) = if are_few { (4, 2, 5) } else { (12, 6, 30) };
    assert_eq!(are_few, round + 2 * cornered + others <= FEW_BODIES);
    let mut point = || Point2::new(random.uniform(-0.2..12.2), random.uniform(-0.2..9.2));
    let places: Vec<_> = (0..60).map(|_| point()).collect();
    let (walls, discs_at, bodies) =
        (&places[..12], &places[12..12 + round + cornered], &places[30..30 + others]);
    let mut walls: Vec<Rectangle> = walls
        .iter()
        .map(|at| {
            Rectangle::around(*at, Vector2::new(random.uniform(0.1..3.0), 0.1), random.uniform(0.0..3.0))
        })
        .collect();
    walls.push(Rectangle::between(Point2::new(0.0, 4.0), Point2::new(7.0, 4.1)));
    let discs = discs_at.iter().enumerate().map(|(robot, center)| {
        // The last robots have corners.
        Disc { center: *center, radius_m: if robot < round { random.uniform(0.05..0.4) } else { 0.0 } }
    });
    let hulls: Vec<_> = bodies.iter().chain(&discs_at[round..]).collect();
    let borders = (Point2::origin(), Point2::new(12.0, 9.0));
    let mut scene = Scene::new(borders, &walls, discs.collect(), hulls.len(), range_m);
    for (index, at) in hulls.into_iter().enumerate() {
        let robot = index.checked_sub(bodies.len()).map(|robot| robot + round);
        let (corners, radius_m) = (random.uniform(3.0..21.0) as usize, random.uniform(0.05..0.8));
        let (turn_rad, flat) = (random.uniform(0.0..TAU), random.uniform(0.3..1.0));
        let corner = |i: usize| {
            let (sin, cos) = libm::sincos(TAU * i as f64 / corners as f64);
            at + Rotation2::new(turn_rad) * Vector2::new(cos, flat * sin) * radius_m
        };
        scene.set_polygon(index, robot, (0..corners).map(corner));
    }
    // An absent body.
    scene.set_polygon(3, None, [].into_iter());
    scene
}

#[test]
fn what_is_left_out_changes_no_bit() {
    let mut random = RandomStream::new(11, Purpose::Agent);
    let (mut inside, mut nothing) = (0, 0);
    for case in 0..60 {
        let range_m = random.uniform(0.5..12.0);
        let mut scene = scene(&mut random, range_m, case >= 40);
        for place in 0..120 {
            if place % 40 == 0 {
                // Sorted anew.
                let robot = place % scene.moving.discs.len();
                let center = scene.moving.discs[robot].center;
                scene.move_disc(robot, center + Vector2::new(0.01, 0.0));
            }
            let count = random.uniform(1.0..200.0) as usize;
            let is_full = place % 3 == 0 && count > 1;
            let fov_rad = if is_full { TAU } else { random.uniform(0.01..6.2) };
            let gaps = if is_full { count } else { count.max(2) - 1 };
            let first_rad = if is_full { -std::f64::consts::PI } else { -fov_rad / 2.0 };
            let first_rad = if count == 1 { 0.0 } else { first_rad };
            let beams = Beams::new(first_rad, fov_rad / gaps as f64, count, range_m);
            let own = place % scene.moving.discs.len();
            // In a robot, anywhere in the hall, or beyond its border.
            let center = scene.moving.discs[own].center;
            let at = match place % 4 {
                0 => Point2::new(random.uniform(-1.0..13.0), random.uniform(-1.0..10.0)),
                _ => center + Vector2::new(random.uniform(-0.2..0.2), random.uniform(-0.2..0.2)),
            };
            let laser = pose(at.x, at.y, random.uniform(-4.0..4.0));
            // Beyond the range of the sensor everything counts as nothing.
            let counted = |inverse: f64| if inverse * range_m < 1.0 { 0.0 } else { inverse };
            let expected: Vec<f64> = slow(&scene, &beams, &laser, own).into_iter().map(counted).collect();
            scene.cast(&beams, &laser, own, |inverse| {
                let found: Vec<f64> = inverse.iter().copied().map(counted).collect();
                assert_eq!(found, expected, "at {laser}");
            });
            let most = expected.iter().fold(0.0, |most: f64, inverse| most.max(*inverse));
            // One sensor of several on the robot.
            let ring =
                Ring { offset_m: random.uniform(0.0..0.6), range_m: range_m * random.uniform(1.0..2.0) };
            let (sin, cos) = libm::sincos(random.uniform(0.0..TAU));
            let robot_at = at + Vector2::new(cos, sin) * ring.offset_m * random.uniform(0.0..1.0);
            let vicinity = scene.vicinity(robot_at, &ring, own);
            let nearest = counted(scene.nearest(&beams, &laser, &vicinity));
            assert_eq!(nearest, most, "at {laser}, {count} beams over {fov_rad} rad");
            inside += usize::from(most == f64::INFINITY);
            nothing += usize::from(most == 0.0);
        }
    }
    assert!(inside > 100 && nothing > 100, "{inside} inside, {nothing} saw nothing");
}
