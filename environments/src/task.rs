//! What all tasks have in common.

use sim::physics::SnapshotError;

/// A world with a reward, for one or more agents.
///
/// All values for agents are slices with one part per agent, in the order of the agents.
pub trait Task: Send {
    /// The number of agents; at least one.
    fn agents(&self) -> usize;

    /// The number of actions of an agent; each is from −1 to 1.
    fn action_len(&self) -> usize;

    /// The parts of the observation of an agent, one after the other.
    fn parts(&self) -> Vec<Part>;

    /// The names of the values of [`Task::info`].
    fn info_names(&self) -> &'static [&'static str];

    /// Begins an episode. Everything random in it follows from `seed`.
    fn reset(&mut self, seed: u64);

    /// Simulates one step. An agent whose part of the episode is over stands still, and its action is ignored.
    fn step(&mut self, actions: &[f32], outcome: Outcome<'_>);

    /// Writes the observations of all agents.
    fn observe(&mut self, observations: &mut [f32]);

    /// Writes what is known about the last step: one value per name and agent.
    fn info(&self, info: &mut [f32]);

    /// The state as bytes.
    fn snapshot(&mut self) -> Vec<u8>;

    /// Returns to the state of a snapshot of a task with the same settings.
    ///
    /// # Errors
    ///
    /// When the bytes are not such a snapshot. The task must be reset then.
    fn restore(&mut self, snapshot: &[u8]) -> Result<(), SnapshotError>;
}

/// The result of a step, one value per agent.
pub struct Outcome<'a> {
    /// The reward of this step.
    pub rewards: &'a mut [f32],
    /// Whether the episode ended by what happened.
    pub terminated: &'a mut [bool],
    /// Whether the episode ended by its length.
    pub truncated: &'a mut [bool],
}

impl Outcome<'_> {
    /// Whether the episode is over for every agent.
    pub fn is_over(&self) -> bool {
        self.terminated.iter().zip(&*self.truncated).all(|(terminated, truncated)| *terminated || *truncated)
    }
}

/// A part of an observation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// The name.
    pub name: &'static str,
    /// The shape, row-major.
    pub shape: Vec<usize>,
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
    /// No robot of the world executes commands.
    #[error(
        "no robot of the world `{world}` is driven: give one of them `behaviour = {{ kind = \"driven\" }}`"
    )]
    NoDrivenRobot {
        /// The name of the world.
        world: String,
    },
    /// A driven robot has no free space at its start.
    #[error("the robot `{robot}` of the world `{world}` has no free space around its start")]
    NoSpace {
        /// The name of the robot.
        robot: String,
        /// The name of the world.
        world: String,
    },
    /// The driven robots differ in their sensors.
    #[error(
        "the robot `{robot}` has a laser with {found} beams, and the first driven robot one with {expected}"
    )]
    OtherBeams {
        /// The name of the robot.
        robot: String,
        /// Its number of beams.
        found: usize,
        /// The number of beams of the first driven robot.
        expected: usize,
    },
    /// The time of a decision is not a whole number of physics steps.
    #[error("a decision every {decision_s:?} s is not a whole number of physics steps of {step_s:?} s")]
    Decision {
        /// The time from one decision to the next, s.
        decision_s: f64,
        /// The physics step of the world, s.
        step_s: f64,
    },
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] interfaces::SettingsError),
    /// The controller cannot drive the robot.
    #[error(transparent)]
    Drive(#[from] evaluation::physics_trial::UnsupportedDrive),
    /// There is no world.
    #[error("exploring needs at least one world")]
    NoWorld,
    /// The lasers of the explorers of several worlds differ.
    #[error("the explorer of `{world}` has {found} beams, and that of the first world {expected}")]
    OtherExplorer {
        /// The name of the world.
        world: String,
        /// Its number of beams.
        found: usize,
        /// The number of beams in the first world.
        expected: usize,
    },
    /// An action is NaN or beyond −1 to 1.
    #[error("action {value} of environment {environment} is not from -1 to 1")]
    Action {
        /// The index of the environment.
        environment: usize,
        /// The action.
        value: f32,
    },
    /// A slice has the wrong length.
    #[error("{what}: {found} values, and not {expected}")]
    Length {
        /// What the slice is for.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The right length.
        expected: usize,
    },
}
