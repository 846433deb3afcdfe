//! How long the localizer takes to find the pose after a displacement: a jump of the odometry, or a robot that was carried.

use crate::score::{error, quantile};
use interfaces::heading_rad;
use localizer::{PoseEstimate, PoseState};
use nalgebra::Isometry2;

/// Larger differences between the motion and its odometry within one scan are a displacement, m and rad.
const DISPLACED_M: f64 = 0.08;
const DISPLACED_RAD: f64 = 0.15;
/// A certain pose with smaller errors is recovered, m and rad.
const RECOVERED_M: f64 = 0.03;
const RECOVERED_RAD: f64 = 0.02;
/// A certain pose with a larger error is wrong, m and rad.
const WRONG_M: f64 = 0.1;
const WRONG_RAD: f64 = 0.2;

/// The displacements of a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Recovery {
    /// The last true pose and its odometry.
    last: Option<[Isometry2<f64>; 2]>,
    displaced_s: Option<f64>,
    pub(crate) times_s: Vec<f64>,
    /// The number of displacements after which the next one, or the end of the run, came first.
    pub(crate) not_recovered: usize,
    /// The number of scans with a certain pose that is wrong.
    pub(crate) wrong: usize,
}

impl Recovery {
    pub(crate) fn observe(
        &mut self,
        time_s: f64,
        estimate: &PoseEstimate,
        true_pose: &Isometry2<f64>,
        odometry: &Isometry2<f64>,
    ) {
        let before = self.last.replace([*true_pose, *odometry]);
        if let Some([last_pose, last_odometry]) = before {
            let off = last_pose.inv_mul(true_pose).inv_mul(&last_odometry.inv_mul(odometry));
            if off.translation.vector.norm() > DISPLACED_M || heading_rad(&off).abs() > DISPLACED_RAD {
                self.not_recovered += usize::from(self.displaced_s.replace(time_s).is_some());
            }
        }
        let (error_m, error_rad) = error(&estimate.pose, true_pose);
        if estimate.state != PoseState::Tracking {
            return;
        }
        self.wrong += usize::from(error_m > WRONG_M || error_rad > WRONG_RAD);
        if error_m < RECOVERED_M
            && error_rad < RECOVERED_RAD
            && let Some(displaced_s) = self.displaced_s.take()
        {
            self.times_s.push(time_s - displaced_s);
        }
    }

    /// The run ends.
    pub(crate) fn finish(&mut self) {
        self.not_recovered += usize::from(self.displaced_s.take().is_some());
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.times_s.extend(&other.times_s);
        self.not_recovered += other.not_recovered;
        self.wrong += other.wrong;
    }

    pub(crate) fn displacements(&self) -> usize {
        self.times_s.len() + self.not_recovered
    }

    pub(crate) fn print(&self) {
        if self.wrong > 0 {
            println!("    certain and more than {WRONG_M} m or {WRONG_RAD} rad off in {} scans", self.wrong);
        }
        let count = self.displacements();
        if count == 0 {
            return;
        }
        let [median_s, most_s, worst_s] = [0.5, 0.95, 1.0].map(|share| quantile(&self.times_s, share));
        println!(
            "    {count} displacements: recovered after {median_s:.1} / {most_s:.1} / {worst_s:.1} s, {} not before the next or the end",
            self.not_recovered,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    /// The odometry jumps at 3 s, and again at 7 s; the pose is found from `found_s` on.
    fn displaced(found_s: f64) -> Recovery {
        let mut recovery = Recovery::default();
        for second in 0..10 {
            let time_s = f64::from(second);
            let jumps = f64::from(u8::from(second >= 3) + u8::from(second >= 7));
            let is_found = second < 3 || time_s >= found_s;
            let state = if is_found { PoseState::Tracking } else { PoseState::Lost };
            let (pose, covariance) = (Isometry2::identity(), Matrix3::identity());
            let estimate = PoseEstimate { pose, covariance, support: 1.0, state };
            recovery.observe(time_s, &estimate, &pose, &interfaces::pose(jumps, 0.0, 0.0));
        }
        recovery.finish();
        recovery
    }

    #[test]
    fn every_displacement_is_recovered_or_not() {
        for (found_s, times_s, not_recovered) in
            [(5.0, vec![2.0, 0.0], 0), (9.0, vec![2.0], 1), (20.0, vec![], 2)]
        {
            let mut all = Recovery::default();
            (0..2).for_each(|_| all.add(&displaced(found_s)));
            assert_eq!(all.times_s, [times_s.clone(), times_s].concat());
            assert_eq!((all.not_recovered, all.displacements()), (2 * not_recovered, 4));
        }
    }
}
