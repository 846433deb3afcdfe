//! Whether the robot of a log stands.

use interfaces::Scan;
use nalgebra::Isometry2;

/// A robot whose odometry stays within this distance of its first pose, m, and within this angle, rad, may stand: an
/// odometry with a gyroscope drifts at rest.
pub(crate) const MIN_MOTION_M: f64 = 0.02;
pub(crate) const MIN_MOTION_RAD: f64 = 0.02;
/// A note on an odometry that does not move, while the scans change.
pub(crate) const NO_MOTION: &str =
    "the odometry stands still, and the scans do not: the way is that of the scans alone";
/// Two ranges of one beam agree if they differ by less than this, m, and this share of the range: more than a laser
/// errs by, and less than people and robots move.
const SAME_M: f64 = 0.1;
const SAME_SHARE: f64 = 0.02;
/// One beam in three is compared, and at least this number of them must have a range in both scans.
const BEAM_STEP: usize = 3;
const MIN_BEAMS: usize = 20;
/// In a scan of a laser that stands, at least this share of the ranges agree with the first scan: people hide the rest.
const MIN_SHARE: f64 = 0.5;
/// This share of the scans may be worse: somebody stands before the laser.
const MAX_WORSE: f64 = 0.1;
/// Lasers beyond this number are not compared.
const MAX_LASERS: usize = 8;

/// Compares the scans of a log with the first scan of the same laser.
#[derive(Debug, Default)]
pub(crate) struct Standing {
    first: Vec<(Isometry2<f64>, Vec<f32>)>,
    compared: usize,
    worse: usize,
}

impl Standing {
    /// Adds the next scan of a laser with this pose on the robot.
    pub(crate) fn add(&mut self, mount: &Isometry2<f64>, scan: &Scan) {
        let ranges_m = &scan.ranges_m;
        let is_same =
            |(known, first): &&(Isometry2<f64>, Vec<f32>)| known == mount && first.len() == ranges_m.len();
        let Some((_, first)) = self.first.iter().find(is_same) else {
            if self.first.len() < MAX_LASERS {
                self.first.push((*mount, ranges_m.clone()));
            }
            return;
        };
        let pairs = first.iter().zip(ranges_m).step_by(BEAM_STEP);
        let pairs = pairs.map(|(a, b)| (f64::from(*a), f64::from(*b)));
        let valid = pairs.filter(|(a, b)| a.is_finite() && b.is_finite() && *a > 0.0 && *b > 0.0);
        let (mut all, mut same) = (0_usize, 0_usize);
        for (a, b) in valid {
            all += 1;
            same += usize::from((a - b).abs() < SAME_M + SAME_SHARE * a);
        }
        if all >= MIN_BEAMS {
            self.compared += 1;
            self.worse += usize::from((same as f64) < MIN_SHARE * all as f64);
        }
    }

    /// Whether the scans look as if they were all taken from one pose.
    pub(crate) fn looks_so(&self) -> bool {
        self.worse as f64 <= MAX_WORSE * self.compared as f64
    }
}
