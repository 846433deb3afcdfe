//! Whether a robot moves so slowly that its times cannot be in seconds.

use super::standing::{MIN_MOTION_M, MIN_MOTION_RAD};
use interfaces::heading_rad;
use nalgebra::Isometry2;

/// A robot that moves slower than this in nearly all of at least this number of steps is none, m/s and rad/s: 0.15 m/s and more
/// are usual, a thousandth of it with times in milliseconds.
const MIN_MPS: f64 = 0.002;
const MIN_RADPS: f64 = 0.005;
const MIN_STEPS: usize = 100;
/// Poses that are nearer in time than this, s, do not come in milliseconds: they would be more than 250 per second.
const MIN_PERIOD_S: f64 = 4.0;
/// What is slower than this, m/s, is the drift of a robot that stands: no robot drives at 0.05 m/s.
const DRIFT_MPS: f64 = 5e-5;

/// Measures the speed of an odometry over steps that are longer than its drift: with many poses per second, a robot moves by less
/// between two of them.
#[derive(Debug, Default)]
pub(crate) struct Pace {
    /// The motion of the present step so far, its time, s, and its number of poses.
    motion: Isometry2<f64>,
    elapsed_s: f64,
    poses: usize,
    /// The number of steps with a motion, and of those at the speed of a robot.
    moving: usize,
    fast: usize,
}

impl Pace {
    /// Adds the motion from one pose to the next.
    pub(crate) fn add(&mut self, elapsed_s: f64, motion: &Isometry2<f64>) {
        if elapsed_s <= 0.0 {
            return;
        }
        self.motion *= motion;
        self.motion.rotation.renormalize();
        self.elapsed_s += elapsed_s;
        self.poses += 1;
        let (way_m, turn_rad) = (self.motion.translation.vector.norm(), heading_rad(motion).abs());
        // The heading of a robot that stands drifts as fast as others turn in milliseconds: turns are not added up.
        if way_m <= MIN_MOTION_M && turn_rad <= MIN_MOTION_RAD {
            return;
        }
        if way_m < DRIFT_MPS * self.elapsed_s && turn_rad <= MIN_MOTION_RAD {
            *self = Self { moving: self.moving, fast: self.fast, ..Self::default() };
            return;
        }
        let is_slow = way_m <= MIN_MPS * self.elapsed_s
            && turn_rad <= MIN_RADPS * elapsed_s
            && self.elapsed_s >= MIN_PERIOD_S * self.poses as f64;
        self.moving += 1;
        self.fast += usize::from(!is_slow);
        *self = Self { moving: self.moving, fast: self.fast, ..Self::default() };
    }

    /// Why the times cannot be in seconds, if it is sure: the robot moves far slower than any robot.
    pub(crate) fn impossible(&self) -> Option<String> {
        let Self { moving, fast, .. } = *self;
        (moving >= MIN_STEPS && fast * 100 < moving).then(|| {
            format!(
                "the times look like milliseconds: in {} of the {moving} steps in which the odometry moves, it is slower than \
                 {MIN_MPS} m/s and {MIN_RADPS} rad/s; times are in seconds",
                moving - fast
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A robot that drives 0.3 m/s and turns 0.4 rad/s by turns, with rests, for 200 s; its times in this unit, s.
    fn drives(hz: u32, unit_s: f64) -> bool {
        let mut pace = Pace::default();
        for step in 0..200 * hz {
            let period_s = 1.0 / f64::from(hz);
            let (x, theta) =
                [(0.3, 0.0), (0.0, 0.0), (0.3, 0.1), (0.0, 0.4)][(step / (10 * hz) % 4) as usize];
            pace.add(period_s / unit_s, &interfaces::pose(x * period_s, 0.0, theta * period_s));
        }
        pace.impossible().is_none()
    }

    /// A robot that stands for this number of poses at this rate, with this drift per second.
    fn drifts(poses: u32, hz: f64, drift: [f64; 2]) -> bool {
        let mut pace = Pace::default();
        let motion = interfaces::pose(drift[0] / hz, 0.0, drift[1] / hz);
        (0..poses).for_each(|_| pace.add(1.0 / hz, &motion));
        pace.impossible().is_none()
    }

    #[test]
    fn milliseconds_are_found_at_any_rate() {
        for hz in [1, 5, 10, 15, 20, 50, 100, 200] {
            assert!(drives(hz, 1.0), "{hz}");
            assert!(!drives(hz, 1e-3), "{hz}");
        }
    }

    #[test]
    fn a_robot_that_stands_may_drift() {
        // Ten hours with a gyroscope that drifts by 1° per minute, also with a pose every 10 s.
        assert!(drifts(360_000, 10.0, [0.0, 3e-4]) && drifts(3600, 0.1, [0.0, 3e-4]));
        // An estimation that drifts by 7 m in that time, also with a pose every two seconds.
        assert!([10.0, 1.0, 0.5].map(|hz| drifts(36_000, hz, [2e-4, 1e-4])) == [true; 3]);
        // One whose error is a random walk, with a pose every five seconds.
        let mut random = 1_u64;
        let mut pace = Pace::default();
        for _ in 0..20_000 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let angle = (random >> 40) as f64;
            pace.add(5.0, &interfaces::pose(2e-3 * angle.cos(), 2e-3 * angle.sin(), 0.0));
        }
        assert_eq!(pace.impossible(), None);
    }
}
