//! The corrections of another SLAM: steps of the pose that are no motions.

use interfaces::heading_rad;
use nalgebra::{Isometry2, Vector2};

/// A smaller step is rounding, m and rad.
const MIN_M: f64 = 1e-3;
const MIN_RAD: f64 = 1e-3;
/// A larger one is as wide as a wall, m, or moves what is 2 m away by as much, rad: a loop was closed.
const LARGE_M: f64 = 0.1;
const LARGE_RAD: f64 = 0.05;

/// Counts corrections.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Jumps {
    count: usize,
    large: usize,
    /// The largest one, as a multiple of the limits of large ones: m, rad, and its time, s.
    largest: Option<(f64, f64, f64)>,
}

impl Jumps {
    /// Adds a step of the pose of the robot.
    pub(crate) fn add(&mut self, time_s: f64, step: &Isometry2<f64>) {
        let (step_m, step_rad) = (step.translation.vector.norm(), heading_rad(step).abs());
        if step_m < MIN_M && step_rad < MIN_RAD {
            return;
        }
        self.count += 1;
        self.large += usize::from(step_m > LARGE_M || step_rad > LARGE_RAD);
        let size = |step_m: f64, step_rad: f64| (step_m / LARGE_M).max(step_rad / LARGE_RAD);
        if self.largest.is_none_or(|(by_m, by_rad, _)| size(step_m, step_rad) > size(by_m, by_rad)) {
            self.largest = Some((step_m, step_rad, time_s));
        }
    }

    /// How many there were and how large, with times after `begin_s`.
    pub(crate) fn described(&self, begin_s: f64) -> String {
        let Self { count, large, largest } = self;
        let Some((largest_m, largest_rad, at_s)) = largest else {
            return "it has corrected nothing".to_owned();
        };
        let (degrees, at_s) = (largest_rad.to_degrees(), at_s - begin_s);
        let by = format!("by {largest_m:.2} m and {degrees:.1}° at {at_s:.1} s");
        let kept = "a correction is no motion, and scans before it keep their poses";
        match count {
            1 => format!("1 correction, {by}; {kept}"),
            _ => format!(
                "{count} corrections, {large} of them by more than {LARGE_M} m or {LARGE_RAD} rad, the largest {by}; {kept}"
            ),
        }
    }
}

// Whether the speeds that an odometry reports are those of its poses and times.

/// Speeds are compared over pieces of this length, m; at least this number of them.
const PIECE_M: f64 = 0.25;
const MIN_PIECES: usize = 20;
/// Slower steps are rest and noise, m/s; over longer ones, s, a speed says little.
const MIN_MPS: f64 = 0.02;
const MAX_STEP_S: f64 = 2.0;
/// A factor between these is wrong; a larger one is that of another unit of the speeds, which are not used.
const FACTORS: [f64; 2] = [1.5, 30.0];
/// The factor is that of the whole log if this share of the pieces is this near to it.
const MIN_SHARE: f64 = 0.8;
const NEAR: f64 = 0.25;

/// Compares the speeds that an odometry reports with its poses and times.
#[derive(Clone, Debug, Default)]
pub(crate) struct Speeds {
    last: Option<(f64, Vector2<f64>)>,
    /// The length of the present piece, by the speeds and by the poses, m.
    reported_m: f64,
    moved_m: f64,
    /// Length by the speeds per length by the poses, of each piece.
    ratios: Vec<f64>,
}

impl Speeds {
    /// Adds a position, m, with the speed that is reported there.
    pub(crate) fn add(&mut self, time_s: f64, at: Vector2<f64>, speed_mps: f64) {
        let Some((last_s, last)) = self.last.replace((time_s, at)) else { return };
        let (elapsed_s, step_m) = (time_s - last_s, (at - last).norm());
        let is_step = elapsed_s > 0.0 && elapsed_s <= MAX_STEP_S && speed_mps.is_finite();
        let moves = speed_mps.abs() >= MIN_MPS && step_m >= MIN_MPS * elapsed_s; // false for NaN
        if !(is_step && moves) {
            return;
        }
        self.reported_m += speed_mps.abs() * elapsed_s;
        self.moved_m += step_m;
        if self.moved_m >= PIECE_M {
            self.ratios.push(self.reported_m / self.moved_m);
            (self.reported_m, self.moved_m) = (0.0, 0.0);
        }
    }

    /// Why speeds, poses and times cannot all be true, if it is sure: they differ by one factor in the whole log.
    pub(crate) fn impossible(&self) -> Option<String> {
        let pieces = self.ratios.len();
        if pieces < MIN_PIECES {
            return None;
        }
        let factor = interfaces::median(self.ratios.iter().copied())?;
        let near = self.ratios.iter().filter(|ratio| (*ratio / factor - 1.0).abs() < NEAR).count();
        let is_wrong = (FACTORS[0]..=FACTORS[1]).contains(&factor.max(1.0 / factor));
        (is_wrong && near as f64 >= MIN_SHARE * pieces as f64).then(|| {
            format!(
                "the speeds of the odometry are {factor:.2} times those of its poses and times (in {near} of {pieces} pieces of \
                 {PIECE_M} m): the times, the lengths or the speeds are wrong; if only the speeds are, write 0: they are \
                 not used"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corrections_are_counted_by_their_size() {
        let mut jumps = Jumps::default();
        assert_eq!(jumps.described(0.0), "it has corrected nothing");
        for (time_s, x, turn_rad) in [(1.0, 1e-4, 0.0), (2.0, 0.02, 0.0), (3.0, 0.3, 0.1), (4.0, 0.0, 0.06)] {
            jumps.add(time_s, &interfaces::pose(x, 0.0, turn_rad));
        }
        let expected = "3 corrections, 2 of them by more than 0.1 m or 0.05 rad, the largest by 0.30 m and 5.7° at 2.5 s; a \
                        correction is no motion, and scans before it keep their poses";
        assert_eq!(jumps.described(0.5), expected);
    }
}
