//! The settings of driving tasks.

use crate::task::check_rewards;
use interfaces::{SettingsCheck, SettingsError};

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
        check_rewards(&check, &rewards)
    }
}
