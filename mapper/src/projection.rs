//! Scan and pose → point cloud, with the meaning of ROS `laser_geometry` and REP-117.

use geometry::{LaserReading, Scan};
use nalgebra::{Isometry2, Point2, UnitComplex, Vector2};

/// What one beam tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Return {
    /// A surface at this range, m.
    Hit(f64),
    /// Nothing up to this range, m.
    Clear(f64),
    /// Nothing at all: invalid, too close, or out of the sensor's limits.
    Nothing,
}

impl Return {
    /// How far the beam is known to have passed, m.
    pub(crate) fn clear_m(self) -> f64 {
        match self {
            Self::Hit(range_m) | Self::Clear(range_m) => range_m,
            Self::Nothing => 0.0,
        }
    }

    fn of(range_m: f32, scan: &Scan) -> Self {
        let range_m = f64::from(range_m);
        if range_m == f64::INFINITY {
            Self::Clear(scan.range_max_m)
        } else if range_m >= scan.range_min_m && range_m <= scan.range_max_m {
            Self::Hit(range_m)
        } else {
            Self::Nothing // also NaN and −∞
        }
    }
}

/// The beams of one scan in the map's frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct PointCloud {
    /// Where the beams start, m.
    pub(crate) origin: Point2<f64>,
    /// Unit vectors along the beams.
    pub(crate) directions: Vec<Vector2<f64>>,
    /// What each beam tells.
    pub(crate) returns: Vec<Return>,
    /// Whether the last beam is a neighbour of the first.
    pub(crate) is_full_turn: bool,
    /// The angle between neighbouring beams, rad; positive.
    pub(crate) spacing_rad: f64,
    mount: Isometry2<f64>,
    rotation: UnitComplex<f64>,
    angle_min_rad: f64,
    /// From one beam to the next, counter-clockwise, rad.
    pub(crate) increment_rad: f64,
    /// The beams' directions in the laser's frame, kept from scan to scan.
    in_laser: Vec<Vector2<f64>>,
}

impl PointCloud {
    /// Replaces the cloud by that of `reading`.
    pub(crate) fn project(&mut self, reading: &LaserReading) {
        let scan = &reading.scan;
        let laser = reading.pose * reading.mount;
        let same_beams = self.in_laser.len() == scan.ranges_m.len()
            && self.angle_min_rad == scan.angle_min_rad
            && self.increment_rad == scan.angle_increment_rad;
        if !same_beams {
            self.angle_min_rad = scan.angle_min_rad;
            self.increment_rad = scan.angle_increment_rad;
            self.in_laser = (0..scan.ranges_m.len())
                .map(|beam| geometry::rotation(scan.angle_rad(beam)) * Vector2::x())
                .collect();
        }
        self.mount = reading.mount;
        self.rotation = laser.rotation;
        self.origin = Point2::from(laser.translation.vector);
        self.is_full_turn = scan.is_full_turn();
        self.spacing_rad = scan.angle_increment_rad.abs();
        self.directions.clear();
        self.directions.extend(self.in_laser.iter().map(|direction| laser.rotation * direction));
        self.returns.clear();
        self.returns.extend(scan.ranges_m.iter().map(|&range_m| Return::of(range_m, scan)));
    }

    /// The number of beams.
    pub(crate) fn len(&self) -> usize {
        self.returns.len()
    }

    /// The point `range_m` along a beam, m.
    pub(crate) fn point(&self, beam: usize, range_m: f64) -> Point2<f64> {
        self.origin + self.directions[beam] * range_m
    }

    /// The end point of a beam that hit something, m.
    pub(crate) fn hit(&self, beam: usize) -> Option<Point2<f64>> {
        match self.returns[beam] {
            Return::Hit(range_m) => Some(self.point(beam, range_m)),
            _ => None,
        }
    }

    /// The beam after this one; `None` after the last of a scan that does not close.
    pub(crate) fn next(&self, beam: usize) -> Option<usize> {
        match beam + 1 {
            next if next < self.len() => Some(next),
            _ if self.is_full_turn => Some(0),
            _ => None,
        }
    }

    /// The two neighbouring beams that enclose the direction towards `point`, or `None` outside
    /// of the field of view.
    pub(crate) fn enclosing(&self, point: &Point2<f64>) -> Option<(usize, usize)> {
        let seen = self.rotation.inverse() * (point - self.origin);
        let turn_rad = geometry::wrap_rad(libm::atan2(seen.y, seen.x) - self.angle_min_rad)
            * self.increment_rad.signum();
        let turn_rad = if turn_rad < 0.0 { turn_rad + std::f64::consts::TAU } else { turn_rad };
        let beam = (turn_rad / self.spacing_rad) as usize;
        // Rounding can put a direction just before the first beam one turn ahead.
        let beam = if self.is_full_turn && beam >= self.len() { self.len() - 1 } else { beam };
        (beam < self.len()).then_some(beam).and_then(|beam| Some((beam, self.next(beam)?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::Twist;
    use std::f64::consts::{FRAC_PI_2, TAU};

    fn reading(ranges_m: Vec<f32>) -> LaserReading {
        LaserReading {
            time_s: 0.0,
            pose: geometry::pose(1.0, 2.0, FRAC_PI_2),
            twist: Twist::STOP,
            mount: geometry::pose(0.1, 0.0, 0.0),
            scan: Scan {
                angle_min_rad: 0.0,
                angle_increment_rad: TAU / ranges_m.len() as f64,
                range_min_m: 0.1,
                range_max_m: 5.0,
                ranges_m,
            },
        }
    }

    #[test]
    fn a_hit_lands_where_pose_and_mount_put_it() {
        let mut cloud = PointCloud::default();
        cloud.project(&reading(vec![2.0; 4]));
        // The robot looks up, so its first beam starts 0.1 m above it.
        let expected = Point2::new(1.0, 2.0 + 0.1 + 2.0);
        assert!((cloud.hit(0).unwrap() - expected).norm() < 1e-12);
    }

    #[test]
    fn ranges_mean_what_rep_117_says() {
        let scan = &reading(vec![1.0; 4]).scan;
        let cases = [
            (f32::INFINITY, Return::Clear(5.0)),
            (f32::NEG_INFINITY, Return::Nothing),
            (f32::NAN, Return::Nothing),
            (0.05, Return::Nothing),
            (-1.0, Return::Nothing),
            (7.0, Return::Nothing),
            (5.0, Return::Hit(5.0)),
        ];
        for (range_m, expected) in cases {
            assert_eq!(Return::of(range_m, scan), expected, "{range_m}");
        }
    }

    #[test]
    fn enclosing_beams_enclose() {
        let mut cloud = PointCloud::default();
        cloud.project(&reading(vec![2.0; 36]));
        for beam in 0..36 {
            let next = cloud.next(beam).unwrap();
            let between = cloud.origin + (cloud.directions[beam] + cloud.directions[next]);
            assert_eq!(cloud.enclosing(&between), Some((beam, next)));
        }
    }
}
