//! The odometry while a scan was measured, from its velocities.

use interfaces::{LaserReading, Twist, heading_rad};
use nalgebra::{Isometry2, Vector2};

/// Poses nearer in time than this are one, s.
const MIN_STEP_S: f64 = 1e-6;
/// The largest difference between the motion since the last pose and the sum of the velocities that is spread over the path,
/// m and rad. Beyond it, the odometry has jumped.
const MAX_SPREAD_M: f64 = 0.1;
const MAX_SPREAD_RAD: f64 = 0.15;
/// Rotation equivalent to 1 m, rad.
const RAD_PER_M: f64 = 3.0;

/// A pose of the odometry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) time_s: f64,
    pub(super) pose: Isometry2<f64>,
    /// The velocity up to this pose.
    pub(super) twist: Twist,
    /// The length of the path from here to the end of the scan: meters, and turns as meters.
    length: f64,
}

impl Step {
    /// The step at an earlier time, from which the robot moved with this velocity to here.
    fn before(&self, twist: &Twist, time_s: f64) -> Self {
        let elapsed_s = time_s - self.time_s;
        let way = twist.linear_mps.abs() + twist.angular_radps.abs() / RAD_PER_M;
        let pose = self.pose * moved(twist, elapsed_s);
        Self { time_s, pose, twist: *twist, length: self.length - way * elapsed_s }
    }
}

/// The poses of the odometry since the time and the pose `last`, the earliest first. The velocities give the shape of the
/// path; what they miss of the motion is spread along it, as the errors of wheels are. Without this, the velocities that a
/// reader takes from the poses would have all of it in the first step.
pub(super) fn steps(reading: &LaserReading, last: Option<(f64, Isometry2<f64>)>) -> Vec<Step> {
    let (time_s, pose, twist) = (reading.time_s, reading.pose, reading.twist);
    let mut steps = vec![Step { time_s, pose, twist, length: 0.0 }];
    for (index, sample) in reading.velocities.iter().enumerate().rev() {
        let before = index.checked_sub(1).map(|before| reading.velocities[before]);
        let begin_s = before.map_or(reading.time_s - reading.scan.sweep_s, |before| before.time_s);
        let now = steps[steps.len() - 1];
        // Times out of order are no part of the motion.
        if begin_s < now.time_s && begin_s.is_finite() {
            let twist = before.map_or(sample.twist, |before| before.twist);
            steps.push(Step { twist, ..now.before(&sample.twist, begin_s) });
        }
    }
    if let Some((last_s, last)) = last {
        steps.retain(|step| step.time_s > last_s + MIN_STEP_S);
        if let Some(first) = steps.last().copied() {
            spread(&mut steps, &first.before(&first.twist, last_s), &last);
        }
    }
    steps.reverse();
    steps
}

/// Bends a path so that it begins at `last` instead of `begin`.
fn spread(steps: &mut [Step], begin: &Step, last: &Isometry2<f64>) {
    let missing = begin.pose.inv_mul(last);
    let (shift_m, turn_rad) = (missing.translation.vector, heading_rad(&missing));
    if begin.length > 0.0 && shift_m.norm() <= MAX_SPREAD_M && turn_rad.abs() <= MAX_SPREAD_RAD {
        for step in steps {
            let share = step.length / begin.length;
            step.pose *= interfaces::pose(shift_m.x * share, shift_m.y * share, turn_rad * share);
        }
    }
}

/// The motion of a robot with this velocity.
fn moved(twist: &Twist, elapsed_s: f64) -> Isometry2<f64> {
    let turn_rad = twist.angular_radps * elapsed_s;
    let way_m = twist.linear_mps * elapsed_s;
    let half = interfaces::rotation(turn_rad / 2.0);
    // The chord of a short arc.
    let chord_m = way_m * (1.0 - turn_rad * turn_rad / 24.0);
    let to = half * Vector2::new(chord_m, 0.0);
    Isometry2::from_parts(to.into(), half * half)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Scan, VelocitySample};

    #[test]
    fn what_velocities_miss_of_the_motion_is_spread_along_the_path() {
        let twist = Twist { linear_mps: 0.8, angular_radps: 0.2 };
        let sample = |time_s| VelocitySample { time_s, twist };
        let reading = LaserReading {
            time_s: 1.0,
            pose: interfaces::pose(0.1, 0.0, 0.04),
            twist,
            velocities: vec![sample(0.95), sample(1.0)],
            scan: Scan { sweep_s: 0.1, ..Scan::default() },
            ..LaserReading::default()
        };
        // The velocities say 8 cm and 0.02 rad.
        let found = steps(&reading, Some((0.9, Isometry2::identity())));
        let middle = found[0].pose;
        assert_eq!((found.len(), found[0].time_s, found[1].pose), (2, 0.95, reading.pose));
        let half = Isometry2::identity().inv_mul(&middle);
        let [first, second] =
            [half, middle.inv_mul(&reading.pose)].map(|part| (part.translation.x, heading_rad(&part)));
        assert!(
            (first.0 - second.0).abs() < 2e-4 && (first.1 - second.1).abs() < 1e-9,
            "{first:?} {second:?}"
        );

        // An odometry that has jumped, and one whose last pose is not known.
        for last in [Some((0.9, interfaces::pose(5.0, 0.0, 0.0))), None] {
            let found = steps(&reading, last);
            let step = found[found.len() - 2].pose.inv_mul(&reading.pose);
            assert!((step.translation.x - 0.04).abs() < 1e-4, "{step}");
        }
        let still = LaserReading { velocities: Vec::new(), ..reading };
        assert_eq!(steps(&still, Some((0.9, Isometry2::identity()))).len(), 1);
    }
}
