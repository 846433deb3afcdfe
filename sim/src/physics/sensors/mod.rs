//! The sensors of a robot.
//!
//! A sensor measures at fixed steps, but its reading is computed when it is first read ([`on_demand`]): sensors that
//! nobody reads cost nothing.
//!
//! Stepping, snapshots and views use one list of sensors, [`Sensor::all`]. To add a sensor: write a file, and add a
//! variant to [`Sensor`].

pub(super) mod bumper;
mod fiducial_finder;
mod laser_scanner;
mod on_demand;
mod shared_beams;
mod sonar;

pub use fiducial_finder::Fiducial;
use fiducial_finder::FiducialFinder;
pub(super) use fiducial_finder::Tagged;
pub(super) use laser_scanner::LaserScanner;
use laser_scanner::LaserStreams;
pub(super) use on_demand::{Look, OnDemand};
pub(super) use shared_beams::SharedBeams;
use sonar::Sonar;
pub use sonar::SonarReading;

use super::past::Recent;
use super::rays::{Ring, Scene};
use super::snapshot::{Values, value};
use super::spec::{Glass, LaserSpec, RobotSpec};
use interfaces::{LaserReading, Purpose, RandomStream, Twist};
use nalgebra::Isometry2;
use std::sync::Arc;

/// A sensor on a robot, with its latest reading.
#[derive(Clone)]
pub(super) enum Sensor {
    Laser(Box<OnDemand<LaserScanner>>),
    Sonar(Box<OnDemand<Sonar>>),
    Fiducials(Box<OnDemand<FiducialFinder>>),
}

/// The same for every kind of sensor.
macro_rules! each {
    ($self:expr, $sensor:ident => $result:expr) => {
        match $self {
            Sensor::Laser($sensor) => $result,
            Sensor::Sonar($sensor) => $result,
            Sensor::Fiducials($sensor) => $result,
        }
    };
}

impl Sensor {
    /// All sensors of the robot with an index, the main laser scanner first.
    pub(super) fn all(spec: &RobotSpec, beams: &mut SharedBeams, seed: u64, robot: usize) -> Vec<Self> {
        // Each sensor has streams of its own; the streams of the first sensor of a kind are those of the robot.
        let stream = |sensor: usize| robot + (sensor << 24);
        let ring = ring(spec);
        let mut sensors = Vec::new();
        for (index, laser) in spec.lasers().enumerate() {
            sensors.push(Self::laser(laser, beams, seed, stream(index)));
        }
        for (index, sonar) in spec.sonars.iter().enumerate() {
            let noise = RandomStream::new(seed, Purpose::SonarNoise(stream(index)));
            sensors.push(Self::Sonar(Box::new(OnDemand::new(Sonar::new(sonar, beams, ring), noise))));
        }
        let finder = spec.fiducial.iter().map(|finder| OnDemand::new(FiducialFinder::new(finder, ring), ()));
        sensors.extend(finder.map(|finder| Self::Fiducials(Box::new(finder))));
        sensors
    }

    /// A laser scanner with random streams with the index `stream`.
    pub(super) fn laser(spec: &LaserSpec, beams: &mut SharedBeams, seed: u64, stream: usize) -> Self {
        let streams = LaserStreams {
            noise: RandomStream::new(seed, Purpose::LaserNoise(stream)),
            dropout: RandomStream::new(seed, Purpose::LaserDropout(stream)),
        };
        Self::Laser(Box::new(OnDemand::new(LaserScanner::new(spec, beams), streams)))
    }

    /// The number of steps from one measurement to the next.
    pub(super) fn period_steps(&self) -> u64 {
        each!(self, sensor => sensor.device.spec.period_steps)
    }

    /// Whether the sensor measures at a step.
    pub(super) fn is_due(&self, step: u64) -> bool {
        step.is_multiple_of(self.period_steps())
    }

    /// Whether the sensor has measured at a time, s.
    pub(super) fn has_measured(&self, time_s: f64) -> bool {
        each!(self, sensor => sensor.has_measured(time_s))
    }

    /// The sensor measures now, but the reading is computed when it is read.
    pub(super) fn request(&mut self, look: &Arc<Look>) {
        each!(self, sensor => sensor.request(look))
    }

    /// The sensor measures now, and the reading will be read: it is computed at once.
    pub(super) fn measure(&mut self, look: &Look) {
        each!(self, sensor => sensor.measure(look))
    }

    /// The latest reading, if the sensor is a laser scanner.
    pub(super) fn laser_reading(&self) -> Option<Option<&LaserReading>> {
        let Self::Laser(laser) = self else { return None };
        Some(laser.reading())
    }

    /// The latest reading, if the sensor is a sonar.
    pub(super) fn sonar_reading(&self) -> Option<Option<SonarReading>> {
        let Self::Sonar(sonar) = self else { return None };
        Some(sonar.reading().copied())
    }

    /// The latest detections, if the sensor is a fiducial finder.
    pub(super) fn detections(&self) -> Option<&[Fiducial]> {
        let Self::Fiducials(finder) = self else { return None };
        Some(finder.reading().map_or(&[], Vec::as_slice))
    }

    /// Removes the latest reading.
    pub(super) fn clear(&mut self) {
        each!(self, sensor => sensor.clear())
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        match self {
            Self::Laser(laser) => {
                let (LaserStreams { noise, dropout }, reading) = laser.state();
                vec![value(noise), value(dropout), value(reading)]
            }
            Self::Sonar(sonar) => {
                let (noise, reading) = sonar.state();
                vec![value(noise), value(reading)]
            }
            Self::Fiducials(finder) => vec![value(finder.state().1.get_or_insert_default())],
        }
    }
}

/// The ring of the sonars and of the fiducial finder of a robot.
fn ring(spec: &RobotSpec) -> Ring {
    let sonars = spec.sonars.iter().map(|sonar| (sonar.mount, sonar.range_max_m));
    let finder = spec.fiducial.iter().map(|finder| (finder.mount, finder.range_max_m));
    sonars.chain(finder).fold(Ring::default(), |ring, (mount, range_m)| Ring {
        offset_m: ring.offset_m.max(mount.translation.vector.norm()),
        range_m: ring.range_m.max(range_m),
    })
}

/// A robot at the moment of a measurement.
#[derive(Clone)]
pub(super) struct Platform {
    /// The index of the robot.
    pub(super) robot: usize,
    /// The true pose.
    pub(super) pose: Isometry2<f64>,
    /// Pose and velocity by odometry.
    pub(super) odometry_pose: Isometry2<f64>,
    pub(super) odometry_twist: Twist,
}

/// The surroundings of all robots at the time of a measurement.
pub(super) struct Surroundings {
    /// The number of the physics step.
    pub(super) step: u64,
    pub(super) time_s: f64,
    pub(super) scene: Scene,
    pub(super) glass: Vec<Glass>,
    pub(super) tagged: Vec<Tagged>,
    /// For lasers that sweep.
    pub(super) recent: Recent,
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
