//! What all tasks have in common.

use draw::canvas::{Canvas, PictureError};
use draw::scene::Scene;
use evaluation::scenes::Displayed;
use interfaces::{SettingsCheck, SettingsError, Twist};
use sim::physics::{DriveLimits, Fleet, SnapshotError};

/// The number of values of an action: linear and angular velocity.
pub const ACTIONS: usize = 2;

/// What rounding may add to an action.
pub(crate) const ROUNDING: f32 = 1e-6;

/// A world with a reward, for one or more agents.
///
/// All values for agents are slices with one part per agent, in the order of the agents.
pub trait Task: Send + Sync {
    /// The number of agents; at least one.
    fn agents(&self) -> usize;

    /// The kind of the task, for messages.
    fn kind(&self) -> &'static str;

    /// The parts of the observation of an agent, one after the other.
    fn parts(&self) -> Vec<Part>;

    /// The names of the values of [`Task::info`].
    fn info_names(&self) -> &'static [&'static str];

    /// Begins an episode. Everything random in it follows from `seed`.
    fn reset(&mut self, seed: u64);

    /// Simulates one step. An agent whose part of the episode is over stands still, and its action is ignored.
    /// Writes rewards and ends. The actions are [`ACTIONS`] shares of the maximum velocity per agent, from −1 to 1.
    fn step(&mut self, actions: &[f32], results: &mut Results);

    /// Writes the observations of all agents.
    fn observe(&mut self, observations: &mut [f32]);

    /// Writes what is known about the last step: one value per name and agent.
    fn info(&self, info: &mut [f32]);

    /// The task from above, at most `size` pixels wide and high.
    ///
    /// # Errors
    /// When it cannot be drawn.
    fn picture(&self, size: u32) -> Result<Canvas, PictureError>;
    /// The state as bytes.
    fn snapshot(&mut self) -> Vec<u8>;

    /// Returns to the state of a snapshot of a task with the same settings.
    ///
    /// # Errors
    ///
    /// When the bytes are not such a snapshot. The task must be reset then.
    fn restore(&mut self, snapshot: &[u8]) -> Result<(), SnapshotError>;
}

/// The results of a step, each with one part per task; in a task, one part per agent.
#[derive(Clone, Debug, Default)]
pub struct Results {
    /// The observations after the step; of a task that was over, after its reset.
    pub observations: Vec<f32>,
    /// The rewards of this step.
    pub rewards: Vec<f32>,
    /// Whether the episode ended by what happened.
    pub terminated: Vec<bool>,
    /// Whether the episode ended by its length.
    pub truncated: Vec<bool>,
    /// The last observations of tasks that were over; those of other tasks stay as they were. Of several tasks: nothing if none was
    /// reset.
    pub last_observations: Vec<f32>,
    /// The values of [`Task::info`] after the step, before a reset.
    pub info: Vec<f32>,
    /// Whether the task was over for all of its agents, and was reset; one value per task.
    pub was_reset: Vec<bool>,
}

impl Results {
    /// Memory for the results of one task.
    pub(crate) fn of(task: &dyn Task) -> Self {
        let agents = task.agents();
        let observations = vec![0.0; agents * task.parts().iter().map(Part::values).sum::<usize>()];
        Self {
            last_observations: observations.clone(),
            observations,
            rewards: vec![0.0; agents],
            terminated: vec![false; agents],
            truncated: vec![false; agents],
            info: vec![0.0; agents * task.info_names().len()],
            was_reset: vec![false],
        }
    }

    /// The results of several tasks, one after the other.
    pub(crate) fn joined<'a>(parts: impl Iterator<Item = &'a Self> + Clone) -> Self {
        let mut all = Self::default();
        // As large as half of all values, and seldom needed.
        let has_last = parts.clone().any(|part| part.was_reset.contains(&true));
        for part in parts {
            all.observations.extend_from_slice(&part.observations);
            all.rewards.extend_from_slice(&part.rewards);
            all.terminated.extend_from_slice(&part.terminated);
            all.truncated.extend_from_slice(&part.truncated);
            if has_last {
                all.last_observations.extend_from_slice(&part.last_observations);
            }
            all.info.extend_from_slice(&part.info);
            all.was_reset.extend_from_slice(&part.was_reset);
        }
        all
    }

    /// Whether the episode is over for every agent.
    pub fn is_over(&self) -> bool {
        self.terminated.iter().zip(&self.truncated).all(|(terminated, truncated)| *terminated || *truncated)
    }
}

/// Writes ranges as shares of the maximum range: 1 without a return (+∞), 0 where the measurement is invalid or too close
/// (−∞).
pub(crate) fn write_scan(to: &mut [f32], ranges_m: &[f32], range_max_m: f64) {
    let scale = 1.0 / range_max_m as f32;
    for (value, range_m) in to.iter_mut().zip(ranges_m) {
        *value = if range_m.is_nan() { 0.0 } else { (range_m * scale).clamp(0.0, 1.0) };
    }
}

/// Writes values from −1 to 1.
pub(crate) fn write_state(to: &mut [f32], values: impl IntoIterator<Item = f64>) {
    for (state, value) in to.iter_mut().zip(values) {
        *state = value.clamp(-1.0, 1.0) as f32;
    }
}

/// The velocity that an agent wants: its actions are shares of the maximum.
pub(crate) fn twist(drive: &DriveLimits, actions: &[f32]) -> Twist {
    let [linear, angular] = [0, 1].map(|index| f64::from(actions.get(index).copied().unwrap_or(0.0)));
    Twist { linear_mps: linear * drive.max_linear_mps, angular_radps: angular * drive.max_angular_radps }
}

/// The robots and the obstacles as they are now.
pub(crate) fn present_scene(fleet: &Fleet) -> Scene {
    let mut scene = fleet.spec().scene();
    scene.obstacles.iter_mut().for_each(|obstacle| obstacle.outline.clear());
    for obstacle in fleet.obstacles() {
        scene.obstacles[obstacle.index].outline = obstacle.corners.to_vec();
    }
    fleet.robots().for_each(|robot| scene.robots[robot.index].pose = robot.pose);
    scene
}

/// A part of an observation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// The name.
    pub name: &'static str,
    /// The shape, row-major.
    pub shape: Vec<usize>,
    /// Names and lengths of slices along the last axis, or along the first axis of a part with layers (three axes), one after
    /// the other; empty if the axis has no names.
    pub slices: Vec<(&'static str, usize)>,
}

impl Part {
    /// The number of values.
    pub fn values(&self) -> usize {
        self.shape.iter().product()
    }
}

/// The error for a task that cannot be made, or for values of the wrong length or out of range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TaskError {
    /// A world does not suit the task.
    #[error("{0}")]
    World(String),
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The controller cannot drive the robot.
    #[error(transparent)]
    Drive(#[from] evaluation::physics_trial::UnsupportedDrive),
    /// An action is NaN or beyond −1 to 1, or a slice has the wrong length.
    #[error("{0}")]
    Values(String),
}

/// Checks rewards of settings.
pub(crate) fn check_rewards(
    check: &SettingsCheck,
    rewards: &[(&'static str, f64)],
) -> Result<(), SettingsError> {
    let check = |(key, reward): &(&'static str, f64)| {
        check.within(key, *reward, -1e6..=1e6, "from -1000000 to 1000000")
    };
    rewards.iter().try_for_each(check)
}
