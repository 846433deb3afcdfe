//! The log of a robot that explores a generated building: its laser, its odometry and its way are drawn from a seed.

use agent::Policy;
use evaluation::physics_trial::{self, PhysicsTrial};
use interfaces::{LaserReading, PoseMode, Purpose, RandomStream, World, heading_rad, pose};
use nalgebra::Isometry2;
use rand::RngExt;
use rand::seq::IndexedRandom;
use sim::physics::{OdometryError, WorldSpec};
use std::error::Error;
use std::f64::consts::{PI, TAU};

/// The longest drive, s.
const MAX_DRIVE_S: f64 = 2400.0;

/// What a log is made of.
#[derive(Clone, Debug)]
pub(crate) struct LogSpec {
    /// The name of the building.
    pub(crate) building: String,
    /// The length of the way, m.
    way_m: f64,
    /// A scan is recorded after this way, m, or half as many radians.
    pub(crate) step_m: f64,
    beams: usize,
    fov_rad: f64,
    noise_std_m: f64,
    /// Errors of the odometry: of the distance and of turns, per meter or radian; of the heading per meter, rad; and the standard
    /// deviations of the distance (m) and of the heading (rad) after 1 m or 1 rad.
    pub(crate) gains: [f64; 2],
    bend_radpm: f64,
    noise: [f64; 2],
    /// Glitches of the odometry per meter: a motion of up to 0.5 m and 0.6 rad that was none.
    pub(crate) glitches_per_m: f64,
}

/// A recorded log with its truth.
pub(crate) struct SimulatedLog {
    pub(crate) readings: Vec<LaserReading>,
    pub(crate) truth: Vec<Isometry2<f64>>,
    pub(crate) way_m: f64,
}

impl LogSpec {
    pub(crate) fn drawn(seed: u64) -> Self {
        let mut random = RandomStream::new(seed, Purpose::Agent);
        let kind = if seed.is_multiple_of(2) { "house" } else { "office" };
        let mut log_uniform =
            |low: f64, high: f64| libm::exp(random.uniform(libm::log(low)..libm::log(high)));
        let (way_m, step_m) = (log_uniform(50.0, 400.0), log_uniform(0.1, 1.0));
        let lasers = [(180, PI), (181, PI), (360, PI), (360, TAU)];
        let (beams, fov_rad) = *lasers.choose(&mut random).unwrap_or(&lasers[0]);
        // A fifth of all odometries are bad.
        let drift = if random.bernoulli(0.2) { 3.0 } else { 1.0 };
        Self {
            building: format!("{kind}-{}", 9000 + seed),
            way_m,
            step_m,
            beams,
            fov_rad,
            noise_std_m: random.uniform(0.005..0.03),
            gains: [0.03, 0.05].map(|most| drift * random.uniform(-most..most)),
            bend_radpm: drift * random.uniform(-0.015..0.015),
            noise: [0.02, 0.03].map(|most| drift * random.uniform(0.2 * most..most)),
            glitches_per_m: if random.bernoulli(0.3) { random.uniform(0.002..0.02) } else { 0.0 },
        }
    }

    /// Drives, and records.
    pub(crate) fn record(&self, seed: u64) -> Result<SimulatedLog, Box<dyn Error>> {
        let mut fleet = WorldSpec::generated(&self.building).ok_or("no such building")?.fleet().clone();
        let driven = fleet.driven_robots().next().ok_or("no driven robot")?;
        let robot = &mut fleet.robots[driven];
        let laser = &mut robot.laser;
        (laser.beams, laser.fov_rad, laser.noise_std_m) = (self.beams, self.fov_rad, self.noise_std_m);
        robot.odometry = OdometryError::default();
        let spec = WorldSpec::new(fleet)?;
        let mut settings = physics_trial::settings(&spec)?;
        settings.pose = PoseMode::Exact;
        let pilot = settings.pilot(settings.agent(&Policy::default(), seed)?, seed)?;
        let mut trial = PhysicsTrial::new(&spec, seed, &settings, None, pilot)?;
        let mut random = RandomStream::new(seed, Purpose::MapFrame);
        let mut odometry = pose(0.0, 0.0, random.uniform(-PI..PI));
        let mut log = SimulatedLog { readings: Vec::new(), truth: Vec::new(), way_m: 0.0 };
        let mut last = *trial.world.true_pose();
        let mut recorded = last;
        while log.way_m < self.way_m && trial.world.time_s() < MAX_DRIVE_S {
            trial.turn()?;
            let truth = *trial.world.true_pose();
            odometry *= self.measured(&last.inv_mul(&truth), &mut random);
            log.way_m += (truth.translation.vector - last.translation.vector).norm();
            last = truth;
            let since = recorded.inv_mul(&truth);
            let is_due = since.translation.vector.norm() >= self.step_m
                || heading_rad(&since).abs() >= 0.5 * self.step_m.max(0.2);
            if is_due || log.readings.is_empty() {
                recorded = truth;
                log.truth.push(truth);
                log.readings.push(LaserReading { pose: odometry, ..trial.world.sense() });
            }
        }
        Ok(log)
    }

    /// A motion as the odometry measures it.
    fn measured(&self, motion: &Isometry2<f64>, random: &mut RandomStream) -> Isometry2<f64> {
        let (way_m, turn_rad) = (motion.translation.vector.norm(), heading_rad(motion));
        let mut normal = |std: f64| std * random.sample::<f64, _>(rand_distr::StandardNormal);
        let along =
            1.0 + self.gains[0] + normal(self.noise[0] / way_m.max(1e-9).sqrt()) * f64::from(way_m > 0.0);
        let turn = turn_rad * (1.0 + self.gains[1])
            + self.bend_radpm * way_m
            + normal(self.noise[1] * (turn_rad.abs() + 0.3 * way_m).sqrt());
        let mut measured = pose(along * motion.translation.x, along * motion.translation.y, turn);
        if random.bernoulli(self.glitches_per_m * way_m) {
            measured *= pose(random.uniform(-0.5..0.5), 0.0, random.uniform(-0.6..0.6));
        }
        measured
    }
}
