//! Sensors other than lasers: bumpers, sonars, fiducial finders.

use nalgebra::Isometry2;

/// A ring of bumpers around a part of the outline of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BumperSpec {
    /// The number of bumpers, at most 64, from right to left.
    pub sectors: usize,
    /// The angle that they share, symmetrical to straight ahead, rad, in (0, 2π].
    pub fov_rad: f64,
}

/// A sonar or infrared sensor: it measures the range of the nearest surface in a cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SonarSpec {
    /// The angle of the cone, rad.
    pub cone_rad: f64,
    /// A shorter range is reported as −∞, m.
    pub range_min_m: f64,
    /// A longer range is reported as +∞, m.
    pub range_max_m: f64,
    /// The physics steps from one measurement to the next; at least 1.
    pub period_steps: u64,
    /// The pose in the frame of the robot.
    pub mount: Isometry2<f64>,
    /// Standard deviation of a range, m.
    pub noise_std_m: f64,
}

/// A sensor that detects bodies with a tag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiducialSpec {
    /// The field of view, symmetrical to straight ahead, rad, in (0, 2π].
    pub fov_rad: f64,
    /// The largest distance to the center of a body, m.
    pub range_max_m: f64,
    /// The physics steps from one measurement to the next; at least 1.
    pub period_steps: u64,
    /// The pose in the frame of the robot.
    pub mount: Isometry2<f64>,
}
