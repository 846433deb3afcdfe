//! What a task gives back, and what it refuses.

use interfaces::SettingsError;

/// The number of values of an action: linear and angular velocity.
pub const ACTIONS: usize = 2;

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
    /// The values of [`Drive::info`](crate::Drive::info) after the step, before a reset.
    pub info: Vec<f32>,
    /// Whether the task was over for all of its agents, and was reset; one value per task.
    pub was_reset: Vec<bool>,
}

impl Results {
    /// Memory for the results of one task: the numbers of its agents, and of the values of one observation and of the information
    /// about one agent.
    pub(crate) fn new(agents: usize, observation: usize, info: usize) -> Self {
        Self {
            observations: vec![0.0; agents * observation],
            rewards: vec![0.0; agents],
            terminated: vec![false; agents],
            truncated: vec![false; agents],
            last_observations: vec![0.0; agents * observation],
            info: vec![0.0; agents * info],
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

/// The error for a task that cannot be made, or for values of the wrong length or out of range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TaskError {
    /// A world does not suit the task.
    #[error("{0}")]
    World(String),
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// An action is NaN or beyond −1 to 1, or a slice has the wrong length.
    #[error("{0}")]
    Values(String),
}
