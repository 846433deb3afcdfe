//! A simulated world as a robot of ROS.

use crate::link::{Event, Link};
use crate::message::{Message, Odometry, Pose, Time, Topic, covariance, header, transform};
use interfaces::{LaserReading, Twist};
use nalgebra::{Isometry2, Matrix3};
use ros::{FIRST_STAMP_NS, scan_message};
use sim::physics::{Fleet, OdometryError, WorldSpec};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// The frames of the robot, by REP-105.
const ODOM: &str = "odom";
const BASE: &str = "base_link";
const LASER: &str = "laser";
/// The robot stops if no command comes for this time, s.
const WATCHDOG_S: f64 = 0.5;
/// The time between two poses by odometry, s.
const ODOMETRY_S: f64 = 0.02;
/// The longest wait for a command.
const NAP: Duration = Duration::from_millis(50);
/// A simulation that is behind by more than this does not catch up: its time goes slower.
const BEHIND: Duration = Duration::from_millis(500);

/// Settings of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulationSettings {
    /// The seed of all random streams.
    pub seed: u64,
    /// The simulated time per real time.
    pub speed: f64,
    /// The time at the start, ns since the epoch; at least 10 s, so that no stamp of the first scan is negative.
    pub begin_ns: i64,
}

/// The driven robot of a simulated world. It publishes its scans, its odometry, transforms, and the time, and obeys
/// velocities; other robots of the world do what their behavior says.
pub struct SimulatedRobot<L: Link> {
    link: L,
    fleet: Fleet,
    driven: usize,
    settings: SimulationSettings,
    /// The time of the last command, s.
    commanded_s: Option<f64>,
    next_odometry_s: f64,
    drift: Drift,
    mount: Option<Isometry2<f64>>,
    /// The number of scans, and the time of the last one, s.
    scans: u64,
    scanned_s: f64,
}

/// How far the odometry may be off by now.
#[derive(Debug, Default)]
struct Drift {
    error: OdometryError,
    last: Option<Isometry2<f64>>,
    travelled_m: f64,
    turned_rad: f64,
}

impl Drift {
    /// The smallest standard deviation: filters that weigh odometry have no use for an exact one, m and rad.
    const LEAST: f64 = 1e-3;

    fn follow(&mut self, pose: &Isometry2<f64>) {
        let motion = self.last.map_or(Isometry2::identity(), |last| last.inv_mul(pose));
        self.travelled_m += motion.translation.vector.norm();
        self.turned_rad += motion.rotation.angle().abs();
        self.last = Some(*pose);
    }

    /// The covariance of the pose since the start: noise grows with the square root of the way, a wrong gain with the way. Jumps
    /// and slip are not in it, since a robot does not know of them. The error of the position by that of the heading is that of
    /// a straight way.
    fn covariance(&self) -> Matrix3<f64> {
        let (way, turned, error) = (self.travelled_m, self.turned_rad, &self.error);
        let square = |value: f64| value * value;
        let heading = square(error.turn_noise_rad) * turned
            + square(error.turn_gain * turned + error.turn_radpm * way)
            + square(Self::LEAST);
        let position = square(error.distance_noise_m) * way
            + square(error.distance_gain * way)
            + heading * square(way) / 3.0
            + square(Self::LEAST);
        Matrix3::from_diagonal(&[position, position, heading].into())
    }
}

impl<L: Link> SimulatedRobot<L> {
    /// The robot at its start.
    pub fn new(link: L, spec: &WorldSpec, settings: SimulationSettings) -> Self {
        let settings = SimulationSettings { begin_ns: settings.begin_ns.max(FIRST_STAMP_NS), ..settings };
        Self {
            link,
            fleet: Fleet::new(spec.fleet(), settings.seed),
            driven: spec.driven_index(),
            settings,
            commanded_s: None,
            next_odometry_s: 0.0,
            drift: Drift { error: spec.driven().odometry, ..Drift::default() },
            mount: None,
            scans: 0,
            scanned_s: f64::NEG_INFINITY,
        }
    }

    /// Runs until `stop` is set, or until `duration_s` of simulated time are over. Returns the number of scans.
    pub fn run(&mut self, stop: &AtomicBool, duration_s: f64) -> u64 {
        let mut start = Instant::now();
        while !stop.load(Ordering::Relaxed) && self.fleet.time_s() < duration_s {
            self.step();
            let due = Duration::from_secs_f64(self.fleet.time_s() / self.settings.speed);
            start = start.max(Instant::now().checked_sub(due + BEHIND).unwrap_or(start));
            loop {
                let left = due.saturating_sub(start.elapsed());
                let event = self.link.receive(left.min(NAP));
                let is_idle = event.is_none();
                if let Some(event) = event {
                    self.take(event);
                }
                if left.is_zero() && is_idle || stop.load(Ordering::Relaxed) {
                    break;
                }
            }
        }
        self.scans
    }

    /// Simulates one step, and publishes what is new.
    pub fn step(&mut self) {
        let time_s = self.fleet.time_s();
        if self.commanded_s.is_some_and(|commanded_s| time_s - commanded_s > WATCHDOG_S) {
            self.command(Twist::STOP);
            self.commanded_s = None;
        }
        self.link.send(Topic::Clock, Message::Clock(self.stamp(time_s)));
        let view = self.view(time_s);
        self.fleet.step(&mut ());
        let reading = self.fleet.robots().nth(self.driven).and_then(|robot| robot.reading());
        let reading = reading.filter(|reading| reading.time_s > self.scanned_s).cloned();
        if time_s >= self.next_odometry_s - 1e-9 || reading.is_some() {
            self.next_odometry_s = time_s + ODOMETRY_S;
            self.publish_odometry(time_s, view);
        }
        if let Some(reading) = reading {
            self.publish_scan(&reading);
        }
    }

    /// The simulated time, s.
    pub fn time_s(&self) -> f64 {
        self.fleet.time_s()
    }

    /// The true pose, and the pose by odometry.
    #[cfg(test)]
    pub(crate) fn poses(&self) -> Option<[Isometry2<f64>; 2]> {
        let robot = self.fleet.robots().nth(self.driven)?;
        Some([robot.pose, robot.odometry().0])
    }

    /// Sets the robot down elsewhere; `false`: it does not fit there.
    #[cfg(test)]
    pub(crate) fn put(&mut self, pose: &Isometry2<f64>) -> bool {
        self.fleet.teleport(self.driven, pose).is_ok()
    }

    /// Takes a command; what else comes is ignored.
    pub fn take(&mut self, event: Event) {
        let twist = match event {
            Event::Message(_, Message::Twist(twist)) => twist,
            Event::Message(_, Message::TwistStamped(stamped)) => stamped.twist,
            _ => return,
        };
        self.commanded_s = Some(self.fleet.time_s());
        // A command that is not finite stops the robot.
        self.command(Twist { linear_mps: twist.linear.x, angular_radps: twist.angular.z });
    }

    fn command(&mut self, twist: Twist) {
        self.fleet.command(self.driven, twist);
    }

    fn stamp(&self, time_s: f64) -> Time {
        Time::from_ns(self.ns(time_s))
    }

    fn ns(&self, time_s: f64) -> i64 {
        self.settings.begin_ns.saturating_add((time_s * 1e9).round() as i64)
    }

    /// The odometry, and the true pose and velocity, at a time.
    fn view(&mut self, time_s: f64) -> Option<[Odometry; 2]> {
        let robot = self.fleet.robots().nth(self.driven)?;
        let (pose, twist) = robot.odometry();
        self.drift.follow(&pose);
        let message = |frame: &str, pose: &Isometry2<f64>, twist: &Twist| {
            Odometry::in_plane(header(self.stamp(time_s), frame), BASE, pose, twist)
        };
        Some([message(ODOM, &pose, &twist), message("world", &robot.pose, &robot.twist)])
    }

    fn publish_odometry(&mut self, time_s: f64, view: Option<[Odometry; 2]>) {
        let Some([mut odometry, truth]) = view else { return };
        odometry.pose.covariance = covariance(&self.drift.covariance());
        let transform = odometry.pose.pose;
        self.publish_transform(Topic::Transforms, time_s, (ODOM, BASE), transform);
        self.link.send(Topic::Odometry, Message::Odometry(Box::new(odometry)));
        self.link.send(Topic::GroundTruth, Message::Odometry(Box::new(truth)));
    }

    fn publish_scan(&mut self, reading: &LaserReading) {
        if self.mount != Some(reading.mount) {
            self.mount = Some(reading.mount);
            let mount = Pose::in_plane(&reading.mount);
            self.publish_transform(Topic::StaticTransforms, reading.time_s, (BASE, LASER), mount);
        }
        let scan = scan_message(reading, LASER.to_owned(), self.ns(reading.time_s));
        self.link.send(Topic::Scan, Message::Scan(scan));
        (self.scans, self.scanned_s) = (self.scans + 1, reading.time_s);
    }

    fn publish_transform(&mut self, topic: Topic, time_s: f64, frames: (&str, &str), pose: Pose) {
        self.link.send(topic, transform(self.stamp(time_s), frames, pose));
    }
}
#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    /// The error of simulated odometry after 20 m lies within three of the stated standard deviations.
    #[test]
    fn the_covariance_covers_the_error() {
        let error = OdometryError {
            distance_gain: 0.02,
            turn_radpm: 0.01,
            distance_noise_m: 0.01,
            turn_noise_rad: 0.02,
            ..OdometryError::default()
        };
        let mut drift = Drift { error, ..Drift::default() };
        let (mut truth, mut measured) = (Isometry2::identity(), Isometry2::identity());
        for _ in 0..200 {
            drift.follow(&measured);
            truth *= Isometry2::new(Vector2::new(0.1, 0.0), 0.0);
            measured *=
                Isometry2::new(Vector2::new(0.1 * (1.0 + error.distance_gain), 0.0), 0.1 * error.turn_radpm);
        }
        drift.follow(&measured);
        let std = drift.covariance().diagonal().map(f64::sqrt);
        let off = truth.inv_mul(&measured);
        let [position, heading] = [off.translation.vector.norm() / std.x, off.rotation.angle().abs() / std.z];
        assert!((0.3..3.0).contains(&position) && (0.3..3.0).contains(&heading), "{position} {heading}");
    }
}
