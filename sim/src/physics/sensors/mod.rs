//! The sensors of a robot.
//!
//! Stepping, snapshots and views go through one list of sensors, [`all`]. A new sensor is a file that
//! implements [`Sensor`], a variant of [`SensorReading`] and a line in [`all`].

pub(super) mod bumper;
mod fiducial_finder;
mod laser_scanner;
mod sonar;

pub use fiducial_finder::Fiducial;
pub(super) use fiducial_finder::Tagged;
pub(super) use laser_scanner::LaserScanner;
pub(super) use laser_scanner::SharedBeams;
pub use sonar::SonarReading;

use super::rays::{Beams, Scene, Scratch};
use super::snapshot::Values;
use super::spec::RobotSpec;
use interfaces::{LaserReading, Twist};
use nalgebra::Isometry2;
use std::sync::Arc;

/// A sensor on a robot, with its latest reading.
pub(super) trait Sensor: Send + Sync {
    /// The physics steps from one measurement to the next; at least 1.
    fn period_steps(&self) -> u64;

    /// Whether the sensor measures at a step.
    fn is_due(&self, step: u64) -> bool {
        step.is_multiple_of(self.period_steps())
    }

    /// Measures, unless there is a reading of this moment already. `scratch` is overwritten.
    fn measure(&mut self, platform: &Platform, surroundings: &Surroundings<'_>, scratch: &mut Scratch);

    /// The latest reading.
    fn reading(&self) -> SensorReading<'_>;

    /// Forgets the latest reading.
    fn clear(&mut self);

    /// The values that a snapshot holds.
    fn values(&mut self) -> Values<'_>;

    /// A copy.
    fn boxed(&self) -> Box<dyn Sensor>;
}

impl Clone for Box<dyn Sensor> {
    fn clone(&self) -> Self {
        self.boxed()
    }
}

/// The latest reading of a sensor; `None`: the sensor has not measured yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SensorReading<'a> {
    /// Of a laser scanner. The pose is that of the odometry.
    Laser(Option<&'a LaserReading>),
    /// Of a sonar.
    Sonar(Option<SonarReading>),
    /// Of a fiducial finder: robots first, then obstacles, each in the order of the spec.
    Fiducials(&'a [Fiducial]),
}

/// A robot at the moment of a measurement.
pub(super) struct Platform {
    /// The index of the robot.
    pub(super) robot: usize,
    /// The true pose.
    pub(super) pose: Isometry2<f64>,
    /// Pose and velocity by odometry.
    pub(super) odometry_pose: Isometry2<f64>,
    pub(super) odometry_twist: Twist,
}

/// What there is to measure at one moment.
pub(super) struct Surroundings<'a> {
    /// The number of the physics step.
    pub(super) step: u64,
    pub(super) time_s: f64,
    pub(super) scene: &'a Scene,
    pub(super) tagged: &'a [Tagged],
}

/// All sensors of the robot with an index, the main laser scanner first. `beams` are those of its lasers.
pub(super) fn all(spec: &RobotSpec, beams: Vec<Arc<Beams>>, seed: u64, robot: usize) -> Vec<Box<dyn Sensor>> {
    // Each sensor has streams of its own; the streams of the first sensor of a kind are those of the robot.
    let stream = |sensor: usize| robot + (sensor << 24);
    let mut sensors: Vec<Box<dyn Sensor>> = Vec::new();
    for (index, (laser, beams)) in spec.lasers().zip(beams).enumerate() {
        sensors.push(Box::new(LaserScanner::new(laser, beams, seed, stream(index))));
    }
    for (index, spec) in spec.sonars.iter().enumerate() {
        sensors.push(Box::new(sonar::Sonar::new(spec, seed, stream(index))));
    }
    if let Some(spec) = &spec.fiducial {
        sensors.push(Box::new(fiducial_finder::FiducialFinder::new(spec)));
    }
    sensors
}

/// A measured range with the meaning of REP-117: too far is +∞, too close −∞.
fn reported(measured_m: f64, range_min_m: f64, range_max_m: f64) -> f32 {
    if measured_m > range_max_m {
        f32::INFINITY
    } else if measured_m < range_min_m {
        f32::NEG_INFINITY
    } else {
        measured_m as f32
    }
}
