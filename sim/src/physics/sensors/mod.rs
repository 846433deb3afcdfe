//! The sensors of a robot.
//!
//! Stepping, snapshots and views use one list of sensors, [`Sensor::all`]. To add a sensor: write a file, and add a
//! variant to [`Sensor`] and one to [`SensorReading`].

pub(super) mod bumper;
mod fiducial_finder;
mod laser_scanner;
mod sonar;

pub use fiducial_finder::Fiducial;
use fiducial_finder::FiducialFinder;
pub(super) use fiducial_finder::Tagged;
pub(super) use laser_scanner::{LaserScanner, SharedBeams};
use sonar::Sonar;
pub use sonar::SonarReading;

use super::rays::{Beams, Scene, Scratch};
use super::snapshot::{Values, value};
use super::spec::RobotSpec;
use interfaces::{LaserReading, Twist};
use nalgebra::Isometry2;
use std::sync::Arc;

/// A sensor on a robot, with its latest reading.
#[derive(Clone)]
pub(super) enum Sensor {
    Laser(Box<LaserScanner>),
    Sonar(Box<Sonar>),
    Fiducials(FiducialFinder),
}

impl Sensor {
    /// All sensors of the robot with an index, the main laser scanner first. `beams` are those of its lasers.
    pub(super) fn all(spec: &RobotSpec, beams: Vec<Arc<Beams>>, seed: u64, robot: usize) -> Vec<Self> {
        // Each sensor has streams of its own; the streams of the first sensor of a kind are those of the robot.
        let stream = |sensor: usize| robot + (sensor << 24);
        let lasers = spec.lasers().zip(beams).enumerate().map(|(index, (laser, beams))| {
            Self::Laser(Box::new(LaserScanner::new(laser, beams, seed, stream(index))))
        });
        let sonars = spec.sonars.iter().enumerate();
        let sonars =
            sonars.map(|(index, sonar)| Self::Sonar(Box::new(Sonar::new(sonar, seed, stream(index)))));
        let finder = spec.fiducial.iter().map(|finder| Self::Fiducials(FiducialFinder::new(finder)));
        lasers.chain(sonars).chain(finder).collect()
    }

    /// Whether the sensor measures at a step.
    pub(super) fn is_due(&self, step: u64) -> bool {
        step.is_multiple_of(match self {
            Self::Laser(laser) => laser.spec.period_steps,
            Self::Sonar(sonar) => sonar.spec.period_steps,
            Self::Fiducials(finder) => finder.spec.period_steps,
        })
    }

    /// Measures, unless there is already a reading of this time. `scratch` is overwritten.
    pub(super) fn measure(&mut self, platform: &Platform, now: &Surroundings<'_>, scratch: &mut Scratch) {
        match self {
            Self::Laser(laser) => laser.measure(platform, now, scratch),
            Self::Sonar(sonar) => sonar.measure(platform, now, scratch),
            Self::Fiducials(finder) => finder.measure(platform, now, scratch),
        }
    }

    /// The latest reading.
    pub(super) fn reading(&self) -> SensorReading<'_> {
        match self {
            Self::Laser(laser) => SensorReading::Laser(laser.reading.as_ref()),
            Self::Sonar(sonar) => SensorReading::Sonar(sonar.reading),
            Self::Fiducials(finder) => SensorReading::Fiducials(&finder.found),
        }
    }

    /// Removes the latest reading.
    pub(super) fn clear(&mut self) {
        match self {
            Self::Laser(laser) => laser.reading = None,
            Self::Sonar(sonar) => sonar.reading = None,
            Self::Fiducials(finder) => finder.found.clear(),
        }
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        match self {
            Self::Laser(laser) => {
                vec![value(&mut laser.noise), value(&mut laser.dropout), value(&mut laser.reading)]
            }
            Self::Sonar(sonar) => vec![value(&mut sonar.noise), value(&mut sonar.reading)],
            Self::Fiducials(finder) => vec![value(&mut finder.found)],
        }
    }
}

/// The latest reading of a sensor; `None` before the first measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SensorReading<'a> {
    /// The reading of a laser scanner. The pose is the pose by odometry.
    Laser(Option<&'a LaserReading>),
    /// The reading of a sonar.
    Sonar(Option<SonarReading>),
    /// The bodies that a fiducial finder detected: robots first, then obstacles, each in the order of the spec.
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

/// The surroundings of a robot at the time of a measurement.
pub(super) struct Surroundings<'a> {
    /// The number of the physics step.
    pub(super) step: u64,
    pub(super) time_s: f64,
    pub(super) scene: &'a Scene,
    pub(super) tagged: &'a [Tagged],
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
