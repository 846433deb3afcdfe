//! Whether the robot of a log stands.

use interfaces::Scan;
use nalgebra::Isometry2;

/// A robot whose odometry stays within this distance of its first pose, m, and within this angle, rad, may stand: an
/// odometry with a gyroscope drifts at rest.
pub(crate) const MIN_MOTION_M: f64 = 0.02;
pub(crate) const MIN_MOTION_RAD: f64 = 0.02;
/// A note on an odometry that does not move, while the scans change.
const NO_MOTION: &str = "the odometry stands still, and the scans do not: the way is that of the scans alone";
/// The same where the scans do not show whether the laser moves.
const UNKNOWN_MOTION: &str = "the odometry stands still, and too few ranges of the scans can be compared to tell whether \
                                         the robot does: the way is that of the scans alone";
/// Two ranges of one beam agree if they differ by less than this, m, and this share of the range: more than a laser
/// errs by, and less than people and robots move.
const SAME_M: f64 = 0.1;
const SAME_SHARE: f64 = 0.02;
/// Two scans are compared if at least this number of beams has a range in both of them; of a laser with few beams, half of them.
const MIN_BEAMS: usize = 20;
/// At least this share of the scans must be compared: a laser that sees too little does not show that it stands.
const MIN_COMPARED: f64 = 0.5;
/// In a scan of a laser that stands, at least this share of the ranges agree with the first scan: people hide the rest.
const MIN_SHARE: f64 = 0.5;
/// This share of the scans may be worse: somebody stands before the laser.
const MAX_WORSE: f64 = 0.1;
/// Lasers beyond this number are not compared.
const MAX_LASERS: usize = 8;
/// Scans are of one laser if their numbers of beams differ by at most this share, and their first beams by this number of beams:
/// some lasers turn at another speed each time.
const MAX_OTHER_BEAMS: f64 = 0.2;
const MAX_SHIFTED_BEAMS: f64 = 10.0;

/// Compares the scans of a log with the first scan of the same laser that sees enough.
#[derive(Debug, Default)]
pub(crate) struct Standing {
    first: Vec<(Isometry2<f64>, Scan)>,
    /// The number of scans without the first ones, of those that were compared, and of those that differ.
    scans: usize,
    compared: usize,
    worse: usize,
}

impl Standing {
    /// Adds the next scan of a laser with this pose on the robot.
    pub(crate) fn add(&mut self, mount: &Isometry2<f64>, scan: &Scan) {
        let ranges_m = &scan.ranges_m;
        let min_beams = MIN_BEAMS.min(ranges_m.len() / 2).max(1);
        let is_same =
            |(known, first): &&(Isometry2<f64>, Scan)| known == mount && are_of_one_laser(first, scan);
        let Some((_, first)) = self.first.iter().find(is_same) else {
            let valid = ranges_m.iter().filter(|range_m| is_valid(**range_m)).count();
            if self.first.len() < MAX_LASERS && valid >= min_beams {
                self.first.push((*mount, scan.clone()));
            } else {
                self.scans += 1;
            }
            return;
        };
        self.scans += 1;
        let (mut all, mut same) = (0_usize, 0_usize);
        for (a, b) in same_directions(first, scan).filter(|(a, b)| is_valid(*a) && is_valid(*b)) {
            let (a, b) = (f64::from(a), f64::from(b));
            all += 1;
            same += usize::from((a - b).abs() < SAME_M + SAME_SHARE * a);
        }
        if all >= min_beams {
            self.compared += 1;
            self.worse += usize::from((same as f64) < MIN_SHARE * all as f64);
        }
    }

    /// Whether the scans look as if they were all taken from one pose.
    pub(crate) fn looks_so(&self) -> bool {
        self.is_known() && self.worse as f64 <= MAX_WORSE * self.compared as f64
    }

    fn is_known(&self) -> bool {
        self.compared as f64 >= MIN_COMPARED * self.scans as f64
    }

    /// The note on an odometry that does not move, of a robot that does not look as if it stood.
    pub(crate) fn note(&self) -> &'static str {
        if self.is_known() { NO_MOTION } else { UNKNOWN_MOTION }
    }
}

fn are_of_one_laser(first: &Scan, scan: &Scan) -> bool {
    let [n, other] = [first, scan].map(|scan| scan.ranges_m.len() as f64);
    let shift_rad = (first.angle_min_rad - scan.angle_min_rad).abs();
    (n - other).abs() <= MAX_OTHER_BEAMS * n
        && step_rad(first) * step_rad(scan) > 0.0
        && shift_rad <= MAX_SHIFTED_BEAMS * step_rad(first).abs()
}

/// The angle between two beams, rad; of a laser with one beam, which may declare none, anything.
fn step_rad(scan: &Scan) -> f64 {
    if scan.angle_increment_rad == 0.0 { 1.0 } else { scan.angle_increment_rad }
}

/// The ranges of two scans in the directions of the second one.
fn same_directions(first: &Scan, scan: &Scan) -> impl Iterator<Item = (f32, f32)> {
    let beams = scan.ranges_m.iter().enumerate();
    beams.filter_map(|(beam, range_m)| {
        let angle_rad = scan.angle_min_rad + beam as f64 * step_rad(scan);
        let known = ((angle_rad - first.angle_min_rad) / step_rad(first)).round();
        let is_known = known >= 0.0 && known < first.ranges_m.len() as f64;
        is_known.then(|| (first.ranges_m[known as usize], *range_m))
    })
}

fn is_valid(range_m: f32) -> bool {
    range_m.is_finite() && range_m > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A scan all around, whatever the number of beams.
    fn scan(ranges_m: Vec<f32>) -> Scan {
        let angle_increment_rad = if ranges_m.len() > 1 { TAU / ranges_m.len() as f64 } else { 0.0 };
        Scan { angle_increment_rad, range_max_m: 80.0, ranges_m, ..Scan::default() }
    }

    /// Whether a laser seems to stand whose scans have these ranges.
    fn stands(scans: impl IntoIterator<Item = Vec<f32>>) -> bool {
        let mut standing = Standing::default();
        scans.into_iter().for_each(|ranges_m| standing.add(&Isometry2::identity(), &scan(ranges_m)));
        standing.looks_so()
    }

    /// 40 scans of this number of beams, of a robot that moves by this much per scan, m.
    fn room(beams: usize, step_m: f32) -> Vec<Vec<f32>> {
        (0..40).map(|scan| vec![2.0 + step_m * scan as f32; beams]).collect()
    }

    #[test]
    fn a_laser_stands_if_most_scans_are_as_the_first_one_that_sees() {
        for beams in [1, 8, 30, 57, 180, 720] {
            assert!(stands(room(beams, 0.0)) && !stands(room(beams, 0.1)), "{beams}");
            // A laser sees nothing while it starts.
            for blind in [0.0, f32::NAN, f32::INFINITY] {
                let starts = |step_m| [vec![blind; beams]].into_iter().chain(room(beams, step_m));
                assert!(stands(starts(0.0)) && !stands(starts(0.1)), "{beams} {blind}");
            }
        }
        assert!(stands([]) && stands(room(180, 0.1).into_iter().take(1)));
    }

    #[test]
    fn scans_that_cannot_be_compared_show_nothing() {
        let few = |scan: usize| {
            (0..180).map(|beam| if beam % 20 == scan % 20 { 2.0 } else { f32::NAN }).collect::<Vec<f32>>()
        };
        assert!(!stands((0..40).map(few)));
        // The mount is another one each time.
        let mut standing = Standing::default();
        for turn in 0..40 {
            standing.add(&interfaces::pose(0.0, 0.0, 0.1 * f64::from(turn)), &scan(vec![2.0; 180]));
        }
        assert!(!standing.looks_so());
    }

    /// A laser in a square room of 6 m, 1 m from its middle, that moves by this much per scan, m; the number of its beams is another
    /// one each time.
    #[test]
    fn a_laser_stands_also_if_its_number_of_beams_changes() {
        let scans = |step_m: f64| {
            (0..40).map(move |scan| {
                let beams = 400 + (17 * scan) % 40;
                let at_m = 1.0 + step_m * scan as f64;
                let range_m = |beam: i32| {
                    let (sin, cos) = (TAU * f64::from(beam) / f64::from(beams)).sin_cos();
                    let ahead_m = if cos > 0.0 { 3.0 - at_m } else { 3.0 + at_m };
                    (ahead_m / cos.abs()).min(3.0 / sin.abs()) as f32
                };
                (0..beams).map(range_m).collect()
            })
        };
        assert!(stands(scans(0.0)) && !stands(scans(0.05)));
    }
}
