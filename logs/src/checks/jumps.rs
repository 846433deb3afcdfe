//! The corrections of another SLAM: steps of the pose that are no motions.

use interfaces::heading_rad;
use nalgebra::Isometry2;

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
