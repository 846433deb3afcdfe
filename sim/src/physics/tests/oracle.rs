//! Two references for the rays of this crate: a slab or a root per body and beam, and rapier's rays.

use super::*;
use crate::physics::bodies::Bodies;
use crate::physics::past::Recent;
use crate::physics::rays::{Disc, Scene};
use crate::physics::sensors::{Look, Platform, Sensor, SharedBeams, Surroundings};
use crate::physics::shape::grid_corners;
use interfaces::{Scan, Twist, rotation};
use nalgebra::{Isometry2, Point2, Vector2};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// A beam is grazing if a rotation by this angle changes the body that it hits, rad.
const GRAZE_RAD: f64 = 1e-6;

/// The range to the nearest body, m, by a slab or a root per body and beam: slow and simple.
fn brute_force_m(
    from: &Point2<f64>,
    along: &Vector2<f64>,
    boxes: &[Rectangle],
    sides: &[(Point2<f64>, Point2<f64>)],
    discs: &[(Point2<f64>, f64)],
) -> f64 {
    let side_m = sides.iter().filter_map(|(a, b)| {
        let (to, side) = (a - from, b - a);
        let (range_m, place) = (to.perp(&side) / along.perp(&side), to.perp(along) / along.perp(&side));
        (range_m > 0.0 && (0.0..=1.0).contains(&place)).then_some(range_m)
    });
    let side_m = side_m.fold(f64::INFINITY, f64::min);
    let box_m = boxes.iter().filter_map(|shape| shape.ray_m(from, along)).fold(f64::INFINITY, f64::min);
    let disc_m = discs.iter().filter_map(|(center, radius_m)| {
        let (to, r2) = (center - from, radius_m * radius_m);
        let (b, miss2) = (to.dot(along), to.perp(along).powi(2));
        (miss2 <= r2 && b > 0.0).then(|| b - (r2 - miss2).sqrt())
    });
    disc_m.fold(box_m.min(side_m), f64::min)
}

/// A place with its bodies, for the rays of this crate and for both references.
pub(super) struct Place {
    pub(super) spec: FleetSpec,
    scene: Scene,
    bodies: Bodies,
    /// Walls and other rectangles.
    boxes: Vec<Rectangle>,
    discs: Vec<(Point2<f64>, f64)>,
    /// The robots that are not round, with their corners.
    cornered: Vec<(usize, Vec<Point2<f64>>)>,
}

/// The scan of a laser at `at` on robot `own`.
pub(super) fn scan(spec: &LaserSpec, at: &Isometry2<f64>, scene: &Scene, own: usize) -> Scan {
    let spec = LaserSpec { mount: Isometry2::identity(), sweep_s: 0.0, ..*spec };
    let mut laser = Sensor::laser(&spec, &mut SharedBeams::default(), 0, 0);
    let platform = Platform { robot: own, pose: *at, odometry_pose: *at, odometry_twist: Twist::STOP };
    let (scene, recent) = (scene.clone(), Recent::default());
    let surroundings = Surroundings { step: 0, time_s: 0.0, scene, glass: Vec::new(), recent };
    laser.measure(&Look::new(platform, Arc::new(surroundings)));
    laser.laser_reading().flatten().expect("a laser that has measured").scan.clone()
}

/// The results for the beams that were compared.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    pub(super) beams: usize,
    /// The beams whose target changes with a rotation by ±[`GRAZE_RAD`]. The range of each agreed with one of these
    /// three rotations.
    pub(super) grazing: usize,
}

impl Place {
    pub(super) fn new(spec: FleetSpec) -> Self {
        let mut bodies = Bodies::new(&spec);
        for (i, shape) in spec.walls.iter().chain(spec.obstacles.iter().map(|o| &o.shape)).enumerate() {
            bodies.add_box(Body::Wall(i), shape);
        }
        let mut discs = Vec::new();
        for (i, robot) in spec.robots.iter().enumerate() {
            bodies.add_robot(robot, spec.step_s);
            // As rapier computes it, so that both have the same value.
            discs.push((bodies.pose(i).translation.vector.into(), f64::from(robot.radius_m as f32)));
        }
        bodies.step();
        let round = discs.iter().map(|&(center, radius_m)| Disc { center, radius_m });
        let hulls = spec.obstacles.len();
        let mut scene = Scene::new(grid_corners(&spec.frame), &spec.walls, round.collect(), hulls, 10.0);
        for (place, obstacle) in spec.obstacles.iter().enumerate() {
            scene.set_polygon(place, None, obstacle.shape.corners().into_iter());
        }
        let boxes = spec.walls.iter().chain(spec.obstacles.iter().map(|o| &o.shape)).copied().collect();
        Self { spec, scene, bodies, boxes, discs, cornered: Vec::new() }
    }

    /// The present state of a fleet.
    pub(super) fn of(fleet: Fleet) -> Self {
        let spec = fleet.spec().clone();
        let boxes = fleet.standing_boxes();
        let (mut discs, mut cornered) = (Vec::new(), Vec::new());
        for robot in fleet.robots() {
            let at = Point2::from(robot.pose.translation.vector);
            let is_round = robot.corners.is_empty();
            discs.push((at, if is_round { f64::from(robot.radius_m as f32) } else { 0.0 }));
            if !is_round {
                cornered
                    .push((robot.index, robot.corners.iter().map(|corner| robot.pose * corner).collect()));
            }
        }
        let (scene, mut bodies) = (fleet.scene, fleet.bodies);
        bodies.find_again();
        Self { spec, scene, bodies, boxes, discs, cornered }
    }

    /// The scan of a laser at `at` on the first robot.
    pub(super) fn scan(&self, spec: &LaserSpec, at: &Isometry2<f64>) -> Scan {
        scan(spec, at, &self.scene, 0)
    }

    /// The range of rapier's ray from `at` on the first robot, m; ∞ beyond 10 m.
    pub(super) fn rapier_m(&self, at: &Isometry2<f64>, angle_rad: f64) -> f64 {
        let along = rotation(angle_rad) * (at.rotation * Vector2::x());
        let range_m = self.bodies.ray_m(&at.translation.vector.into(), &along, 0, 10.0);
        range_m.unwrap_or(f64::INFINITY)
    }

    /// Whether a laser at this position is outside of all bodies.
    pub(super) fn is_free(&self, at: &Point2<f64>, own: usize) -> bool {
        let mut others = self.discs.iter().enumerate().filter(|(i, _)| *i != own);
        self.boxes.iter().all(|shape| shape.distance_m(at) > 1e-3)
            && self.cornered.iter().all(|(_, body)| convex::disc_gap_m(body, at, 1e-3) > 0.0)
            && others.all(|(_, (center, radius_m))| (center - at).norm() > radius_m + 1e-3)
    }

    /// Compares a scan from `at` on robot `own` with both references.
    pub(super) fn compare(&self, spec: &LaserSpec, at: &Isometry2<f64>, own: usize, tally: &mut Tally) {
        let scan = scan(spec, at, &self.scene, own);
        let from = Point2::from(at.translation.vector);
        let others: Vec<_> =
            self.discs.iter().enumerate().filter(|(i, _)| *i != own).map(|(_, disc)| *disc).collect();
        let cornered = self.cornered.iter().filter(|(robot, _)| *robot != own);
        let sides: Vec<_> =
            cornered.flat_map(|(_, corners)| convex::sides(corners)).map(|(a, b)| (*a, *b)).collect();
        let max_m = scan.range_max_m;
        tally.beams += scan.ranges_m.len();
        for (beam, range_m) in scan.ranges_m.iter().enumerate() {
            let direction =
                |turn_rad: f64| rotation(scan.angle_rad(beam) + turn_rad) * (at.rotation * Vector2::x());
            let exact =
                |turn_rad: f64| brute_force_m(&from, &direction(turn_rad), &self.boxes, &sides, &others);
            let [low, range, high] = [-GRAZE_RAD, 0.0, GRAZE_RAD].map(exact);
            // If the target stays the same, the range stays the same, within the effect of the rotation.
            if (low - range).abs() > 1e-3 || (high - range).abs() > 1e-3 || (range - max_m).abs() < 1e-3 {
                tally.grazing += 1;
                let near = [low, range, high]
                    .iter()
                    .any(|e| (e.min(1e9) - f64::from(*range_m).min(1e9)).abs() < 1e-3);
                assert!(
                    near || *range_m == f32::INFINITY && range > max_m - 1e-3,
                    "grazing beam {beam} at {at:?}: {range_m}, not {low}, {range} or {high}"
                );
                continue;
            }
            let expected = if range > max_m { f32::INFINITY } else { range as f32 };
            assert!(
                *range_m == expected || (range_m - expected).abs() < 1e-5,
                "beam {beam} at {at:?}: {range_m}, not {expected}"
            );
            let rapier = self.bodies.ray_m(&from, &direction(0.0), own, max_m);
            let rapier = rapier.map_or(f64::INFINITY, |range| range);
            let ours = f64::from(*range_m);
            assert!(
                ours == rapier || (ours - rapier).abs() < 1e-3,
                "beam {beam} at {at:?}: ours {ours} m, rapier's {rapier} m"
            );
        }
    }
}

/// A number in a range, the same on every machine.
pub(super) fn uniform(stream: &mut ChaCha8Rng, range: std::ops::Range<f64>) -> f64 {
    range.start + (range.end - range.start) * (stream.next_u64() >> 11) as f64 * 2.0_f64.powi(-53)
}
