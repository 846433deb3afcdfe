//! Deskews scans: a laser that turns measures each beam from a pose of its own. The result is a scan whose beams all start
//! at the pose of its end.

use crate::constants::{MINOR, THICK_M};
use crate::scan_path::ScanPath;
use crate::scan_points::{Directions, PointRules, ScanPoint, ScanPoints};
use crate::work;
use interfaces::{LaserReading, Scan, approximate_atan2, wrap_rad};
use nalgebra::{Isometry2, Point2, Vector2};

/// Deskews scans, and makes points of them.
#[derive(Clone, Debug)]
pub(crate) struct Deskew {
    rules: PointRules,
    points: ScanPoints,
    directions: Directions,
}

impl Deskew {
    pub(crate) fn new(rules: PointRules) -> Self {
        Self { rules, points: ScanPoints::default(), directions: Directions::default() }
    }

    /// Replaces the scan of `deskewed` by that of `reading` with all beams from the pose at its end, after a robot that
    /// moved by `motion` in the time `elapsed_s`. Returns the points of this scan.
    pub(crate) fn update(
        &mut self,
        deskewed: &mut LaserReading,
        reading: &LaserReading,
        motion: &Isometry2<f64>,
        elapsed_s: f64,
    ) -> Vec<ScanPoint> {
        match ScanPath::of_sweep(reading, motion, elapsed_s) {
            Some(path) => {
                deskewed.scan = deskewed_scan(&mut self.directions, reading, &path);
                let passed = |beam| path.passed(reading.scan.age_s(beam));
                self.points.of(deskewed, passed, &self.rules)
            }
            None => self.points.of(deskewed, |_| 1.0, &self.rules),
        }
    }
}

/// The poses of the source, taken as they are. Scans are deskewed with them, the first scan with its velocities.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub struct GivenPoses {
    /// The time and the pose of the last reading.
    last: Option<(f64, Isometry2<f64>)>,
    #[serde(skip)]
    directions: Directions,
}

impl GivenPoses {
    /// The reading with a scan whose beams all belong to its pose.
    pub fn deskewed(&mut self, mut reading: LaserReading) -> LaserReading {
        let (motion, elapsed_s) = match self.last.replace((reading.time_s, reading.pose)) {
            Some((last_s, last)) => (last.inv_mul(&reading.pose), reading.time_s - last_s),
            None => ScanPath::by_velocities(&reading),
        };
        if let Some(path) = ScanPath::of_sweep(&reading, &motion, elapsed_s) {
            reading.scan = deskewed_scan(&mut self.directions, &reading, &path);
        }
        reading
    }
}

/// The scan of a reading, with all beams from its pose, after a robot on a path.
pub(crate) fn deskewed_scan(directions: &mut Directions, reading: &LaserReading, path: &ScanPath) -> Scan {
    let (scan, mount, to_laser) = (&reading.scan, reading.mount, reading.mount.inverse());
    directions.update(scan, &Isometry2::identity());
    deskew(scan, &directions.units, |left| to_laser * path.at(left * scan.sweep_s) * mount)
}

/// The end point of a beam in the frame of the laser at the end of the sweep.
#[derive(Clone, Copy)]
struct End {
    at: Point2<f64>,
    angle_rad: f64,
    range_m: f32,
}

/// The scan as the laser would measure it at once, at the end of the sweep. `laser_before` gives the pose of the laser in
/// its frame at the end of the sweep, where a share of the sweep is left. Directions that no beam covers are NaN.
fn deskew(scan: &Scan, units: &[Vector2<f64>], laser_before: impl Fn(f64) -> Isometry2<f64>) -> Scan {
    let beams = scan.ranges_m.len();
    if beams < 3 {
        return scan.clone();
    }
    let end = |beam: usize| {
        let left = 1.0 - beam as f64 / (beams - 1) as f64;
        let range_m = scan.ranges_m[beam];
        // A beam without a return is a direction.
        let length_m = if range_m.is_finite() { f64::from(range_m).max(1e-3) } else { scan.range_max_m };
        let at = laser_before(left) * Point2::from(units[beam] * length_m);
        End { at, angle_rad: approximate_atan2(at.y, at.x), range_m }
    };
    let mut ranges_m = vec![f32::NAN; beams];
    let first = end(0);
    let mut before = first;
    for beam in 1..beams {
        let after = end(beam);
        cover(scan, units, &before, &after, &mut ranges_m);
        before = after;
    }
    // Between the last and the first beam of a full turn lie a gap or an overlap, by the turn of the robot. The neighbors of a gap of
    // one beam fill it.
    let gap_rad = wrap_rad(first.angle_rad - before.angle_rad).abs();
    if scan.is_full_turn() && gap_rad < 2.0 * scan.angle_increment_rad.abs() {
        cover(scan, units, &before, &first, &mut ranges_m);
    }
    Scan { ranges_m, ..*scan }
}

/// Writes the ranges of the directions from one end point to the next.
fn cover(scan: &Scan, units: &[Vector2<f64>], from: &End, to: &End, ranges_m: &mut [f32]) {
    let (increment, beams) = (scan.angle_increment_rad, ranges_m.len());
    let sign = increment.signum();
    let span = sign * wrap_rad(to.angle_rad - from.angle_rad) / increment.abs();
    if span <= 0.0 {
        return; // hidden behind the point before
    }
    let turns = std::f64::consts::TAU / increment.abs();
    let first = sign * (from.angle_rad - scan.angle_min_rad) / increment.abs();
    let first = first - turns * libm::floor(first / turns);
    // The approximate angle of a beam that did not move may be a little beside its direction.
    let beside = 0.02;
    let (low, high) = (libm::ceil(first - beside), first + span + beside);
    // Beyond two turns of the beams there are none, however small the angle between two of them is said to be.
    let high = high.min(2.0 * beams as f64);
    let mut direction = low;
    while direction <= high {
        work::count(1);
        let index = direction as usize;
        let index = if index >= beams && scan.is_full_turn() { index - beams } else { index };
        if let Some(range_m) = ranges_m.get_mut(index) {
            let share = (direction - first) / span;
            *range_m = between(&units[index], from, to, share);
        }
        direction += 1.0;
    }
}

/// The range in the direction of a unit vector between two end points.
fn between(along: &Vector2<f64>, from: &End, to: &End, share: f64) -> f32 {
    let nearer = if share < 0.5 { from } else { to };
    let are_hits = from.range_m.is_finite() && to.range_m.is_finite();
    let edge = to.at - from.at;
    if are_hits && edge.norm_squared() < THICK_M * THICK_M {
        let range_m = from.at.coords.perp(&edge) / along.perp(&edge);
        let middle_m = from.at.coords.norm().midpoint(to.at.coords.norm());
        if (range_m - middle_m).abs() < THICK_M {
            return range_m as f32;
        }
    }
    if share.min(1.0 - share) > MINOR && (are_hits || from.range_m != to.range_m) {
        return f32::NAN;
    }
    if nearer.range_m.is_finite() { nearer.at.coords.norm() as f32 } else { nearer.range_m }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Twist, VelocitySample, pose};
    use std::f64::consts::TAU;

    /// The range from a pose to the walls of a square room of 6 m around the origin.
    fn range_m(pose: &Isometry2<f64>, angle_rad: f64) -> f64 {
        let along = pose.rotation * interfaces::rotation(angle_rad) * Vector2::x();
        let to = |at: f64, along: f64| {
            if along == 0.0 { f64::INFINITY } else { (3.0 * along.signum() - at) / along }
        };
        to(pose.translation.x, along.x).min(to(pose.translation.y, along.y))
    }

    fn scan(ranges_m: Vec<f32>) -> Scan {
        Scan {
            angle_min_rad: -TAU / 2.0,
            angle_increment_rad: TAU / ranges_m.len() as f64,
            range_max_m: 10.0,
            sweep_s: 0.1,
            ranges_m,
            ..Scan::default()
        }
    }

    fn deskewed(scan: &Scan, laser_before: impl Fn(f64) -> Isometry2<f64>) -> Scan {
        let mut directions = Directions::default();
        directions.update(scan, &Isometry2::identity());
        deskew(scan, &directions.units, laser_before)
    }

    #[test]
    fn a_swept_scan_becomes_one_from_the_end() {
        let beams = 720;
        for (x, y, turn) in [(-0.05, 0.0, 0.0), (-0.04, 0.01, 0.2), (0.0, 0.0, -0.25)] {
            let at = |beam: usize| {
                let left = 1.0 - beam as f64 / (beams - 1) as f64;
                pose(x * left, y * left, turn * left)
            };
            let empty = scan(vec![0.0; beams]);
            let range = |beam: usize| range_m(&at(beam), empty.angle_rad(beam)) as f32;
            let deskewed = deskewed(&scan((0..beams).map(range).collect()), |left| {
                pose(x * left, y * left, turn * left)
            });
            let missing = deskewed.ranges_m.iter().filter(|range_m| range_m.is_nan()).count();
            assert!(missing <= (turn.abs() / TAU * beams as f64) as usize + 3, "{missing} missing");
            for (beam, found_m) in
                deskewed.ranges_m.iter().enumerate().filter(|(_, range_m)| !range_m.is_nan())
            {
                let expected_m = range_m(&Isometry2::identity(), empty.angle_rad(beam));
                let error_m = (f64::from(*found_m) - expected_m).abs();
                // A corner between two beams is cut off.
                assert!(error_m < 0.02, "beam {beam}: {found_m} m instead of {expected_m} m");
            }
        }
    }

    #[test]
    fn an_accelerating_robot_has_a_scan_from_the_end() {
        let (beams, elapsed_s, acceleration_mps2, acceleration_radps2) = (720, 0.1, 1.0, 4.0);
        // The pose a time before the end, in the frame of the end: from rest at the last reading to full speed.
        let before = |back_s: f64| {
            let traveled = |acceleration: f64| 0.5 * acceleration * (elapsed_s - back_s).powi(2);
            let back = |acceleration: f64| traveled(acceleration) - 0.5 * acceleration * elapsed_s.powi(2);
            pose(back(acceleration_mps2), 0.0, back(acceleration_radps2))
        };
        let empty = scan(vec![0.0; beams]);
        let range = |beam: usize| {
            let left = 1.0 - beam as f64 / (beams - 1) as f64;
            range_m(&before(left * empty.sweep_s), empty.angle_rad(beam)) as f32
        };
        // The velocities are those of wheels with a gain.
        let sample = |number: u32| {
            let share = f64::from(number) / 5.0;
            let mean = 1.05 * (share - 0.1) * elapsed_s;
            VelocitySample {
                time_s: 0.9 + share * elapsed_s,
                twist: Twist {
                    linear_mps: acceleration_mps2 * mean,
                    angular_radps: acceleration_radps2 * mean,
                },
            }
        };
        let reading = LaserReading {
            time_s: 1.0,
            velocities: (1..=5).map(sample).collect(),
            scan: scan((0..beams).map(range).collect()),
            ..LaserReading::default()
        };
        let path = ScanPath::of_sweep(&reading, &before(elapsed_s).inverse(), elapsed_s).unwrap();
        let deskewed = deskewed_scan(&mut Directions::default(), &reading, &path);
        let errors_m = (0..beams).filter(|&beam| !deskewed.ranges_m[beam].is_nan()).map(|beam| {
            (f64::from(deskewed.ranges_m[beam]) - range_m(&Isometry2::identity(), empty.angle_rad(beam)))
                .abs()
        });
        let errors_m: Vec<f64> = errors_m.collect();
        assert!(errors_m.len() > beams - 8, "{} beams", errors_m.len());
        // The four corners between two beams are cut off.
        let large = errors_m.iter().filter(|error_m| **error_m > 1e-3).count();
        assert!(large <= 4 && errors_m.iter().all(|error_m| *error_m < 0.02), "{large} errors");
    }

    #[test]
    fn a_robot_at_rest_keeps_its_scan() {
        let ranges_m = [1.0, 2.0, f32::INFINITY, f32::NAN, f32::NEG_INFINITY, 3.0, 3.0, 3.0].to_vec();
        let scan = scan(ranges_m.clone());
        let deskewed = deskewed(&scan, |_| Isometry2::identity());
        for (before, after) in ranges_m.iter().zip(&deskewed.ranges_m) {
            let is_same = (before - after).abs() < 1e-5 || before.to_bits() == after.to_bits();
            assert!(is_same, "{before} became {after}");
        }
    }
}
