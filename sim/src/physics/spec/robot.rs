//! A robot and its parts, checked and in SI.

use super::{BehaviorSpec, BumperSpec, FiducialSpec, SonarSpec};
use crate::physics::form::Form;
use interfaces::Scan;
use nalgebra::{Isometry2, Point2};
use std::f64::consts::{PI, TAU};

/// A robot with wheels and lasers.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSpec {
    /// What it is called.
    pub name: String,
    /// The radius of its body, m; with corners: that of the circle about its middle that holds it.
    pub radius_m: f64,
    /// The corners of its body in its own frame, convex, counter-clockwise, m; none: it is round.
    pub corners: Vec<Point2<f64>>,
    /// Its mass, kg; `None`: 1 kg per m² of the circle. It counts when robots push each other.
    pub mass_kg: Option<f64>,
    /// Where it starts.
    pub pose: Isometry2<f64>,
    /// What its wheels can do.
    pub drive: DriveLimits,
    /// How its odometry errs.
    pub odometry: OdometryError,
    /// What it sees with: the laser whose scans its mind and its controller decide by.
    pub laser: LaserSpec,
    /// Its other lasers.
    pub more_lasers: Vec<LaserSpec>,
    /// What it feels touches with.
    pub bumper: Option<BumperSpec>,
    /// Its sonars and infrared sensors.
    pub sonars: Vec<SonarSpec>,
    /// What it finds tags with.
    pub fiducial: Option<FiducialSpec>,
    /// Its own tag, by which others find it.
    pub tag: Option<u32>,
    /// What it does.
    pub behavior: BehaviorSpec,
}

impl RobotSpec {
    /// A round robot of 0.2 m on two wheels: up to 0.5 m/s and 120 °/s, exact odometry, a laser of 360 beams and
    /// 10 m at 10 Hz in a world of physics steps of 0.05 s, and no other sensors.
    pub fn new(name: &str, pose: Isometry2<f64>, behavior: BehaviorSpec) -> Self {
        Self {
            name: name.to_owned(),
            radius_m: 0.2,
            corners: Vec::new(),
            mass_kg: None,
            pose,
            drive: DriveLimits {
                kind: DriveKind::Differential,
                max_linear_mps: 0.5,
                max_angular_radps: 120.0_f64.to_radians(),
                max_linear_acceleration_mps2: 1.0,
                max_angular_acceleration_radps2: 360.0_f64.to_radians(),
            },
            odometry: OdometryError::default(),
            laser: LaserSpec {
                beams: 360,
                fov_rad: TAU,
                range_min_m: 0.0,
                range_max_m: 10.0,
                rate_hz: 10.0,
                period_steps: 2,
                mount: Isometry2::identity(),
                noise_std_m: 0.0,
                dropout: 0.0,
            },
            more_lasers: Vec::new(),
            bumper: None,
            sonars: Vec::new(),
            fiducial: None,
            tag: None,
            behavior,
        }
    }

    /// Its body at a pose.
    pub fn form(&self, pose: &Isometry2<f64>) -> Form {
        Form::new(&self.corners, self.radius_m, pose)
    }

    /// All its lasers, the main one first.
    pub fn lasers(&self) -> impl Iterator<Item = &LaserSpec> {
        [&self.laser].into_iter().chain(&self.more_lasers)
    }
}

/// How a robot moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveKind {
    /// On two wheels: forwards, backwards, and turning, in place if need be.
    Differential,
    /// In every direction at once.
    Omni {
        /// To either side, m/s.
        max_left_mps: f64,
        /// The same, m/s².
        max_left_acceleration_mps2: f64,
    },
    /// With steered front wheels (Ackermann); its middle is that of the rear axle.
    Car {
        /// From the rear to the front axle, m.
        wheelbase_m: f64,
        /// How far the front wheels turn to either side, rad.
        max_steer_rad: f64,
    },
}

/// The bounds of a drive, which hold at every physics step. All positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveLimits {
    /// How it moves.
    pub kind: DriveKind,
    /// Forwards and backwards, m/s.
    pub max_linear_mps: f64,
    /// Either way round, rad/s.
    pub max_angular_radps: f64,
    /// Speeding up and braking, m/s².
    pub max_linear_acceleration_mps2: f64,
    /// The same for turning, rad/s².
    pub max_angular_acceleration_radps2: f64,
}

impl DriveLimits {
    /// The fastest in any direction, m/s.
    pub fn fastest_mps(&self) -> f64 {
        match self.kind {
            DriveKind::Omni { max_left_mps, .. } => libm::hypot(self.max_linear_mps, max_left_mps),
            DriveKind::Differential | DriveKind::Car { .. } => self.max_linear_mps,
        }
    }

    /// The tightest curve, rad/m; that of a car is as tight as its wheels can be turned, but no
    /// tighter than leaves both bounds of acceleration true while it brakes in the curve.
    pub fn max_curvature_radpm(&self) -> f64 {
        match self.kind {
            DriveKind::Differential | DriveKind::Omni { .. } => f64::INFINITY,
            DriveKind::Car { wheelbase_m, max_steer_rad } => (libm::tan(max_steer_rad) / wheelbase_m)
                .min(self.max_angular_acceleration_radps2 / self.max_linear_acceleration_mps2),
        }
    }
}

/// How a robot's odometry errs; all zero is exact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OdometryError {
    /// Metres felt too many per metre.
    pub distance_gain: f64,
    /// Radians felt too many per radian.
    pub turn_gain: f64,
    /// Radians felt per metre driven straight on.
    pub turn_radpm: f64,
    /// Standard deviation of the distance after 1 m, m; it grows with the square root of the way.
    pub distance_noise_m: f64,
    /// Standard deviation of the heading after a turn of 1 rad, rad; it grows likewise.
    pub turn_noise_rad: f64,
}

/// A planar laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserSpec {
    /// The number of beams.
    pub beams: usize,
    /// The angle they are spread over, rad, in (0, 2π].
    pub fov_rad: f64,
    /// Nearer things give −∞, m.
    pub range_min_m: f64,
    /// Farther things give +∞, m.
    pub range_max_m: f64,
    /// Scans per second, Hz.
    pub rate_hz: f64,
    /// The physics steps from one scan to the next; at least 1.
    pub period_steps: u64,
    /// Where it sits on the robot.
    pub mount: Isometry2<f64>,
    /// Standard deviation of a range, m.
    pub noise_std_m: f64,
    /// The share of ranges that are missing (not a number), at random.
    pub dropout: f64,
}

impl LaserSpec {
    /// The direction of the first beam in the laser's frame, rad.
    pub fn angle_min_rad(&self) -> f64 {
        if self.is_full_turn() { -PI } else { -self.fov_rad / 2.0 }
    }

    /// The angle from beam to beam, rad. Of a full turn the last beam is a neighbour of the
    /// first; of less, the first and the last lie on the borders.
    pub fn angle_increment_rad(&self) -> f64 {
        let gaps = if self.is_full_turn() { self.beams } else { self.beams - 1 };
        self.fov_rad / gaps as f64
    }

    /// A scan of this laser that has seen nothing: no return on any beam.
    pub fn empty_scan(&self) -> Scan {
        Scan {
            angle_min_rad: self.angle_min_rad(),
            angle_increment_rad: self.angle_increment_rad(),
            range_min_m: self.range_min_m,
            range_max_m: self.range_max_m,
            ranges_m: vec![f32::INFINITY; self.beams],
        }
    }

    fn is_full_turn(&self) -> bool {
        self.fov_rad > TAU - 1e-9
    }
}
