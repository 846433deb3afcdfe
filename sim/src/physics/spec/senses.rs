//! Sensors other than lasers: bumpers, sonars, fiducial finders.

use nalgebra::Isometry2;

/// A ring of bumpers, which covers a part of a robot's outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BumperSpec {
    /// The number of bumpers, at most 64, from right to left.
    pub sectors: usize,
    /// The angle that they share, symmetrical to straight ahead, rad, in (0, 2π].
    pub fov_rad: f64,
}

/// A sonar or infrared sensor: it measures how near the nearest thing in a cone is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SonarSpec {
    /// The angle of the cone, rad.
    pub cone_rad: f64,
    /// Nearer things give −∞, m.
    pub range_min_m: f64,
    /// Farther things give +∞, m.
    pub range_max_m: f64,
    /// The physics steps from one measurement to the next; at least 1.
    pub period_steps: u64,
    /// Where it sits on the robot.
    pub mount: Isometry2<f64>,
    /// Standard deviation of a range, m.
    pub noise_std_m: f64,
}

/// A sensor that finds what has a tag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiducialSpec {
    /// The angle that it sees, symmetrical to straight ahead, rad, in (0, 2π].
    pub fov_rad: f64,
    /// Things whose middle is farther away are not found, m.
    pub range_max_m: f64,
    /// The physics steps from one look to the next; at least 1.
    pub period_steps: u64,
    /// Where it sits on the robot.
    pub mount: Isometry2<f64>,
}
