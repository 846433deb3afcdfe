//! Driving to goals among moving things.

use crate::picture::Picture;
use crate::place::DrivePlace;
use crate::task::{Outcome, Part, Task};
use interfaces::{Purpose, RandomStream, Twist, value};
use nalgebra::{Point2, Vector2};
use sim::physics::{Fleet, SnapshotError};
use std::sync::Arc;

/// The distance ahead on the shortest path at which the point lies that the observation shows, m.
const AHEAD_M: f64 = 0.6;
/// The numbers of an observation beside the scan.
const STATE: usize = 7;

/// Every driven robot of a world has a goal of its own, and is an agent.
///
/// The observation of an agent: the scan (beams, from 0 to 1: share of the maximum range; 1 without a return, 0 where
/// the measurement is invalid or too close), then distance to the goal (share of the diagonal of the world), cosine
/// and sine of its direction, cosine and sine of the direction of the shortest path, linear and angular velocity
/// (shares of the maximum). Directions are in the frame of the robot. An agent at its goal stands still until all
/// others are there.
///
/// The two actions are the wanted linear and angular velocity, as shares of the maximum.
pub struct Drive {
    place: Arc<DrivePlace>,
    fleet: Fleet,
    agents: Vec<Progress>,
    steps: u32,
}

/// One agent in the present episode.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
struct Progress {
    goal: usize,
    /// The length of the shortest path to the goal, m.
    left_m: f64,
    is_done: bool,
    is_at_goal: bool,
    collisions: u32,
}

impl Drive {
    /// The task in a place. It must be reset before the first step.
    pub fn new(place: &Arc<DrivePlace>) -> Self {
        let agents = vec![Progress::default(); place.robots.len()];
        Self { place: Arc::clone(place), fleet: place.fleet.clone(), agents, steps: 0 }
    }

    /// The simulated world.
    pub fn fleet(&self) -> &Fleet {
        &self.fleet
    }

    /// The position of the goal of an agent, m; `None` if there is no such agent.
    pub fn goal(&self, agent: usize) -> Option<Point2<f64>> {
        self.agents.get(agent).map(|progress| self.place.goal(agent, progress.goal))
    }

    /// The world from above, at most `size` pixels wide and high.
    pub fn picture(&self, size: usize) -> Picture {
        let mut picture = Picture::of(&self.fleet, size);
        for (agent, progress) in self.agents.iter().enumerate() {
            let goal = self.place.goal(agent, progress.goal);
            picture.disc(&goal, self.place.settings.goal_radius_m, [60, 170, 80]);
        }
        let driven: Vec<usize> = self.place.robots.iter().map(|agent| agent.robot).collect();
        picture.robots(&self.fleet, &driven);
        picture
    }
}

impl Task for Drive {
    fn agents(&self) -> usize {
        self.place.robots.len()
    }

    fn action_len(&self) -> usize {
        2
    }

    fn parts(&self) -> Vec<Part> {
        vec![Part { name: "observation", shape: vec![self.place.beams() + STATE] }]
    }

    fn info_names(&self) -> &'static [&'static str] {
        &["is_success", "collisions", "distance_m"]
    }

    fn reset(&mut self, seed: u64) {
        let Self { place, fleet, agents, steps } = self;
        fleet.reset(seed);
        *steps = 0;
        let mut random = RandomStream::new(seed, Purpose::Task);
        for ((agent, of), progress) in place.robots.iter().enumerate().zip(agents) {
            if let Some(pose) = of.starts.draw(fleet, of.robot, &mut random) {
                // The pose was drawn among those that fit.
                let _ = fleet.teleport(of.robot, &pose);
            }
            let at = at(fleet, of.robot);
            let goal = place.draw_goal(agent, &at, &mut random);
            let left_m = place.distances(agent, goal).at_m(&place.frame, &at).unwrap_or(place.diagonal_m);
            *progress = Progress { goal, left_m, ..Progress::default() };
        }
        look(place, fleet);
    }

    fn step(&mut self, actions: &[f32], outcome: Outcome<'_>) {
        let Self { place, fleet, agents, steps } = self;
        let settings = &place.settings;
        for ((of, progress), action) in place.robots.iter().zip(&*agents).zip(actions.chunks(2)) {
            let drive = &fleet.spec().robots[of.robot].drive;
            let twist = match (progress.is_done, action) {
                (false, [linear, angular]) => Twist {
                    linear_mps: f64::from(*linear) * drive.max_linear_mps,
                    angular_radps: f64::from(*angular) * drive.max_angular_radps,
                },
                _ => Twist::STOP,
            };
            fleet.command(of.robot, twist);
        }
        let end_s = fleet.time_s() + place.steps as f64 * fleet.spec().step_s;
        fleet.run_until(end_s, &mut ());
        *steps += 1;
        let is_truncated = *steps >= settings.max_steps;
        let Outcome { rewards, terminated, truncated } = outcome;
        for ((agent, of), progress) in place.robots.iter().enumerate().zip(agents) {
            let at = at(fleet, of.robot);
            let contacts = fleet.contacts().iter();
            let hits = contacts.filter(|contact| contact.robot == of.robot && contact.moving).count() as u32;
            if progress.is_done {
                (rewards[agent], terminated[agent], truncated[agent]) =
                    (0.0, progress.is_at_goal, !progress.is_at_goal);
                continue;
            }
            let distances = place.distances(agent, progress.goal);
            let left_m = distances.at_m(&place.frame, &at).unwrap_or(progress.left_m);
            let gained_m = progress.left_m - left_m;
            progress.left_m = left_m;
            progress.collisions += hits;
            let away_m = nalgebra::distance(&at, &place.goal(agent, progress.goal));
            progress.is_at_goal = away_m < settings.goal_radius_m;
            progress.is_done = progress.is_at_goal || is_truncated;
            let reward = settings.progress_reward * gained_m
                + settings.collision_reward * f64::from(hits)
                + settings.step_reward
                + if progress.is_at_goal { settings.goal_reward } else { 0.0 };
            rewards[agent] = reward as f32;
            terminated[agent] = progress.is_at_goal;
            truncated[agent] = is_truncated && !progress.is_at_goal;
        }
        look(place, fleet);
    }

    fn observe(&mut self, observations: &mut [f32]) {
        let place = &*self.place;
        let beams = place.beams();
        let parts = observations.chunks_mut(beams + STATE).zip(&place.robots).zip(&self.agents);
        for (agent, ((observation, of), progress)) in parts.enumerate() {
            let Some(robot) = self.fleet.robot(of.robot) else { continue };
            let spec = &self.fleet.spec().robots[of.robot];
            let (scan, state) = observation.split_at_mut(beams);
            match robot.reading() {
                Some(reading) => {
                    let scale = 1.0 / spec.laser.range_max_m as f32;
                    for (value, range_m) in scan.iter_mut().zip(&reading.scan.ranges_m) {
                        // Too close (−∞) becomes 0 as well, no return (+∞) 1.
                        *value = if range_m.is_nan() { 0.0 } else { (range_m * scale).clamp(0.0, 1.0) };
                    }
                }
                None => scan.fill(0.0),
            }
            let at: Point2<f64> = robot.pose.translation.vector.into();
            let away = place.goal(agent, progress.goal) - at;
            let inverse = robot.pose.rotation.inverse();
            let goal = inverse * away.try_normalize(1e-9).unwrap_or_else(Vector2::x);
            let ahead = if place.settings.shows_path {
                let distances = place.distances(agent, progress.goal);
                let ahead = distances.direction(&place.frame, &at, AHEAD_M);
                ahead.map_or(goal, |ahead| inverse * ahead)
            } else {
                Vector2::zeros()
            };
            let values = [
                away.norm() / place.diagonal_m,
                goal.x,
                goal.y,
                ahead.x,
                ahead.y,
                robot.twist.linear_mps / spec.drive.max_linear_mps,
                robot.twist.angular_radps / spec.drive.max_angular_radps,
            ];
            for (state, value) in state.iter_mut().zip(values) {
                *state = value.clamp(-1.0, 1.0) as f32;
            }
        }
    }

    fn info(&self, info: &mut [f32]) {
        for (agent, (info, progress)) in info.chunks_mut(3).zip(&self.agents).enumerate() {
            let at = at(&self.fleet, self.place.robots[agent].robot);
            let away_m = nalgebra::distance(&at, &self.place.goal(agent, progress.goal));
            let values =
                [f32::from(u8::from(progress.is_at_goal)), progress.collisions as f32, away_m as f32];
            info.copy_from_slice(&values);
        }
    }

    fn snapshot(&mut self) -> Vec<u8> {
        let (mut fleet, mut agents, mut steps) = (self.fleet.snapshot(), self.agents.clone(), self.steps);
        interfaces::snapshot(vec![value(&mut fleet), value(&mut agents), value(&mut steps)])
    }

    fn restore(&mut self, snapshot: &[u8]) -> Result<(), SnapshotError> {
        let (mut fleet, mut agents, mut steps) = (Vec::new(), Vec::<Progress>::new(), 0);
        interfaces::restore(vec![value(&mut fleet), value(&mut agents), value(&mut steps)], snapshot)
            .map_err(|_| SnapshotError::Damaged)?;
        let goals = agents.iter().enumerate().map(|(agent, progress)| (agent, progress.goal));
        let is_known =
            |(agent, goal): (usize, usize)| agent < self.agents.len() && goal < self.place.goals(agent);
        if agents.len() != self.agents.len() || !goals.into_iter().all(is_known) {
            return Err(SnapshotError::OtherSpec);
        }
        self.fleet.restore(&fleet)?;
        (self.agents, self.steps) = (agents, steps);
        Ok(())
    }
}

/// The position of a robot, m.
fn at(fleet: &Fleet, robot: usize) -> Point2<f64> {
    fleet.robot(robot).map_or(Point2::origin(), |robot| robot.pose.translation.vector.into())
}

/// The agents measure, so that scans and poses are of the same instant.
fn look(place: &DrivePlace, fleet: &mut Fleet) {
    for agent in &place.robots {
        fleet.look(agent.robot);
    }
}
