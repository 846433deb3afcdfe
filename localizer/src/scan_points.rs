//! Scan → points on surfaces, with normals, and weights by arc length.
//!
//! A point counts by the length of the surface that it represents: a door leaf beside the robot fills a third of all
//! beams, and yet is only one meter of surface.

#[cfg(test)]
mod tests;

use crate::constants::{JUDGED_M, SAME_SURFACE, SURFEL_M};
use crate::work;
use interfaces::{FARTHEST_M, LaserReading, Scan};
use nalgebra::{Isometry2, Matrix2, Point2, Vector2};

/// End points of neighboring beams that are nearer than this, in spacings of the beams, are on one surface: below about 20° between
/// beam and surface, a third beam must confirm the surface.
const JOIN_SPACINGS: f64 = 3.0;
/// End points of beams that graze one surface may be this far apart, m.
const GRAZING_M: f64 = 1.0;
/// The third end point lies off the line by at most this many standard deviations of the noise across the surface, and by no
/// more than this, m.
const GRAZING_STDS: f64 = 8.0;
const GRAZING_OFF_M: f64 = 0.03;
/// Minimum cosine of the angle of incidence of a point: below it, surfaces are rarely straight enough.
const MIN_GRAZING: f64 = 0.06;
/// Normals are fitted to the points up to this far away, m: with less, the noise of 1 cm turns them by degrees.
const NORMAL_REACH_M: f64 = 0.2;
/// Normals are fitted to at most this number of points on either side, which bounds the work of a scan.
const MAX_NEIGHBORS: usize = 1000;
/// Points lie on a line if their mean square distance is below that of this many standard deviations, and this
/// more, m.
const STRAIGHT_STDS: f64 = 1.3;
const STRAIGHT_M: f64 = 0.002;
/// Length of surface with weight 1, m: a beam that grazes a wall does not confirm all of it.
const FULL_WEIGHT_M: f64 = 0.04;
/// The mean over this many neighbors of a point on either side tells apart what the noise of a point hides.
const AVERAGED: usize = 4;

/// A point on a surface, in the frame of the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ScanPoint {
    /// The position, m.
    pub(crate) at: Point2<f64>,
    /// The unit normal of the surface, toward the laser.
    pub(crate) normal: Vector2<f64>,
    /// The weight, from 0 to 1.
    pub(crate) weight: f64,
    /// The share of the range noise that moves the point off its surface: the cosine of the angle of incidence, or 1.
    pub(crate) noise_share: f64,
    /// The number of the beam.
    pub(crate) beam: usize,
    /// The share of the way since the last scan that the robot had gone when the beam was measured: from 0 to 1, the end
    /// of the scan.
    pub(crate) passed: f64,
}

impl ScanPoint {
    /// A point with full weight, measured at the end of a scan.
    pub(crate) fn new(at: Point2<f64>, normal: Vector2<f64>) -> Self {
        Self { at, normal, weight: 1.0, noise_share: 1.0, beam: 0, passed: 1.0 }
    }
}

/// How points are made of end points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointRules {
    /// The standard deviation of the range noise, m.
    pub(crate) noise_m: f64,
    /// Whether beams that graze a surface make points. The range noise shifts them along the surface, and little off it:
    /// along a corridor they are the best evidence for the heading.
    pub(crate) grazing: bool,
}

/// Makes points of scans. Its buffers are used again for the next scan.
#[derive(Clone, Debug, Default)]
pub(crate) struct ScanPoints {
    directions: Directions,
    hits: Vec<Option<Point2<f64>>>,
    /// Whether the end point of a beam lies on the same surface as that of the next beam.
    joined: Vec<bool>,
    sums: Vec<Moments>,
}

/// The directions of the beams as unit vectors in the frame of the robot, for the last geometry that was asked for.
#[derive(Clone, Debug, Default)]
pub(crate) struct Directions {
    geometry: Option<(f64, f64, usize, Isometry2<f64>)>,
    pub(crate) units: Vec<Vector2<f64>>,
}

impl Directions {
    pub(crate) fn update(&mut self, scan: &Scan, mount: &Isometry2<f64>) {
        let geometry = Some((scan.angle_min_rad, scan.angle_increment_rad, scan.ranges_m.len(), *mount));
        if self.geometry != geometry {
            let unit = |beam| mount.rotation * (interfaces::rotation(scan.angle_rad(beam)) * Vector2::x());
            self.units = (0..scan.ranges_m.len()).map(unit).collect();
            self.geometry = geometry;
        }
    }
}

impl ScanPoints {
    /// The points of the scan of `reading`, in the order of the beams. Beams without a return, and points where no straight
    /// surface can be recognized (edges, single points) are left out. `passed` gives [`ScanPoint::passed`] of a beam.
    pub(crate) fn of(
        &mut self,
        reading: &LaserReading,
        passed: impl Fn(usize) -> f64,
        rules: &PointRules,
    ) -> Vec<ScanPoint> {
        let LaserReading { scan, mount, .. } = reading;
        self.directions.update(scan, mount);
        let beams = scan.ranges_m.len();
        let origin = Point2::from(mount.translation.vector);
        let farthest_m = scan.range_max_m.min(FARTHEST_M);
        self.hits.clear();
        self.hits.extend(scan.ranges_m.iter().zip(&self.directions.units).map(|(&range_m, unit)| {
            let range_m = f64::from(range_m);
            let is_hit = range_m >= scan.range_min_m && range_m <= farthest_m && range_m > 0.0;
            is_hit.then(|| origin + unit * range_m)
        }));
        self.join(scan, rules);
        self.sum();
        let is_closed = scan.is_full_turn() && beams > 2;
        let point =
            |beam| Some(ScanPoint { passed: passed(beam), ..self.point(beam, scan, is_closed, rules)? });
        (0..beams).filter_map(point).collect()
    }

    /// Finds neighboring end points on one surface.
    fn join(&mut self, scan: &Scan, rules: &PointRules) {
        let beams = self.hits.len();
        self.joined.clear();
        self.joined.resize(beams, false);
        let last = if scan.is_full_turn() && beams > 2 { beams } else { beams.saturating_sub(1) };
        for beam in 0..last {
            let next = if beam + 1 == beams { 0 } else { beam + 1 };
            if let (Some(a), Some(b)) = (self.hits[beam], self.hits[next]) {
                let nearer_m = f64::from(scan.ranges_m[beam].min(scan.ranges_m[next]));
                let limit_m = SURFEL_M.max(JOIN_SPACINGS * nearer_m * scan.angle_increment_rad.abs());
                self.joined[beam] = (b - a).norm_squared() <= limit_m * limit_m
                    || rules.grazing && self.grazes([beam, next], last == beams, rules.noise_m);
            }
        }
    }

    /// Whether two neighboring beams graze one surface: their end points are far apart, and on a line with that of the
    /// beam before or after them.
    fn grazes(&self, [beam, next]: [usize; 2], is_closed: bool, noise_m: f64) -> bool {
        let (Some(a), Some(b)) = (self.hits[beam], self.hits[next]) else { return false };
        let along = b - a;
        let length_m = along.norm();
        let line = along / length_m;
        let incidence = self.directions.units[beam].perp(&line).abs();
        let tolerance_m = GRAZING_STDS * noise_m * incidence + STRAIGHT_M;
        if !(length_m <= GRAZING_M && incidence >= MIN_GRAZING && tolerance_m <= GRAZING_OFF_M) {
            return false;
        }
        let last = self.hits.len() - 1;
        let before = if beam > 0 { Some(beam - 1) } else { is_closed.then_some(last) };
        let after = if next < last { Some(next + 1) } else { is_closed.then_some(0) };
        let continues = |third: Option<usize>, way: &dyn Fn(Point2<f64>) -> Vector2<f64>| {
            third.and_then(|third| self.hits[third]).is_some_and(|third| {
                let way = way(third);
                let along_m = way.dot(&line);
                along_m > 0.0 && along_m < GRAZING_M && way.perp(&line).abs() < tolerance_m
            })
        };
        continues(before, &|third| a - third) || continues(after, &|third| third - b)
    }

    /// Running sums, so that a line through any run of points costs the same. Twice around, so that a run may pass the
    /// last beam.
    fn sum(&mut self) {
        self.sums.clear();
        self.sums.push(Moments::default());
        let mut sum = Moments::default();
        for hit in self.hits.iter().chain(&self.hits) {
            if let Some(point) = hit {
                sum = sum.plus(point);
            }
            self.sums.push(sum);
        }
    }

    fn point(&self, beam: usize, scan: &Scan, is_closed: bool, rules: &PointRules) -> Option<ScanPoint> {
        let at = self.hits[beam]?;
        let beams = self.hits.len();
        let range_m = f64::from(scan.ranges_m[beam]);
        let spacing_m = (range_m * scan.angle_increment_rad.abs()).max(1e-6);
        let reach = ((NORMAL_REACH_M / spacing_m) as usize).clamp(1, (beams / 4 + 1).min(MAX_NEIGHBORS));
        // How far the surface goes on to both sides. As the beams hit it aslant, the reach in beams is less.
        let before = self.run(beam, reach, is_closed, &at, false);
        let after = self.run(beam, reach, is_closed, &at, true);
        work::count(before + after);
        if before == 0 || after == 0 {
            return None; // an edge
        }
        // In the doubled list of sums, `beam + beams` is the same beam.
        let middle = if beam >= before { beam } else { beam + beams };
        let moments = self.sums[middle + after + 1].minus(&self.sums[middle - before]);
        let (normal, mean_square) = moments.line()?;
        let tolerance_m = STRAIGHT_STDS * rules.noise_m + STRAIGHT_M;
        if mean_square > tolerance_m * tolerance_m {
            return None; // a corner, or a curved or rough surface
        }
        let toward = -(at - Point2::from(self.origin()));
        let normal = if normal.dot(&toward) < 0.0 { -normal } else { normal };
        let incidence = normal.dot(&toward) / range_m;
        let arc_m = spacing_m / incidence.max(0.2);
        let weight = (arc_m / FULL_WEIGHT_M).min(1.0);
        let noise_share = if rules.grazing { incidence.max(MIN_GRAZING) } else { 1.0 };
        Some(ScanPoint { weight, noise_share, beam, ..ScanPoint::new(at, normal) })
    }

    fn origin(&self) -> Vector2<f64> {
        self.directions.geometry.map_or(Vector2::zeros(), |(.., mount)| mount.translation.vector)
    }

    /// The number of neighbors on the same surface in one direction, up to `reach` and up to the reach of normals.
    fn run(&self, beam: usize, reach: usize, is_closed: bool, at: &Point2<f64>, forward: bool) -> usize {
        let beams = self.hits.len();
        let mut here = beam;
        for steps in 0..reach {
            let next = match forward {
                true if here + 1 < beams => here + 1,
                true if is_closed => 0,
                false if here > 0 => here - 1,
                false if is_closed => beams - 1,
                _ => return steps,
            };
            let is_joined = self.joined[if forward { here } else { next }];
            let is_near = self.hits[next]
                .is_some_and(|hit| (hit - at).norm_squared() <= NORMAL_REACH_M * NORMAL_REACH_M);
            if !is_joined || steps > 0 && !is_near {
                return steps;
            }
            here = next;
        }
        reach
    }
}

/// The values of points, in the mean over the neighbors of each on the same surface.
pub(crate) fn means(points: &[ScanPoint], values: &[Option<f64>]) -> Vec<Option<f64>> {
    let mean = |at: usize| {
        values[at]?;
        let (mut sum, mut count) = (0.0, 0.0);
        for other in at.saturating_sub(AVERAGED)..(at + AVERAGED + 1).min(points.len()) {
            let is_same = points[at].normal.dot(&points[other].normal) > SAME_SURFACE
                && (points[at].at - points[other].at).norm() < JUDGED_M;
            if let (true, Some(value)) = (is_same, values[other]) {
                sum += value;
                count += 1.0;
            }
        }
        Some(sum / count)
    };
    (0..points.len()).map(mean).collect()
}

// Lines through runs of points, from sums that are subtracted from each other.

/// The sums of the coordinates, and of their products, of a run of points.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    count: f64,
    sum: Vector2<f64>,
    products: Matrix2<f64>,
}

impl Moments {
    fn plus(mut self, point: &Point2<f64>) -> Self {
        self.count += 1.0;
        self.sum += point.coords;
        self.products += point.coords * point.coords.transpose();
        self
    }

    fn minus(&self, other: &Self) -> Self {
        let (sum, products) = (self.sum - other.sum, self.products - other.products);
        Self { count: self.count - other.count, sum, products }
    }

    /// The unit normal of the line through the points (total least squares), and the mean square distance from it.
    fn line(&self) -> Option<(Vector2<f64>, f64)> {
        let mean = self.sum / self.count;
        let spread = self.products / self.count - mean * mean.transpose();
        let (xx, xy, yy) = (spread[(0, 0)], spread[(0, 1)], spread[(1, 1)]);
        let (half_sum, half_difference) = ((xx + yy) / 2.0, (xx - yy) / 2.0);
        let root = (half_difference * half_difference + xy * xy).sqrt();
        // The direction along the line is the eigenvector of the larger eigenvalue, half_sum + root.
        let along = if half_difference >= 0.0 {
            Vector2::new(half_difference + root, xy)
        } else {
            Vector2::new(xy, root - half_difference)
        };
        let length = along.norm();
        (length > 1e-12).then(|| (Vector2::new(-along.y, along.x) / length, (half_sum - root).max(0.0)))
    }
}
