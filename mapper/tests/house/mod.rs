//! A small house of four rooms with a laser; rays are cast one by one against every wall: slow, and as simple as
//! possible. It does not use the simulator.
#![allow(dead_code)] // every test file takes what it needs

use interfaces::{CellState, GridFrame, LaserReading, Scan, Twist};
use nalgebra::{Isometry2, Point2, Vector2};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};
use std::f64::consts::TAU;

pub(crate) const CELL_M: f64 = 0.05;

/// A thing with a convex outline, counter-clockwise, that is in the house from `from_s` until before `until_s`.
#[derive(Clone)]
pub(crate) struct Thing {
    pub(crate) corners: Vec<Point2<f64>>,
    pub(crate) from_s: f64,
    pub(crate) until_s: f64,
}

impl Thing {
    /// A thing that is present at all times.
    pub(crate) fn always(corners: Vec<Point2<f64>>) -> Self {
        Self { corners, from_s: f64::NEG_INFINITY, until_s: f64::INFINITY }
    }

    fn stands(&self, time_s: f64) -> bool {
        (self.from_s..self.until_s).contains(&time_s)
    }
}

/// The house and the laser in it.
#[derive(Clone)]
pub(crate) struct House {
    pub(crate) things: Vec<Thing>,
    pub(crate) frame: GridFrame,
    pub(crate) turn_rad: f64,
    pub(crate) noise_std_m: f64,
    pub(crate) beams: usize,
    rng: ChaCha8Rng,
}

/// The corners of a rectangle, counter-clockwise.
pub(crate) fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Vec<Point2<f64>> {
    [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| Point2::new(x, y)).to_vec()
}

/// A scan over a full turn, from a robot at rest.
pub(crate) fn scan(
    time_s: f64,
    pose: Isometry2<f64>,
    angle_min_rad: f64,
    ranges_m: Vec<f32>,
) -> LaserReading {
    let angle_increment_rad = TAU / ranges_m.len() as f64;
    LaserReading {
        time_s,
        pose,
        twist: Twist::STOP,
        velocities: Vec::new(),
        mount: Isometry2::identity(),
        scan: Scan {
            angle_min_rad,
            angle_increment_rad,
            range_min_m: 0.05,
            range_max_m: 10.0,
            sweep_s: 0.0,
            ranges_m,
        },
    }
}

/// Outer walls, and a cross of inner walls with a door of 1 m in each arm.
pub(crate) fn walls(thickness_m: f64) -> Vec<Vec<Point2<f64>>> {
    let (t, s) = (thickness_m, 12.0);
    // The inner walls are on cell borders, but thin ones within a cell.
    let (a, b) = if t < CELL_M {
        (6.01, 6.01 + t)
    } else {
        (6.0 - (t / 2.0 / CELL_M).floor() * CELL_M, 6.0 + (t / 2.0 / CELL_M).ceil() * CELL_M)
    };
    vec![
        rectangle(0.0, 0.0, s, t),
        rectangle(0.0, s - t, s, s),
        rectangle(0.0, t, t, s - t),
        rectangle(s - t, t, s, s - t),
        rectangle(a, t, b, 2.5),
        rectangle(a, 3.5, b, 8.5),
        rectangle(a, 9.5, b, s - t),
        rectangle(t, a, 2.5, b),
        rectangle(3.5, a, a, b),
        rectangle(b, a, 8.5, b),
        rectangle(9.5, a, s - t, b),
    ]
}

impl House {
    /// The house with walls of `thickness_m`, rotated about its center, in a grid that contains it.
    pub(crate) fn new(thickness_m: f64, turn_deg: f64, noise_std_m: f64, beams: usize, seed: u64) -> Self {
        let margin = if turn_deg == 0.0 { 0.0 } else { 2.0 };
        let size = 12.0 + 2.0 * margin;
        let mut house = Self {
            things: Vec::new(),
            frame: GridFrame::covering(Point2::new(-margin, -margin), size, size, CELL_M).unwrap(),
            turn_rad: turn_deg.to_radians(),
            noise_std_m,
            beams,
            rng: ChaCha8Rng::seed_from_u64(seed),
        };
        for corners in walls(thickness_m) {
            house.add(Thing::always(corners));
        }
        house
    }

    /// Adds a thing, given in the house before rotation.
    pub(crate) fn add(&mut self, mut thing: Thing) {
        for corner in &mut thing.corners {
            *corner = self.turned(*corner);
        }
        self.things.push(thing);
    }

    /// The state of a cell in a perfect map: [`CellState::Unknown`] if things cover a part of it. Walls and things
    /// are thicker than the distance between the sampled points.
    pub(crate) fn truth(&self, index: usize, time_s: f64) -> CellState {
        let middle = self.frame.center(self.frame.cell(index));
        let steps = [-0.499, -0.25, 0.0, 0.25, 0.499].map(|step| step * CELL_M);
        let points = steps.iter().flat_map(|&x| steps.iter().map(move |&y| middle + Vector2::new(x, y)));
        match points.filter(|&point| self.is_solid(point, time_s)).count() {
            0 => CellState::Free,
            25 => CellState::Blocked,
            _ => CellState::Unknown,
        }
    }

    /// Whether a point is inside of something that is present at `time_s`.
    fn is_solid(&self, point: Point2<f64>, time_s: f64) -> bool {
        self.things.iter().filter(|thing| thing.stands(time_s)).any(|thing| {
            let corners = &thing.corners;
            (0..corners.len()).all(|i| {
                let edge = corners[(i + 1) % corners.len()] - corners[i];
                edge.perp(&(point - corners[i])) > 0.0
            })
        })
    }

    /// The point of the rotated house that corresponds to a point of the house before rotation.
    pub(crate) fn turned(&self, point: Point2<f64>) -> Point2<f64> {
        let middle = Point2::new(6.0, 6.0);
        middle + interfaces::rotation(self.turn_rad) * (point - middle)
    }

    /// A round trip through the four rooms at 0.3 m/s, given in the house before rotation.
    pub(crate) fn tour(&self, time_s: f64) -> Isometry2<f64> {
        let stops = [
            (3.0, 3.0),
            (5.0, 3.0),
            (7.0, 3.0),
            (9.0, 3.0),
            (9.0, 5.0),
            (9.0, 7.0),
            (10.5, 10.5),
            (9.0, 9.0),
            (7.0, 9.0),
            (5.0, 9.0),
            (1.5, 10.5),
            (3.0, 9.0),
            (3.0, 7.0),
            (3.0, 5.0),
            (1.0, 1.0),
        ];
        let mut left_m = 0.3 * time_s;
        for leg in (0..stops.len()).cycle() {
            let (x0, y0) = stops[leg];
            let (x1, y1) = stops[(leg + 1) % stops.len()];
            let (from, to) = (Point2::new(x0, y0), Point2::new(x1, y1));
            let length_m = (to - from).norm();
            if left_m <= length_m {
                let at = self.turned(from + (to - from) * (left_m / length_m));
                let along = self.turned(to) - self.turned(from);
                return interfaces::pose(at.x, at.y, along.y.atan2(along.x));
            }
            left_m -= length_m;
        }
        unreachable!("the tour has no end")
    }

    /// The reading at a pose, with moving discs (center, radius).
    pub(crate) fn reading(
        &mut self,
        time_s: f64,
        pose: Isometry2<f64>,
        discs: &[(Point2<f64>, f64)],
    ) -> LaserReading {
        let increment = TAU / self.beams as f64;
        let normal = Normal::new(0.0, self.noise_std_m).unwrap();
        let standing: Vec<&Thing> = self.things.iter().filter(|thing| thing.stands(time_s)).collect();
        let origin = Point2::from(pose.translation.vector);
        let ranges_m = (0..self.beams)
            .map(|beam| {
                let along =
                    pose.rotation * interfaces::rotation(-TAU / 2.0 + beam as f64 * increment) * Vector2::x();
                let mut range_m = f64::INFINITY;
                for thing in &standing {
                    for (i, &a) in thing.corners.iter().enumerate() {
                        let b = thing.corners[(i + 1) % thing.corners.len()];
                        let (edge, to) = (b - a, a - origin);
                        let turn = along.perp(&edge);
                        let (t, s) = (to.perp(&edge) / turn, to.perp(&along) / turn);
                        if turn != 0.0 && t > 0.0 && (0.0..=1.0).contains(&s) {
                            range_m = range_m.min(t);
                        }
                    }
                }
                for (middle, radius_m) in discs {
                    let to = middle - origin;
                    let (ahead, off) = (to.dot(&along), to.perp(&along));
                    let half = radius_m * radius_m - off * off;
                    if half > 0.0 && ahead > 0.0 {
                        range_m = range_m.min(ahead - half.sqrt());
                    }
                }
                let noise = normal.sample(&mut self.rng);
                if range_m > 10.0 { f32::INFINITY } else { (range_m + noise) as f32 }
            })
            .collect();
        scan(time_s, pose, -TAU / 2.0, ranges_m)
    }
}
