//! Whether scans turn as the poses of a log say.

use crate::error::SurveyError;
use interfaces::{LaserReading, Scan, heading_rad, wrap_rad};
use nalgebra::Isometry2;

/// Scans are compared over turns from and to this angle, rad: a smaller one is within the errors of the odometry, over a
/// larger one little is seen twice.
const MIN_TURN_RAD: f64 = 0.1;
const MAX_TURN_RAD: f64 = 0.8;
/// On which the robot moves less than this, m.
const MAX_TRANSLATION_M: f64 = 0.3;
/// At least this number of beams must have a range in both scans.
const MIN_BEAMS: usize = 40;
/// Differences of ranges count up to this one, m.
const MAX_DIFFERENCE_M: f64 = 1.0;
/// Scans fit one way if their mean difference there is below this share of the other one.
const FITS_SHARE: f64 = 0.6;
/// Beams are mirrored if this number of turns says so, and at least this number of times as many as say the contrary.
const MIN_TURNS: usize = 8;
const TIMES_MORE: usize = 5;

/// Compares scans over turns of the robot.
#[derive(Debug, Default)]
pub(crate) struct Turns {
    /// The last scan of each laser that was compared, the pose of the robot, and that of the laser on it.
    last: Vec<(Isometry2<f64>, Isometry2<f64>, Scan)>,
    with: usize,
    against: usize,
}

impl Turns {
    /// Adds the next reading.
    pub(crate) fn add(&mut self, reading: &LaserReading) {
        let Some(known) = self.last.iter_mut().find(|(_, mount, _)| *mount == reading.mount) else {
            // A laser that pans has as many places as readings.
            self.last.truncate(3);
            self.last.insert(0, (reading.pose, reading.mount, reading.scan.clone()));
            return;
        };
        let motion = known.0.inv_mul(&reading.pose);
        let turn_rad = heading_rad(&motion);
        let is_near = motion.translation.vector.norm() < MAX_TRANSLATION_M;
        if is_near && turn_rad.abs() < MIN_TURN_RAD {
            return;
        }
        if is_near && turn_rad.abs() < MAX_TURN_RAD {
            let way = |turn_rad: f64| difference_m(&known.2, &reading.scan, turn_rad);
            if let Some((with_m, against_m)) = way(turn_rad).zip(way(-turn_rad)) {
                self.with += usize::from(with_m < FITS_SHARE * against_m);
                self.against += usize::from(against_m < FITS_SHARE * with_m);
            }
        }
        *known = (reading.pose, reading.mount, reading.scan.clone());
    }

    /// Checks that the beams are not mirrored.
    pub(crate) fn check(&self) -> Result<(), SurveyError> {
        let Self { with, against, .. } = *self;
        let is_mirrored = against >= MIN_TURNS && against >= TIMES_MORE * with;
        if is_mirrored { Err(SurveyError::Mirrored { against, with }) } else { Ok(()) }
    }
}

/// The mean difference of the ranges of two scans, of which the second was taken after this turn, m. `None` if too few
/// beams can be compared.
fn difference_m(before: &Scan, after: &Scan, turn_rad: f64) -> Option<f64> {
    let (mut sum_m, mut count) = (0.0, 0);
    for (beam, range_m) in after.ranges_m.iter().enumerate() {
        let angle_rad = wrap_rad(after.angle_rad(beam) + turn_rad - before.angle_min_rad);
        // From the first beam on, once around.
        let angle_rad = if before.angle_increment_rad < 0.0 { -angle_rad } else { angle_rad };
        let angle_rad = angle_rad.rem_euclid(std::f64::consts::TAU);
        let same = (angle_rad / before.angle_increment_rad.abs()).round();
        let Some(other_m) = before.ranges_m.get(same as usize) else { continue };
        let difference_m = f64::from(range_m - other_m).abs();
        if difference_m.is_finite() {
            sum_m += difference_m.min(MAX_DIFFERENCE_M);
            count += 1;
        }
    }
    (count >= MIN_BEAMS).then(|| sum_m / f64::from(count as u32))
}
