//! A robot and its parts.

use super::{BehaviorSpec, BumperSpec, SonarSpec};
use crate::physics::form::Form;
use calendar::Hours;
use interfaces::Scan;
use nalgebra::{Isometry2, Point2};
use std::f64::consts::{PI, TAU};

/// A robot with wheels and lasers.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSpec {
    /// The name of the robot.
    pub name: String,
    /// The radius of the body, m. For a body with corners: the radius of the circle about the center that contains
    /// the body.
    pub radius_m: f64,
    /// The corners of the body in the frame of the robot, convex, counter-clockwise, m. Empty if the body is round.
    pub corners: Vec<Point2<f64>>,
    /// The mass, kg; `None` means 1 kg per m² of the circle with `radius_m`.
    pub mass_kg: Option<f64>,
    /// The pose at the start, m and rad.
    pub pose: Isometry2<f64>,
    /// The kind and the limits of the drive.
    pub drive: DriveLimits,
    /// The errors of the odometry.
    pub odometry: OdometryError,
    /// The main laser scanner. Behaviors and controllers decide at its scans.
    pub laser: LaserSpec,
    /// The other laser scanners.
    pub more_lasers: Vec<LaserSpec>,
    /// The ring of bumpers; `None` if there is none.
    pub bumper: Option<BumperSpec>,
    /// The sonars and infrared sensors.
    pub sonars: Vec<SonarSpec>,
    /// The behavior of the robot.
    pub behavior: BehaviorSpec,
    /// The day of a driven robot: its dock, its battery and the orders of others; `None` if it is always free to drive.
    pub patrol: Option<PatrolDaySpec>,
}

/// The day of a robot that patrols, charges at its dock, and has orders by others.
#[derive(Clone, Debug, PartialEq)]
pub struct PatrolDaySpec {
    /// The position of the dock, m; `None`: where the robot starts.
    pub dock: Option<Point2<f64>>,
    /// How long the robot can be on patrol with a full battery, s.
    pub battery_s: f64,
    /// The share of the time that it can be on patrol: it charges for the rest. From 1 on it need not charge.
    pub share: f64,
    /// The hours in which it has other orders, and stays at its dock.
    pub busy: Hours,
}

impl PatrolDaySpec {
    /// The longest patrol on a full battery unless another one is given, s: half an hour.
    pub const BATTERY_S: f64 = 1800.0;

    /// A robot that is on patrol for a share of the time, with a dock where it starts.
    pub fn of_share(share: f64) -> Self {
        Self { dock: None, battery_s: Self::BATTERY_S, share, busy: Hours::never() }
    }
}

impl RobotSpec {
    /// A round robot with a radius of 0.2 m and two driven wheels: up to 0.5 m/s and 120 °/s, exact odometry, one
    /// laser with 360 beams and a range of 10 m at 10 Hz (for physics steps of 0.05 s), and no other sensors.
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
                lateral_grip: DriveLimits::LATERAL_GRIP,
            },
            odometry: OdometryError::default(),
            laser: LaserSpec {
                beams: 360,
                fov_rad: TAU,
                range_min_m: 0.0,
                range_max_m: 10.0,
                rate_hz: 10.0,
                period_steps: 2,
                sweep_s: 0.0,
                mount: Isometry2::identity(),
                noise_std_m: 0.0,
                dropout: 0.0,
                beam_width_rad: 0.0,
            },
            more_lasers: Vec::new(),
            bumper: None,
            sonars: Vec::new(),
            behavior,
            patrol: None,
        }
    }

    /// The outline of the body at a pose.
    pub fn form(&self, pose: &Isometry2<f64>) -> Form {
        Form::new(&self.corners, self.radius_m, pose)
    }

    /// The longest range of a laser scanner or a sonar, m.
    pub(crate) fn range_m(&self) -> f64 {
        let lasers = self.lasers().map(|laser| laser.range_max_m);
        let sonars = self.sonars.iter().map(|sonar| sonar.range_max_m);
        lasers.chain(sonars).fold(0.0, f64::max)
    }

    /// All laser scanners, the main one first.
    pub fn lasers(&self) -> impl Iterator<Item = &LaserSpec> {
        [&self.laser].into_iter().chain(&self.more_lasers)
    }
}

/// The kind of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveKind {
    /// Two driven wheels. The robot can turn in place.
    Differential,
    /// The robot can drive in every direction and turn at the same time.
    Omni {
        /// The maximum speed to either side, m/s.
        max_left_mps: f64,
        /// The maximum acceleration to either side, m/s².
        max_left_acceleration_mps2: f64,
    },
    /// Steered front wheels (Ackermann); the center of the robot is the center of the rear axle.
    Car {
        /// The distance between the axles, m.
        wheelbase_m: f64,
        /// The maximum steering angle to either side, rad.
        max_steer_rad: f64,
    },
}

/// The limits of a drive, which hold in every physics step. All values are positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveLimits {
    /// The kind of the drive.
    pub kind: DriveKind,
    /// The maximum linear speed forward and backward, m/s.
    pub max_linear_mps: f64,
    /// The maximum angular speed, rad/s.
    pub max_angular_radps: f64,
    /// The maximum linear acceleration and deceleration, m/s².
    pub max_linear_acceleration_mps2: f64,
    /// The maximum angular acceleration and deceleration, rad/s².
    pub max_angular_acceleration_radps2: f64,
    /// The coefficient of friction of wheels that are pushed sideways; not used by an omni drive.
    pub lateral_grip: f64,
}

impl DriveLimits {
    /// The lateral grip unless another one is given: rubber on a smooth floor, with casters that carry a third.
    pub const LATERAL_GRIP: f64 = 0.5;

    /// Whether the wheels roll in every direction.
    pub(crate) fn is_omni(&self) -> bool {
        matches!(self.kind, DriveKind::Omni { .. })
    }

    /// The maximum speed in any direction, m/s.
    pub fn fastest_mps(&self) -> f64 {
        match self.kind {
            DriveKind::Omni { max_left_mps, .. } => libm::hypot(self.max_linear_mps, max_left_mps),
            DriveKind::Differential | DriveKind::Car { .. } => self.max_linear_mps,
        }
    }

    /// The maximum curvature, rad/m. For a car, the curvature is limited by the maximum steering angle, and by the
    /// condition that braking in the curve exceeds no limit of acceleration.
    pub fn max_curvature_radpm(&self) -> f64 {
        match self.kind {
            DriveKind::Differential | DriveKind::Omni { .. } => f64::INFINITY,
            DriveKind::Car { wheelbase_m, max_steer_rad } => (libm::tan(max_steer_rad) / wheelbase_m)
                .min(self.max_angular_acceleration_radps2 / self.max_linear_acceleration_mps2),
        }
    }
}

/// A planar laser scanner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserSpec {
    /// The number of beams.
    pub beams: usize,
    /// The field of view, rad, in (0, 2π].
    pub fov_rad: f64,
    /// The minimum range, m: a beam with a shorter range gives −∞.
    pub range_min_m: f64,
    /// The maximum range, m: a beam with a longer range gives +∞.
    pub range_max_m: f64,
    /// Scans per second, Hz.
    pub rate_hz: f64,
    /// The number of physics steps from one scan to the next; at least 1.
    pub period_steps: u64,
    /// The time from the measurement of the first beam to that of the last beam, s; at most the time from one scan to
    /// the next. 0: all beams measure at once.
    ///
    /// Each beam measures from the pose of the robot, and against the bodies, at its own time. Within a physics step
    /// robots and bodies move straight and turn evenly. Beams that measure before the start see the start.
    pub sweep_s: f64,
    /// The pose of the laser in the frame of the robot, m and rad.
    pub mount: Isometry2<f64>,
    /// The standard deviation of the range noise, m.
    pub noise_std_m: f64,
    /// The probability that a range is missing (NaN), from 0 to 1.
    pub dropout: f64,
    /// The angle that a beam covers, rad; 0: a ray. A beam that meets a near surface with a part of its width, and a far
    /// one with the rest, gives a range between both (a mixed pixel).
    pub beam_width_rad: f64,
}

impl LaserSpec {
    /// The direction of the first beam in the frame of the laser, rad.
    pub fn angle_min_rad(&self) -> f64 {
        if self.is_full_turn() { -PI } else { -self.fov_rad / 2.0 }
    }

    /// The angle between neighboring beams, rad. In a full turn the last beam is a neighbor of the first; in a
    /// narrower field of view, the first and the last beam are on its borders.
    pub fn angle_increment_rad(&self) -> f64 {
        let gaps = if self.is_full_turn() { self.beams } else { self.beams - 1 };
        self.fov_rad / gaps as f64
    }

    /// A scan without a return on any beam.
    pub fn empty_scan(&self) -> Scan {
        Scan {
            angle_min_rad: self.angle_min_rad(),
            angle_increment_rad: self.angle_increment_rad(),
            range_min_m: self.range_min_m,
            range_max_m: self.range_max_m,
            sweep_s: self.sweep_s,
            ranges_m: vec![f32::INFINITY; self.beams],
        }
    }

    fn is_full_turn(&self) -> bool {
        self.fov_rad > TAU - 1e-9
    }
}

// The errors of odometry.

/// The errors of odometry. With all values 0 and no displacements the odometry is exact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OdometryError {
    /// Error of the distance per meter traveled.
    pub distance_gain: f64,
    /// Error of the heading per radian turned.
    pub turn_gain: f64,
    /// Error of the heading per meter traveled, rad/m.
    pub turn_radpm: f64,
    /// Standard deviation of the distance after 1 m, m; it grows with the square root of the distance.
    pub distance_noise_m: f64,
    /// Standard deviation of the heading after a turn of 1 rad, rad; it grows with the square root of the turn.
    pub turn_noise_rad: f64,
    /// How much the wheels slip while a contact changes the velocity of the robot, from 0 to 1: the share of the motion
    /// of the free wheels that the odometry measures instead of the motion of the robot. 1: a robot that pushes against
    /// a wall measures that it drives on, and a robot at rest that is pushed away measures nothing.
    pub slip: f64,
    /// Jumps: at random times the odometry changes, and the robot does not move.
    pub jump: Option<DisplacementSpec>,
    /// At random times the robot is carried away and set down at rest, and the odometry does not change. The new pose is
    /// free, and lies in the part of the world that the robot can reach when doors are open. If no such pose is found in
    /// 100 attempts, the robot stays.
    pub carried: Option<DisplacementSpec>,
}

impl OdometryError {
    /// Whether the odometry is exact.
    pub fn is_exact(&self) -> bool {
        *self == Self::default()
    }
}

/// Displacements at random times: a Poisson process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplacementSpec {
    /// The mean time from one displacement to the next, s.
    pub every_s: f64,
    /// The maximum distance, m. The displacement is uniform in the disc of this radius.
    pub distance_m: f64,
    /// The maximum turn to either side, rad. The turn is uniform.
    pub turn_rad: f64,
}
