use sim::physics::{Controller, RobotView, Velocity};
use std::f64::consts::TAU;

/// The robot turns if a sonar ahead measures less than this, m; less the farther the sonar looks to the side.
const NEAR_M: f64 = 0.5;
const SPEED_MPS: f64 = 0.3;

/// Drives toward open space, by the ring of sonars alone, as the controllers of Stage's benchmarks do.
pub(crate) struct BySonars;

impl Controller for BySonars {
    fn drive(&mut self, robot: &RobotView<'_>) -> Option<Velocity> {
        let count = robot.sonars().count() as f64;
        let (mut x, mut y, mut is_free) = (0.0, 0.0, true);
        for (index, reading) in robot.sonars().enumerate() {
            let (sin, cos) = (TAU * index as f64 / count).sin_cos();
            // No return counts as the greatest range, too close as 0.
            let range_m = f64::from(reading?.range_m).clamp(0.0, 5.0);
            (x, y) = (x + range_m * cos, y + range_m * sin);
            is_free &= cos < 0.3 || range_m > NEAR_M * cos;
        }
        let turn_rad = y.atan2(x);
        let linear_mps = if is_free && turn_rad.abs() < 0.5 { SPEED_MPS } else { 0.0 };
        Some(interfaces::Twist { linear_mps, angular_radps: turn_rad }.into())
    }
}
