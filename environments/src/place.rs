//! The place of driving tasks: what is the same in every episode, built once and shared.

use crate::distance::Distances;
use crate::results::TaskError;
use draw::scene::extent;
use interfaces::{GridFrame, RandomStream, SettingsCheck, SettingsError};
use nalgebra::Point2;
use sim::physics::{Fleet, FleetSpec, FreePoses};
use std::sync::OnceLock;

/// The side of the cells of paths, m.
const PATH_CELL_M: f64 = 0.1;
/// The greatest number of goals, and the greatest number of distances that are kept for them.
const MAX_GOALS: usize = 256;
const MAX_DISTANCES: usize = 16 << 20;
/// The number of goals that are drawn before the farthest of them is taken.
const ATTEMPTS: usize = 100;

/// The world of driving tasks, with the goals of each driven robot and the shortest paths to them.
pub struct DrivePlace {
    pub(crate) settings: DriveSettings,
    pub(crate) fleet: Fleet,
    /// The robots that are driven.
    pub(crate) robots: Vec<DrivenRobot>,
    /// The number of physics steps from one decision to the next.
    pub(crate) steps: u64,
    /// The length of the diagonal of the world, m.
    pub(crate) diagonal_m: f64,
    /// The cells of paths.
    pub(crate) frame: GridFrame,
}

/// What a driven robot can reach.
pub(crate) struct DrivenRobot {
    /// The index of the robot.
    pub(crate) robot: usize,
    pub(crate) starts: FreePoses,
    goals: Vec<Goal>,
    is_free: Vec<bool>,
}

/// A goal, with the distances to it as soon as they are needed.
struct Goal {
    cell: usize,
    distances: OnceLock<Distances>,
}

impl DrivePlace {
    /// The place for a world, in which every driven robot is an agent.
    ///
    /// # Errors
    ///
    /// When no robot is driven, a driven robot has no free space at its start or another laser than the first, or a
    /// setting is out of range.
    pub fn new(spec: &FleetSpec, settings: DriveSettings) -> Result<Self, TaskError> {
        settings.check()?;
        let steps = (settings.decision_s / spec.step_s).round();
        if steps < 1.0 || (steps * spec.step_s - settings.decision_s).abs() > 1e-6 {
            return Err(TaskError::World(format!(
                "a decision every {:?} s is not a whole number of physics steps of {:?} s",
                settings.decision_s, spec.step_s
            )));
        }
        let size_m = extent(&spec.frame).1;
        let cell_m = spec.frame.resolution_m().max(PATH_CELL_M);
        let frame =
            GridFrame::covering(spec.frame.origin(), size_m.x, size_m.y, cell_m).unwrap_or(spec.frame);
        let coarse = FleetSpec { frame, ..spec.clone() };
        let driven: Vec<usize> = spec.driven_robots().collect();
        let world = &spec.name;
        let nobody = || {
            format!(
                "no robot of the world `{world}` is driven: give one of them `behavior = {{ kind = \"driven\" }}`"
            )
        };
        let first = driven.first().ok_or_else(|| TaskError::World(nobody()))?;
        let expected = spec.robots[*first].laser.beams;
        let agent = |&robot: &usize| {
            let name = &spec.robots[robot].name;
            let beams = spec.robots[robot].laser.beams;
            if beams != expected {
                return Err(TaskError::World(format!(
                    "the laser of the robot `{name}` has {beams} beams, and that of the first one has {expected}"
                )));
            }
            let no_space =
                || format!("the robot `{name}` of the world `{world}` has no free space around its start");
            DrivenRobot::new(&coarse, robot).ok_or_else(|| TaskError::World(no_space()))
        };
        let robots = driven.iter().map(agent).collect::<Result<_, _>>()?;
        let (fleet, diagonal_m) = (Fleet::new(spec, 0), size_m.x.hypot(size_m.y));
        Ok(Self { settings, fleet, robots, steps: steps as u64, diagonal_m, frame })
    }

    /// The number of beams of each agent.
    pub(crate) fn beams(&self) -> usize {
        self.fleet.spec().robots[self.robots[0].robot].laser.beams
    }

    /// The position of a goal of an agent, m.
    pub(crate) fn goal(&self, agent: usize, goal: usize) -> Point2<f64> {
        self.frame.center(self.frame.cell(self.robots[agent].goals[goal].cell))
    }

    /// The number of goals of an agent.
    pub(crate) fn goals(&self, agent: usize) -> usize {
        self.robots[agent].goals.len()
    }

    /// The distances to a goal of an agent.
    pub(crate) fn distances(&self, agent: usize, goal: usize) -> &Distances {
        let DrivenRobot { goals, is_free, .. } = &self.robots[agent];
        let Goal { cell, distances } = &goals[goal];
        distances.get_or_init(|| Distances::new(&self.frame, is_free, *cell))
    }

    /// Draws a goal of an agent that is far enough from `from` (m), or else the farthest of a hundred.
    pub(crate) fn draw_goal(&self, agent: usize, from: &Point2<f64>, random: &mut RandomStream) -> usize {
        let (mut best, mut best_m) = (0, -1.0);
        for _ in 0..ATTEMPTS {
            let goal = (random.uniform(0.0..self.goals(agent) as f64) as usize).min(self.goals(agent) - 1);
            let away_m = nalgebra::distance(from, &self.goal(agent, goal));
            if away_m >= self.settings.min_goal_m {
                return goal;
            }
            if away_m > best_m {
                (best, best_m) = (goal, away_m);
            }
        }
        best
    }
}

impl DrivenRobot {
    fn new(coarse: &FleetSpec, robot: usize) -> Option<Self> {
        let starts = FreePoses::reachable(coarse, robot)?;
        let mut is_free = vec![false; coarse.frame.len()];
        starts.cells().for_each(|cell| is_free[cell] = true);
        let most = MAX_GOALS.min(MAX_DISTANCES / coarse.frame.len()).clamp(1, starts.len());
        let goal = |number: usize| Goal {
            cell: starts.cell(number * starts.len() / most),
            distances: OnceLock::new(),
        };
        let goals = (0..most).map(goal).collect();
        Some(Self { robot, starts, goals, is_free })
    }
}

// The settings of driving tasks.

/// Settings of [`Drive`](crate::Drive).
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct DriveSettings {
    /// The time from one decision to the next, s; a whole number of physics steps.
    pub decision_s: f64,
    /// The number of decisions after which an episode is truncated.
    pub max_steps: u32,
    /// A goal is reached when the center of the robot is nearer than this, m.
    #[serde(rename = "goal_radius")]
    pub goal_radius_m: f64,
    /// The smallest distance from the start to the goal, m, in a straight line.
    #[serde(rename = "min_goal")]
    pub min_goal_m: f64,
    /// Whether the observation has the direction of the shortest path, as a global planner with a map would give it.
    /// Without it both numbers are 0.
    pub shows_path: bool,
    /// Whether the observation has a memory: where the robot was in this episode, and what it saw. With it, a robot without the
    /// direction of the path can come out of dead ends.
    pub shows_memory: bool,
    /// The reward at the goal.
    pub goal_reward: f64,
    /// The reward per meter that the shortest path becomes shorter.
    pub progress_reward: f64,
    /// The reward (below 0) of a contact that begins while the robot moves.
    pub collision_reward: f64,
    /// The reward (below 0) of every decision.
    pub step_reward: f64,
}

impl Default for DriveSettings {
    fn default() -> Self {
        Self {
            decision_s: 0.1,
            max_steps: 400,
            goal_radius_m: 0.3,
            min_goal_m: 3.0,
            shows_path: true,
            shows_memory: false,
            goal_reward: 10.0,
            progress_reward: 1.0,
            collision_reward: -0.5,
            step_reward: -0.01,
        }
    }
}

impl DriveSettings {
    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        let check = SettingsCheck { part: "driving task" };
        check.positive("decision_s", self.decision_s)?;
        check.within("max_steps", self.max_steps, 1.0..=1e9, "from 1 to 1000000000")?;
        check.positive("goal_radius_m", self.goal_radius_m)?;
        check.not_negative("min_goal_m", self.min_goal_m)?;
        let rewards = [
            ("goal_reward", self.goal_reward),
            ("progress_reward", self.progress_reward),
            ("collision_reward", self.collision_reward),
            ("step_reward", self.step_reward),
        ];
        rewards
            .into_iter()
            .try_for_each(|(key, reward)| check.within(key, reward, -1e6..=1e6, "from -1000000 to 1000000"))
    }
}
