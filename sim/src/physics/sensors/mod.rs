//! The sensors of a robot.
//!
//! A sensor measures at fixed steps.
//!
//! Stepping, snapshots and views use one list of sensors, [`Sensor::all`]. To add a sensor: write a file, and add a
//! variant to [`Sensor`] and one to [`SensorReading`].

pub(super) mod bumper;
mod fiducial_finder;
mod laser_scanner;
mod shared_beams;
mod sonar;

pub use fiducial_finder::Fiducial;
use fiducial_finder::FiducialFinder;
pub(super) use fiducial_finder::Tagged;
pub(super) use laser_scanner::LaserScanner;
pub(super) use shared_beams::SharedBeams;
use sonar::Sonar;
pub use sonar::SonarReading;

use super::past::Recent;
use super::rays::{Ring, Scene, Vicinity};
use super::spec::{Glass, LaserSpec, RobotSpec};
use interfaces::{LaserReading, Purpose, RandomStream, Twist, Values, values};
use nalgebra::Isometry2;
use std::cell::OnceCell;

/// A sensor on a robot, with its latest reading.
#[derive(Clone)]
pub(super) enum Sensor {
    Laser(Box<LaserScanner>),
    Sonar(Box<Sonar>),
    Fiducials(Box<FiducialFinder>),
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
            sensors.push(Self::Sonar(Box::new(Sonar::new(sonar, beams, ring, noise))));
        }
        let finder = spec.fiducial.iter().map(|finder| FiducialFinder::new(finder, ring));
        sensors.extend(finder.map(|finder| Self::Fiducials(Box::new(finder))));
        sensors
    }

    /// A laser scanner with random streams with the index `stream`.
    pub(super) fn laser(spec: &LaserSpec, beams: &mut SharedBeams, seed: u64, stream: usize) -> Self {
        let noise = RandomStream::new(seed, Purpose::LaserNoise(stream));
        let dropout = RandomStream::new(seed, Purpose::LaserDropout(stream));
        Self::Laser(Box::new(LaserScanner::new(spec, beams, noise, dropout)))
    }

    /// The number of steps from one measurement to the next.
    pub(super) fn period_steps(&self) -> u64 {
        each!(self, sensor => sensor.spec.period_steps)
    }

    /// Whether the sensor measures at a step.
    pub(super) fn is_due(&self, step: u64) -> bool {
        step.is_multiple_of(self.period_steps())
    }

    /// Whether the sensor has measured at a time, s. Bodies with a tag may be found again: that draws no noise.
    pub(super) fn has_measured(&self, time_s: f64) -> bool {
        let last_s = match self {
            Self::Laser(laser) => laser.reading.as_ref().map(|reading| reading.time_s),
            Self::Sonar(sonar) => sonar.reading.map(|reading| reading.time_s),
            Self::Fiducials(_) => None,
        };
        last_s == Some(time_s)
    }

    /// The sensor measures now, unless it has measured at this time.
    pub(super) fn measure(&mut self, look: &Look<'_>) {
        if !self.has_measured(look.surroundings.time_s) {
            each!(self, sensor => sensor.measure(look));
        }
    }

    /// The latest reading.
    pub(super) fn reading(&self) -> SensorReading<'_> {
        match self {
            Self::Laser(laser) => SensorReading::Laser(laser.reading.as_ref()),
            Self::Sonar(sonar) => SensorReading::Sonar(sonar.reading),
            Self::Fiducials(finder) => SensorReading::Fiducials(&finder.reading),
        }
    }

    /// Removes the latest reading.
    pub(super) fn clear(&mut self) {
        each!(self, sensor => sensor.reading = Default::default())
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        match self {
            Self::Laser(laser) => values![laser.noise, laser.dropout, laser.reading],
            Self::Sonar(sonar) => values![sonar.noise, sonar.reading],
            Self::Fiducials(finder) => values![finder.reading],
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

/// A robot and its surroundings at the time of a measurement.
pub(super) struct Look<'a> {
    platform: Platform,
    surroundings: &'a Surroundings<'a>,
    vicinity: OnceCell<Vicinity>,
}

impl<'a> Look<'a> {
    pub(super) fn new(platform: Platform, surroundings: &'a Surroundings<'a>) -> Self {
        Self { platform, surroundings, vicinity: OnceCell::new() }
    }

    /// What is around the robot. All sensors of the robot that ask for it must be within `ring`, the same one.
    fn vicinity(&self, ring: &Ring) -> &Vicinity {
        let Platform { pose, robot, .. } = &self.platform;
        self.vicinity
            .get_or_init(|| self.surroundings.scene.vicinity(pose.translation.vector.into(), ring, *robot))
    }
}

/// The surroundings of all robots at the time of a measurement.
pub(super) struct Surroundings<'a> {
    /// The number of the physics step.
    pub(super) step: u64,
    pub(super) time_s: f64,
    pub(super) scene: &'a Scene,
    pub(super) glass: &'a [Glass],
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
