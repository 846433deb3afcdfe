//! Driving to goals among moving things.

use crate::memory::{LAYER, Memory};
use crate::place::DrivePlace;
use crate::results::{ACTIONS, Results};
use draw::canvas::{Canvas, PictureError};
use draw::pictures::bare;
use draw::scene::Scene;
use evaluation::scenes::Displayed;
use interfaces::{Purpose, RandomStream, Twist, from_bytes, to_bytes};
use nalgebra::{Point2, Vector2};
use sim::physics::{DriveLimits, Fleet, SnapshotError};
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
/// With [`shows_memory`](crate::DriveSettings::shows_memory), two more parts follow, each at 0.5, 1, 1.75 and 3 m from the robot in 16
/// directions, counter-clockwise from behind: how long the robot was there in this episode (n / (n + 20) decisions), and which share of it
/// the robot saw, up to 4 m away.
///
/// The two actions are the wanted linear and angular velocity, as shares of the maximum.
pub struct Drive {
    place: Arc<DrivePlace>,
    fleet: Fleet,
    agents: Vec<Progress>,
    /// One per agent; none without [`shows_memory`](crate::DriveSettings::shows_memory).
    memories: Vec<Memory>,
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
    /// The names of the values of [`Drive::info`].
    pub const INFO_NAMES: [&'static str; 3] = ["is_success", "collisions", "distance_m"];

    /// The task in a place. It must be reset before the first step.
    pub fn new(place: &Arc<DrivePlace>) -> Self {
        let agents = vec![Progress::default(); place.robots.len()];
        let remembering = if place.settings.shows_memory { agents.len() } else { 0 };
        let memories = vec![Memory::new(&place.frame); remembering];
        Self { place: Arc::clone(place), fleet: place.fleet.clone(), agents, memories, steps: 0 }
    }

    /// The agents measure, so that scans and poses are of the same instant, and remember it.
    fn look(&mut self) {
        let Self { place, fleet, memories, .. } = self;
        for agent in &place.robots {
            fleet.look(agent.robot);
        }
        for (agent, memory) in place.robots.iter().zip(memories) {
            if let Some(robot) = fleet.robot(agent.robot) {
                memory.note(&robot.pose.translation.vector.into(), robot.reading(), &robot.pose);
            }
        }
    }

    /// The number of agents; at least one. All values for agents are slices with one part per agent, in this order.
    pub fn agents(&self) -> usize {
        self.place.robots.len()
    }

    /// The number of values of the observation of an agent.
    pub fn observation_len(&self) -> usize {
        self.place.beams() + STATE + if self.memories.is_empty() { 0 } else { 2 * LAYER }
    }

    /// The names and lengths of the parts of the observation of an agent, one after the other.
    pub fn slices(&self) -> Vec<(&'static str, usize)> {
        let mut slices = vec![
            ("scan", self.place.beams()),
            ("goal_distance", 1),
            ("goal_direction", 2),
            ("path_direction", 2),
            ("velocity", 2),
        ];
        if !self.memories.is_empty() {
            slices.extend([("visited", LAYER), ("seen", LAYER)]);
        }
        slices
    }

    /// Begins an episode. Everything random in it follows from `seed`.
    pub fn reset(&mut self, seed: u64) {
        let Self { place, fleet, agents, memories, steps } = self;
        memories.iter_mut().for_each(Memory::clear);
        fleet.reset(seed);
        *steps = 0;
        let mut random = RandomStream::new(seed, Purpose::Task);
        for ((agent, of), progress) in place.robots.iter().enumerate().zip(agents) {
            if let Some(pose) = fleet.draw_pose(&of.starts, of.robot, &mut random) {
                // The pose was drawn among those that fit.
                let _ = fleet.teleport(of.robot, &pose);
            }
            let at = at(fleet, of.robot);
            let goal = place.draw_goal(agent, &at, &mut random);
            let left_m = place.distances(agent, goal).at_m(&place.frame, &at).unwrap_or(place.diagonal_m);
            *progress = Progress { goal, left_m, ..Progress::default() };
        }
        self.look();
    }

    /// Simulates one step. An agent whose part of the episode is over stands still, and its action is ignored.
    /// Writes rewards and ends. The actions are [`ACTIONS`] shares of the maximum velocity per agent, from −1 to 1.
    pub fn step(&mut self, actions: &[f32], results: &mut Results) {
        let Self { place, fleet, agents, steps, .. } = self;
        let settings = &place.settings;
        for ((of, progress), action) in place.robots.iter().zip(&*agents).zip(actions.chunks(ACTIONS)) {
            let wanted = || twist(&fleet.spec().robots[of.robot].drive, action);
            let twist = if progress.is_done { Twist::STOP } else { wanted() };
            fleet.command(of.robot, twist);
        }
        let end_s = fleet.time_s() + place.steps as f64 * fleet.spec().step_s;
        fleet.run_until(end_s, &mut ());
        *steps += 1;
        let is_truncated = *steps >= settings.max_steps;
        let Results { rewards, terminated, truncated, .. } = results;
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
        self.look();
    }

    /// Writes the observations of all agents.
    pub fn observe(&mut self, observations: &mut [f32]) {
        let place = &*self.place;
        let beams = place.beams();
        let parts = observations.chunks_mut(self.observation_len()).zip(&place.robots).zip(&self.agents);
        for (agent, ((observation, of), progress)) in parts.enumerate() {
            let Some(robot) = self.fleet.robot(of.robot) else { continue };
            let spec = &self.fleet.spec().robots[of.robot];
            let (scan, state) = observation.split_at_mut(beams);
            let (state, memory) = state.split_at_mut(STATE);
            if let Some(own) = self.memories.get(agent) {
                let (visited, seen) = memory.split_at_mut(LAYER);
                own.write(visited, seen, &robot.pose);
            }
            match robot.reading() {
                Some(reading) => write_scan(scan, &reading.scan.ranges_m, spec.laser.range_max_m),
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

    /// Writes what is known about the last step: one value per name and agent.
    pub fn info(&self, info: &mut [f32]) {
        for (agent, (info, progress)) in info.chunks_mut(Self::INFO_NAMES.len()).zip(&self.agents).enumerate()
        {
            let at = at(&self.fleet, self.place.robots[agent].robot);
            let away_m = nalgebra::distance(&at, &self.place.goal(agent, progress.goal));
            let values =
                [f32::from(u8::from(progress.is_at_goal)), progress.collisions as f32, away_m as f32];
            info.copy_from_slice(&values);
        }
    }

    /// The world from above, at most `size` pixels wide and high.
    ///
    /// # Errors
    ///
    /// When it cannot be drawn.
    pub fn picture(&self, size: u32) -> Result<Canvas, PictureError> {
        let place = &self.place;
        let goals = self.agents.iter().enumerate().map(|(agent, of)| place.goal(agent, of.goal));
        let goals: Vec<_> = goals.map(|goal| (goal, place.settings.goal_radius_m)).collect();
        bare(&present_scene(&self.fleet), &goals, size)
    }

    /// The state as bytes.
    pub fn snapshot(&self) -> Vec<u8> {
        to_bytes(&(self.fleet.snapshot(), &self.agents, &self.memories, self.steps))
    }

    /// Returns to the state of a snapshot of a task with the same settings.
    ///
    /// # Errors
    ///
    /// When the bytes are not such a snapshot. Nothing is changed then.
    pub fn restore(&mut self, snapshot: &[u8]) -> Result<(), SnapshotError> {
        type Saved = (Vec<u8>, Vec<Progress>, Vec<Memory>, u32);
        let (fleet, agents, memories, steps): Saved =
            from_bytes(snapshot).map_err(|_| SnapshotError::Damaged)?;
        let goals = agents.iter().enumerate().map(|(agent, progress)| (agent, progress.goal));
        let is_known =
            |(agent, goal): (usize, usize)| agent < self.agents.len() && goal < self.place.goals(agent);
        let is_memory = memories.len() == self.memories.len()
            && memories.iter().zip(&self.memories).all(|(saved, own)| saved.is_like(own));
        if agents.len() != self.agents.len() || !is_memory || !goals.into_iter().all(is_known) {
            return Err(SnapshotError::OtherSpec);
        }
        self.fleet.restore(&fleet)?;
        (self.agents, self.memories, self.steps) = (agents, memories, steps);
        Ok(())
    }
}

/// The position of a robot, m.
fn at(fleet: &Fleet, robot: usize) -> Point2<f64> {
    fleet.robot(robot).map_or(Point2::origin(), |robot| robot.pose.translation.vector.into())
}

/// Writes ranges as shares of the maximum range: 1 without a return (+∞), 0 where the measurement is invalid or too close
/// (−∞).
fn write_scan(to: &mut [f32], ranges_m: &[f32], range_max_m: f64) {
    let scale = 1.0 / range_max_m as f32;
    for (value, range_m) in to.iter_mut().zip(ranges_m) {
        *value = if range_m.is_nan() { 0.0 } else { (range_m * scale).clamp(0.0, 1.0) };
    }
}

/// The velocity that an agent wants: its actions are shares of the maximum.
fn twist(drive: &DriveLimits, actions: &[f32]) -> Twist {
    let [linear, angular] = [0, 1].map(|index| f64::from(actions.get(index).copied().unwrap_or(0.0)));
    Twist { linear_mps: linear * drive.max_linear_mps, angular_radps: angular * drive.max_angular_radps }
}

/// The robots and the obstacles as they are now.
fn present_scene(fleet: &Fleet) -> Scene {
    let mut scene = fleet.spec().scene();
    scene.obstacles.iter_mut().for_each(|obstacle| obstacle.outline.clear());
    for obstacle in fleet.obstacles() {
        scene.obstacles[obstacle.index].outline = obstacle.corners.to_vec();
    }
    fleet.robots().for_each(|robot| scene.robots[robot.index].pose = robot.pose);
    scene
}
