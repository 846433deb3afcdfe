//! The sensors of a robot.
//!
//! A sensor measures at fixed steps, but its reading is computed when it is first read ([`on_demand`]): sensors that
//! nobody reads cost nothing.
//!
//! Stepping, snapshots and views use one list of sensors, [`Sensor::all`]. To add a sensor: write a file, and add a
//! variant to [`Sensor`].

mod laser_scanner;
mod on_demand;

pub(super) use laser_scanner::LaserScanner;
pub(super) use on_demand::{Look, OnDemand};

use super::past::Recent;
use super::rays::{Beams, Ring, Scene};
use super::snapshot::{Values, value};
use super::spec::{BumperSpec, Glass, LaserSpec, RobotSpec, SonarSpec};
use interfaces::{LaserReading, Purpose, RandomStream, Twist};
use laser_scanner::LaserStreams;
use nalgebra::{Isometry2, Point2};
use on_demand::Device;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A sensor on a robot, with its latest reading.
#[derive(Clone)]
pub(super) enum Sensor {
    Laser(Box<OnDemand<LaserScanner>>),
    Sonar(Box<OnDemand<Sonar>>),
}

/// The same for every kind of sensor.
macro_rules! each {
    ($self:expr, $sensor:ident => $result:expr) => {
        match $self {
            Sensor::Laser($sensor) => $result,
            Sensor::Sonar($sensor) => $result,
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
        }
    }
}

/// The ring of the sonars of a robot.
fn ring(spec: &RobotSpec) -> Ring {
    spec.sonars.iter().fold(Ring::default(), |ring, sonar| Ring {
        offset_m: ring.offset_m.max(sonar.mount.translation.vector.norm()),
        range_m: ring.range_m.max(sonar.range_max_m),
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

/// The bumpers, as bits, of a robot at `pose` that a contact presses. `ends` are the ends of the line of contact, m.
pub(crate) fn pressed(spec: &BumperSpec, pose: &Isometry2<f64>, ends: &[Point2<f64>; 2]) -> u64 {
    let [a, b] = ends.map(|end| pose.inverse_transform_point(&end).coords);
    let turn_rad = libm::atan2(a.perp(&b), a.dot(&b));
    let right = if turn_rad < 0.0 { b } else { a };
    let right_rad = libm::atan2(right.y, right.x);
    let sector_rad = spec.fov_rad / spec.sectors as f64;
    let is_pressed = |sector: usize| {
        let begin_rad = sector as f64 * sector_rad - spec.fov_rad / 2.0;
        // Two angular ranges overlap where one of them begins within the other.
        (right_rad - begin_rad).rem_euclid(TAU) < sector_rad
            || (begin_rad - right_rad).rem_euclid(TAU) < turn_rad.abs()
    };
    (0..spec.sectors).filter(|sector| is_pressed(*sector)).fold(0, |pressed, sector| pressed | 1 << sector)
}

/// The beams of all lasers and sonars. Sensors with the same beams share them.
#[derive(Clone, Default)]
pub(crate) struct SharedBeams {
    known: Vec<(Key, Arc<Beams>)>,
}

/// First angle, spacing and maximum range, and the number of beams.
type Key = ([f64; 3], usize);

impl SharedBeams {
    /// See [`Beams::new`].
    fn of(&mut self, first_rad: f64, spacing_rad: f64, count: usize, range_max_m: f64) -> Arc<Beams> {
        let key = ([first_rad, spacing_rad, range_max_m], count);
        if let Some((_, beams)) = self.known.iter().find(|(known, _)| *known == key) {
            return Arc::clone(beams);
        }
        let beams = Arc::new(Beams::new(first_rad, spacing_rad, count, range_max_m));
        self.known.push((key, Arc::clone(&beams)));
        beams
    }

    /// The beams of a laser.
    pub(crate) fn of_laser(&mut self, spec: &LaserSpec) -> Arc<Beams> {
        self.of(spec.angle_min_rad(), spec.angle_increment_rad(), spec.beams, spec.range_max_m)
    }
}

/// The angle between two beams of the fan that fills the cone of a sonar, rad: half a degree.
const BEAM_SPACING_RAD: f64 = std::f64::consts::PI / 360.0;

/// The reading of a sonar.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct SonarReading {
    /// The time of the measurement, s.
    pub time_s: f64,
    /// The distance of the nearest surface in the cone, m; −∞ too close, +∞ no surface in range.
    pub range_m: f32,
}

/// A sonar or infrared range sensor.
#[derive(Clone)]
pub(crate) struct Sonar {
    spec: SonarSpec,
    beams: Arc<Beams>,
    /// Of all sonars of the robot.
    ring: Ring,
}

impl Sonar {
    fn new(spec: &SonarSpec, beams: &mut SharedBeams, ring: Ring) -> Self {
        let gaps = (spec.cone_rad / BEAM_SPACING_RAD).ceil().max(2.0);
        let (first_rad, spacing_rad) = (-spec.cone_rad / 2.0, spec.cone_rad / gaps);
        let beams = beams.of(first_rad, spacing_rad, gaps as usize + 1, spec.range_max_m);
        Self { spec: *spec, beams, ring }
    }
}

impl Device for Sonar {
    type Reading = SonarReading;
    type Streams = RandomStream;

    fn measure(&self, look: &Look, noise: &mut RandomStream, _: Option<SonarReading>) -> SonarReading {
        let Look { platform, surroundings, .. } = look;
        let SonarSpec { range_min_m, range_max_m, noise_std_m, mount, .. } = self.spec;
        let nearest =
            surroundings.scene.nearest(&self.beams, &(platform.pose * mount), look.vicinity(&self.ring));
        let noise_m = if noise_std_m > 0.0 { noise_std_m * noise.normal() } else { 0.0 };
        let measured_m = 1.0 / nearest + noise_m;
        let range_m = reported(measured_m, range_min_m, range_max_m);
        SonarReading { time_s: surroundings.time_s, range_m }
    }

    fn skip(&self, noise: &mut RandomStream) {
        if self.spec.noise_std_m > 0.0 {
            noise.normal();
        }
    }

    fn time_s(reading: &SonarReading) -> f64 {
        reading.time_s
    }
}
