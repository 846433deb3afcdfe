//! Corridors around a block, with niches and rooms behind doors; rays are cast against every near wall.

use crate::robot::PERIOD_S;
use interfaces::{GridFrame, LaserReading, Purpose, RandomStream, Scan};
use nalgebra::{Isometry2, Point2, Vector2};
use std::f64::consts::{FRAC_PI_2, TAU};

/// The width of the corridors, m.
const WIDTH_M: f64 = 2.2;
/// The radius of the way around a corner, m.
const BEND_M: f64 = 0.8;
/// The maximum range of the laser, m.
const RANGE_M: f64 = 10.0;

/// What is behind the walls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Plan {
    /// Niches and rooms of random sizes at random places.
    Varied,
    /// The same niche every 4 m, everywhere.
    Repeated,
    /// Niches and rooms along the first side only: elsewhere the walls are smooth.
    OneSide,
}

/// A corridor around a block of `length_m` × `depth_m`, measured in the middle of the corridor, and a laser.
pub(crate) struct Corridor {
    walls: Vec<(Point2<f64>, Point2<f64>)>,
    sides_m: [f64; 2],
    beams: usize,
    fov_rad: f64,
    noise_m: f64,
    /// Whether a scan takes as long as the robot needs from reading to reading, and the pose of the last one.
    sweeps: bool,
    last: Option<Isometry2<f64>>,
    random: RandomStream,
}

impl Corridor {
    pub(crate) fn new(sides_m: [f64; 2], plan: Plan, seed: u64) -> Self {
        let mut corridor = Self {
            walls: Vec::new(),
            sides_m,
            beams: 360,
            fov_rad: TAU,
            noise_m: 0.01,
            sweeps: false,
            last: None,
            random: RandomStream::new(seed, Purpose::HouseGenerator),
        };
        let half = WIDTH_M / 2.0;
        let [length_m, depth_m] = sides_m;
        let corner =
            |by: f64| [(-by, -by), (length_m + by, -by), (length_m + by, depth_m + by), (-by, depth_m + by)];
        for (corners, outward) in [(corner(half), 1.0), (corner(-half), -1.0)] {
            for side in 0..4 {
                let [from, to] = [corners[side], corners[(side + 1) % 4]].map(|(x, y)| Point2::new(x, y));
                match plan {
                    Plan::OneSide if side > 0 => corridor.walls.push((from, to)),
                    _ => corridor.add_side(from, to, outward, plan),
                }
            }
        }
        corridor
    }

    /// A laser with another number of beams over another field of view.
    pub(crate) fn with_laser(mut self, beams: usize, fov_rad: f64) -> Self {
        (self.beams, self.fov_rad) = (beams, fov_rad);
        self
    }

    /// A laser that measures its beams one after the other, on the way from the last reading to this one.
    pub(crate) fn sweeping(self) -> Self {
        Self { sweeps: true, ..self }
    }

    /// A wall with openings. The corridor is to the left of outer walls, which have their rooms to the right.
    fn add_side(&mut self, from: Point2<f64>, to: Point2<f64>, outward: f64, plan: Plan) {
        let length_m = (to - from).norm();
        let along = (to - from) / length_m;
        let behind = Vector2::new(along.y, -along.x) * outward;
        let (mut at_m, mut last) = (1.5, from);
        loop {
            let (gap_m, width_m, depth_m, is_room) = match plan {
                Plan::Repeated => (3.0, 1.0, 0.3, false),
                Plan::Varied | Plan::OneSide => {
                    let is_room = self.random.bernoulli(0.3);
                    let depth_m =
                        if is_room { self.random.uniform(2.0..4.0) } else { self.random.uniform(0.1..0.5) };
                    (self.random.uniform(0.8..5.0), self.random.uniform(0.7..1.6), depth_m, is_room)
                }
            };
            at_m += gap_m;
            if at_m + width_m + 1.5 > length_m {
                break;
            }
            let point = |at_m: f64, depth_m: f64| from + along * at_m + behind * depth_m;
            let (left, right) = (at_m, at_m + width_m);
            // A room is wider than its door, and the door is as deep as a wall.
            let wider_m = if is_room { 0.7 } else { 0.0 };
            let sill_m = if is_room { 0.2 } else { 0.0 };
            let outline = [
                last,
                point(left, 0.0),
                point(left, sill_m),
                point(left - wider_m, sill_m),
                point(left - wider_m, depth_m),
                point(right + wider_m, depth_m),
                point(right + wider_m, sill_m),
                point(right, sill_m),
                point(right, 0.0),
            ];
            self.walls.extend(outline.windows(2).map(|pair| (pair[0], pair[1])));
            last = point(right, 0.0);
            at_m = right;
        }
        self.walls.push((last, to));
    }

    /// A frame that covers the place, and the errors of a map of it.
    pub(crate) fn frame(&self, resolution_m: f64) -> GridFrame {
        let margin_m = WIDTH_M / 2.0 + 7.0;
        let [length_m, depth_m] = self.sides_m.map(|side_m| side_m + 2.0 * margin_m);
        GridFrame::covering(Point2::new(-margin_m, -margin_m), length_m, depth_m, resolution_m).unwrap()
    }

    /// The distance of a point from the nearest wall, m.
    pub(crate) fn distance_m(&self, point: &Point2<f64>) -> f64 {
        let distances_m = self.walls.iter().map(|wall| distance_m(wall, point));
        distances_m.fold(f64::INFINITY, f64::min)
    }

    /// The length of the way around, m.
    pub(crate) fn round_m(&self) -> f64 {
        2.0 * (self.sides_m[0] + self.sides_m[1]) - 8.0 * BEND_M + TAU * BEND_M
    }

    /// The pose after a way along the middle of the corridor, counter-clockwise.
    pub(crate) fn at(&self, way_m: f64) -> Isometry2<f64> {
        let mut left_m = way_m % self.round_m();
        let mut corner = interfaces::pose(BEND_M, 0.0, 0.0);
        for side in 0.. {
            let straight_m = self.sides_m[side % 2] - 2.0 * BEND_M;
            if left_m <= straight_m {
                return corner * interfaces::pose(left_m, 0.0, 0.0);
            }
            left_m -= straight_m;
            corner *= interfaces::pose(straight_m, 0.0, 0.0);
            let turn_rad = (left_m / BEND_M).min(FRAC_PI_2);
            let bend = |turn_rad: f64| {
                interfaces::pose(BEND_M * turn_rad.sin(), BEND_M * (1.0 - turn_rad.cos()), turn_rad)
            };
            if turn_rad < FRAC_PI_2 {
                return corner * bend(turn_rad);
            }
            left_m -= BEND_M * FRAC_PI_2;
            corner *= bend(FRAC_PI_2);
        }
        unreachable!("the way has no end")
    }

    /// The reading at a pose, with this pose as odometry.
    pub(crate) fn reading(&mut self, time_s: f64, pose: Isometry2<f64>) -> LaserReading {
        let before = self.last.replace(pose).filter(|_| self.sweeps).unwrap_or(pose);
        let near_m = RANGE_M + (pose.translation.vector - before.translation.vector).norm();
        let is_near = |wall: &&(Point2<f64>, Point2<f64>)| {
            distance_m(wall, &Point2::from(pose.translation.vector)) < near_m
        };
        let near: Vec<_> = self.walls.iter().filter(is_near).copied().collect();
        let increment = self.fov_rad / self.beams as f64;
        let angle_min_rad = -self.fov_rad / 2.0;
        let mut ranges_m = Vec::with_capacity(self.beams);
        for beam in 0..self.beams {
            let pose = before.lerp_slerp(&pose, beam as f64 / (self.beams - 1) as f64);
            let origin = Point2::from(pose.translation.vector);
            let along =
                pose.rotation * interfaces::rotation(angle_min_rad + beam as f64 * increment) * Vector2::x();
            let hit = |(a, b): &(Point2<f64>, Point2<f64>)| {
                let (edge, to) = (b - a, a - origin);
                let turn = along.perp(&edge);
                let (t, s) = (to.perp(&edge) / turn, to.perp(&along) / turn);
                (turn != 0.0 && t > 0.0 && (0.0..=1.0).contains(&s)).then_some(t)
            };
            let range_m = near.iter().filter_map(hit).fold(f64::INFINITY, f64::min);
            let noisy_m = range_m + self.noise_m * self.random.normal();
            ranges_m.push(if range_m > RANGE_M { f32::INFINITY } else { noisy_m as f32 });
        }
        LaserReading {
            time_s,
            pose,
            scan: Scan {
                angle_min_rad,
                angle_increment_rad: increment,
                range_min_m: 0.05,
                range_max_m: RANGE_M,
                sweep_s: if self.sweeps { PERIOD_S } else { 0.0 },
                ranges_m,
            },
            ..LaserReading::default()
        }
    }
}

/// The distance of a point from a wall, m.
fn distance_m((a, b): &(Point2<f64>, Point2<f64>), point: &Point2<f64>) -> f64 {
    let (edge, to) = (b - a, point - a);
    let share = (to.dot(&edge) / edge.norm_squared()).clamp(0.0, 1.0);
    (to - edge * share).norm()
}
