//! Sensors other than lasers: bumpers and sonars.

use nalgebra::Isometry2;

/// A ring of bumpers around a part of the outline of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BumperSpec {
    /// The number of bumpers, at most 64, from right to left.
    pub sectors: usize,
    /// The angle that all bumpers cover together, symmetrical to straight ahead, rad, in (0, 2π].
    pub fov_rad: f64,
}

/// A sonar or infrared sensor: it measures the range of the nearest surface in a cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SonarSpec {
    /// The angle of the cone, rad.
    pub cone_rad: f64,
    /// The minimum range, m: a shorter range is reported as −∞.
    pub range_min_m: f64,
    /// The maximum range, m: a longer range is reported as +∞.
    pub range_max_m: f64,
    /// The number of physics steps from one measurement to the next; at least 1.
    pub period_steps: u64,
    /// The pose of the sensor in the frame of the robot, m and rad.
    pub mount: Isometry2<f64>,
    /// The standard deviation of the range noise, m.
    pub noise_std_m: f64,
}
