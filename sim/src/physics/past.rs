//! The last steps of a fleet, for lasers that measure while they sweep.

use super::form::Form;
use super::rays::Passing;
use super::shape::Rectangle;
use super::snapshot::{SavedPose, Values, value};
use super::spec::{FleetSpec, RobotSpec};
use interfaces::{Twist, VelocitySample, pose, wrap_rad};
use nalgebra::{Isometry2, Vector2};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// What remains of a step in a whole number of steps because of rounding, as a share of a step.
const ROUNDING: f64 = 1e-6;

/// The poses of everything that moves at the begin and at the end of each of the last steps, and the velocities by
/// odometry.
#[derive(Clone)]
pub(super) struct Past {
    /// The number of steps that are kept: as many as the longest sweep takes.
    kept: usize,
    /// The latest step last.
    steps: VecDeque<PastStep>,
}

/// The poses at the begin and at the end of a step. A body that is put elsewhere at the end of the step is still at the
/// pose to which it moved.
#[derive(Clone, Deserialize, Serialize)]
struct PastStep {
    robots: Vec<[SavedPose; 2]>,
    /// The velocities of the robots in the step, by odometry.
    twists: Vec<Twist>,
    /// `None`: the obstacle was absent.
    obstacles: Vec<Option<[SavedPose; 2]>>,
}

impl Past {
    /// No steps yet.
    pub(super) fn new(spec: &FleetSpec) -> Self {
        let lasers = spec.robots.iter().flat_map(RobotSpec::lasers);
        let longest_s = lasers.map(|laser| laser.sweep_s).fold(0.0, f64::max);
        Self { kept: (longest_s / spec.step_s - ROUNDING).ceil() as usize, steps: VecDeque::new() }
    }

    /// The number of steps that are kept.
    pub(super) fn kept(&self) -> usize {
        self.kept
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        vec![value(&mut self.steps)]
    }

    /// Notes a step: the poses of the robots before and after it, and their velocities by odometry; for every obstacle
    /// that is present the poses of its shape.
    pub(super) fn note(
        &mut self,
        robots: impl Iterator<Item = ([Isometry2<f64>; 2], Twist)>,
        obstacles: impl Iterator<Item = Option<[Isometry2<f64>; 2]>>,
    ) {
        if self.kept == 0 {
            return;
        }
        if self.steps.len() == self.kept {
            self.steps.pop_front();
        }
        let saved = |poses: [Isometry2<f64>; 2]| poses.map(SavedPose);
        let (robots, twists) = robots.map(|(poses, twist)| (saved(poses), twist)).unzip();
        let obstacles = obstacles.map(|poses| poses.map(saved)).collect();
        self.steps.push_back(PastStep { robots, twists, obstacles });
    }

    /// A robot has always been at a pose, at rest.
    pub(super) fn put(&mut self, robot: usize, pose: &Isometry2<f64>) {
        for step in &mut self.steps {
            (step.robots[robot], step.twists[robot]) = ([SavedPose(*pose); 2], Twist::STOP);
        }
    }

    /// What moved in the fleet of `spec` in the last steps. `robots` and `obstacles` are the present poses; the latter of
    /// the shapes, `None` for an obstacle that is absent.
    pub(super) fn recent(
        &self,
        spec: &FleetSpec,
        robots: impl Iterator<Item = Isometry2<f64>>,
        obstacles: impl Iterator<Item = Option<Isometry2<f64>>>,
    ) -> Recent {
        let now = PastStep {
            robots: robots.map(|pose| [SavedPose(pose); 2]).collect(),
            twists: Vec::new(),
            obstacles: obstacles.map(|pose| pose.map(|pose| [SavedPose(pose); 2])).collect(),
        };
        let steps = [&now].into_iter().chain(self.steps.iter().rev());
        let (robots, bodies) = steps.map(|step| step.interval(spec)).unzip();
        let twists = self.steps.iter().map(|step| step.twists.clone()).collect();
        Recent { step_s: spec.step_s, robots, bodies, twists }
    }
}

impl PastStep {
    /// The poses of the robots, and the bodies.
    fn interval(&self, spec: &FleetSpec) -> (Vec<[Isometry2<f64>; 2]>, Vec<Passing>) {
        let poses: Vec<_> = self.robots.iter().map(|poses| poses.map(|pose| pose.0)).collect();
        let robots = poses.iter().zip(&spec.robots).enumerate().map(|(index, (poses, robot))| {
            let [from, to] = poses.map(|pose| robot.form(&pose));
            Passing::new(Some(index), &from, &to)
        });
        let obstacles = self.obstacles.iter().zip(&spec.obstacles).filter_map(|(poses, obstacle)| {
            let half_m = obstacle.shape.half_m;
            let form = |pose: SavedPose| Form::Convex(Rectangle { pose: pose.0, half_m }.corners().to_vec());
            let [from, to] = (*poses)?.map(form);
            Some(Passing::new(None, &from, &to))
        });
        let bodies = robots.chain(obstacles).collect();
        (poses, bodies)
    }
}

/// What moved in the last steps: in the present moment, then in each step, the latest first. Empty if no laser sweeps.
#[derive(Default)]
pub(super) struct Recent {
    step_s: f64,
    /// For each of them the poses of the robots at the begin and at the end.
    robots: Vec<Vec<[Isometry2<f64>; 2]>>,
    /// For each of them the bodies.
    pub(super) bodies: Vec<Vec<Passing>>,
    /// For each step, the earliest first, the velocities of the robots by odometry.
    twists: Vec<Vec<Twist>>,
}

impl Recent {
    /// The interval in which the time `age_s` ago lies, and the share of the interval that had passed then.
    pub(super) fn at(&self, age_s: f64) -> (usize, f64) {
        if age_s <= 0.0 {
            return (0, 1.0);
        }
        let steps = age_s / self.step_s;
        let interval = (steps - ROUNDING).ceil().max(1.0) as usize;
        if interval >= self.robots.len() {
            // Before the start.
            return (self.robots.len() - 1, 0.0);
        }
        (interval, (interval as f64 - steps).max(0.0))
    }

    /// The velocities of a robot in the last steps, by odometry; the last step ended at `time_s`.
    pub(super) fn velocities(&self, robot: usize, time_s: f64) -> impl Iterator<Item = VelocitySample> {
        let last = self.twists.len().saturating_sub(1);
        let sample = move |(step, twists): (usize, &Vec<Twist>)| VelocitySample {
            time_s: time_s - (last - step) as f64 * self.step_s,
            twist: twists[robot],
        };
        self.twists.iter().enumerate().map(sample)
    }

    /// The motion of a robot in an interval.
    pub(super) fn motion(&self, robot: usize, interval: usize) -> RobotMotion {
        let [from, to] = &self.robots[interval][robot];
        let (at, heading_rad) = (from.translation.vector, interfaces::heading_rad(from));
        let turn_rad = wrap_rad(interfaces::heading_rad(to) - heading_rad);
        RobotMotion { at, heading_rad, moved_m: to.translation.vector - at, turn_rad }
    }
}

/// The motion of a robot in an interval: straight, and turning evenly.
pub(super) struct RobotMotion {
    /// At the begin.
    at: Vector2<f64>,
    heading_rad: f64,
    moved_m: Vector2<f64>,
    turn_rad: f64,
}

impl RobotMotion {
    /// The pose at a share of the interval.
    pub(super) fn pose(&self, share: f64) -> Isometry2<f64> {
        let at = self.at + self.moved_m * share;
        pose(at.x, at.y, self.heading_rad + self.turn_rad * share)
    }
}
