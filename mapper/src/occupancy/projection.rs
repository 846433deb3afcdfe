//! Projection: scan and pose → beams in the frame of the map, with the meaning of ROS `laser_geometry` and REP-117.

use interfaces::{APPROXIMATE_ATAN2_ERROR_RAD, FARTHEST_M, LaserReading, Scan, approximate_atan2};
use nalgebra::{Point2, UnitComplex, Vector2};
use std::f64::consts::TAU;

/// The result of one beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BeamReturn {
    /// A surface at this range, m.
    Hit(f64),
    /// No surface up to this range, m.
    Clear(f64),
    /// No information: the range is invalid, too close, or out of the limits of the sensor.
    Nothing,
}

impl BeamReturn {
    /// The range up to which the beam was certainly free, m.
    pub fn clear_m(self) -> f64 {
        match self {
            Self::Hit(range_m) | Self::Clear(range_m) => range_m,
            Self::Nothing => 0.0,
        }
    }

    fn of(range_m: f32, scan: &Scan) -> Self {
        let (range_m, invalid) = (f64::from(range_m), range_m);
        if range_m == f64::INFINITY {
            Self::Clear(scan.range_max_m.min(FARTHEST_M))
        } else if range_m >= scan.range_min_m && range_m <= scan.range_max_m.min(FARTHEST_M) {
            Self::Hit(range_m)
        } else {
            match Scan::free_m(invalid) {
                0.0 => Self::Nothing, // also −∞
                clear_m => Self::Clear(clear_m),
            }
        }
    }
}

/// The beams of one scan in the frame of the map.
#[derive(Clone, Debug, Default)]
pub struct ProjectedScan {
    /// The start of all beams, m.
    pub origin: Point2<f64>,
    /// Unit vectors in the direction of each beam.
    pub directions: Vec<Vector2<f64>>,
    /// The result of each beam.
    pub returns: Vec<BeamReturn>,
    /// Whether the last of three or more beams is a neighbor of the first.
    pub is_full_turn: bool,
    /// The angle between neighboring beams, rad; positive.
    pub spacing_rad: f64,
    rotation: UnitComplex<f64>,
    angle_min_rad: f64,
    /// The angle from one beam to the next, counter-clockwise, rad.
    pub increment_rad: f64,
    /// The directions of the beams in the frame of the laser, reused for the next scan.
    in_laser: Vec<Vector2<f64>>,
}

impl ProjectedScan {
    /// Replaces the scan by the scan of `reading`.
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
                .map(|beam| interfaces::rotation(scan.angle_rad(beam)) * Vector2::x())
                .collect();
        }
        self.rotation = laser.rotation;
        self.origin = Point2::from(laser.translation.vector);
        // Two beams enclose no area, whatever the angle between them.
        self.is_full_turn = scan.is_full_turn() && scan.ranges_m.len() > 2;
        self.spacing_rad = scan.angle_increment_rad.abs();
        self.directions.clear();
        self.directions.extend(self.in_laser.iter().map(|direction| laser.rotation * direction));
        self.returns.clear();
        self.returns.extend(scan.ranges_m.iter().map(|&range_m| BeamReturn::of(range_m, scan)));
    }

    /// The number of beams.
    #[allow(clippy::len_without_is_empty)] // an empty scan needs no special care
    pub fn len(&self) -> usize {
        self.returns.len()
    }

    /// The point `range_m` along a beam, m.
    pub fn point(&self, beam: usize, range_m: f64) -> Point2<f64> {
        self.origin + self.directions[beam] * range_m
    }

    /// The end point of a beam that hit something, m; `None` for other beams.
    pub fn hit(&self, beam: usize) -> Option<Point2<f64>> {
        match self.returns[beam] {
            BeamReturn::Hit(range_m) => Some(self.point(beam, range_m)),
            _ => None,
        }
    }

    /// The next beam; `None` after the last beam of a scan that is not a full turn.
    pub fn next(&self, beam: usize) -> Option<usize> {
        match beam + 1 {
            next if next < self.len() => Some(next),
            _ if self.is_full_turn => Some(0),
            _ => None,
        }
    }

    /// The two neighboring beams that enclose the direction toward `point`, or `None` outside
    /// of the field of view.
    pub fn enclosing(&self, point: &Point2<f64>) -> Option<(usize, usize)> {
        let beams = self.len();
        if beams < 2 {
            return None;
        }
        let toward = self.rotation.inverse() * (point - self.origin);
        let sweep = if self.increment_rad < 0.0 { -1.0 } else { 1.0 };
        let turn_rad = sweep * (approximate_atan2(toward.y, toward.x) - self.angle_min_rad);
        let turn_rad = turn_rad - TAU * (turn_rad / TAU).floor();
        // Just before the first beam counts as on the first beam: the approximate angle can be a little too small.
        let turn_rad = if turn_rad > TAU - APPROXIMATE_ATAN2_ERROR_RAD { 0.0 } else { turn_rad };
        let guess = ((turn_rad / self.spacing_rad) as usize).min(beams);
        // The exact cross products correct the approximate result.
        let off = 1 + ((APPROXIMATE_ATAN2_ERROR_RAD / self.spacing_rad) as usize).min(beams - 1);
        let lies_after = |beam: usize| sweep * self.in_laser[beam].perp(&toward) >= 0.0;
        (guess + beams.saturating_sub(off)..=guess + beams + off).find_map(|candidate| {
            let beam = if self.is_full_turn { candidate % beams } else { candidate.checked_sub(beams)? };
            let next = (beam < beams).then(|| self.next(beam))??;
            (lies_after(beam) && !lies_after(next)).then_some((beam, next))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Twist;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn reading(ranges_m: Vec<f32>) -> LaserReading {
        LaserReading {
            time_s: 0.0,
            pose: interfaces::pose(1.0, 2.0, FRAC_PI_2),
            twist: Twist::STOP,
            velocities: Vec::new(),
            mount: interfaces::pose(0.1, 0.0, 0.0),
            scan: Scan {
                angle_min_rad: 0.0,
                angle_increment_rad: TAU / ranges_m.len() as f64,
                range_min_m: 0.1,
                range_max_m: 5.0,
                sweep_s: 0.0,
                ranges_m,
            },
        }
    }

    #[test]
    fn a_hit_lands_where_pose_and_mount_put_it() {
        let mut scan = ProjectedScan::default();
        scan.project(&reading(vec![2.0; 4]));
        // The robot looks up, so its first beam starts 0.1 m above it.
        let expected = Point2::new(1.0, 2.0 + 0.1 + 2.0);
        assert!((scan.hit(0).unwrap() - expected).norm() < 1e-12);
    }

    proptest::proptest! {
        /// The reference is the exact angle, for scans with any number of beams, in both directions.
        #[test]
        fn enclosing_beams_enclose(beams in 3usize..2000, share in 0.1f64..=1.0, start in -PI..PI,
                                   clockwise: bool, bearing in -PI..PI, distance_m in 0.01f64..30.0) {
            let mut reading = reading(vec![2.0; beams]);
            let sweep = if clockwise { -1.0 } else { 1.0 };
            reading.scan.angle_min_rad = start;
            reading.scan.angle_increment_rad = sweep * share * TAU / beams as f64;
            let mut scan = ProjectedScan::default();
            scan.project(&reading);
            let laser = reading.pose * reading.mount;
            let point = laser * (interfaces::rotation(bearing) * Point2::new(distance_m, 0.0));
            let turn = (sweep * (bearing - start)).rem_euclid(TAU) / scan.spacing_rad;
            let (beam, rest) = (turn.floor() as usize, turn.fract());
            if (1e-6..1.0 - 1e-6).contains(&rest) {
                let last = if scan.is_full_turn { beams } else { beams - 1 };
                let expected = (beam < last).then(|| (beam, (beam + 1) % beams));
                proptest::prop_assert_eq!(scan.enclosing(&point), expected);
            }
        }
    }
}
