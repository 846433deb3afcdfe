use super::{Experiment, Length, TrialError, TrialStrategy};
use agent::{Agent, Policy};
use controller::{Controller, Drive};
use interfaces::{GroundTruth, Reading, World};
use mapper::EstimatorChoice;
use robot::{Autonomous, GoalSelector, Robot};

/// Everything that determines a trial.
pub struct TrialSettings<'a, W: TrialWorld> {
    /// The number of the trial in the experiment, from 1 on, in the order of a report: by world, estimator, strategy
    /// and seed.
    pub number: u64,
    /// The world.
    pub world: &'a W,
    /// The estimator of rates.
    pub estimator: &'a EstimatorChoice,
    /// The strategy that chooses goals.
    pub strategy: &'a TrialStrategy,
    /// The seed of all random streams.
    pub seed: u64,
    /// The other settings.
    pub experiment: &'a Experiment<W>,
}

/// The specification of a world in which trials run, of one kind.
pub trait TrialWorld: Sized + Sync {
    /// The simulated world.
    type World: World<Reading: Reading + Clone, Command: Clone>;
    /// The ground truth of the simulated world.
    type Truth: GroundTruth;
    /// The settings of the robot that are the same in all worlds.
    type Robot: Sync;
    /// The drive of the robot.
    type Drive: Drive<Command = <Self::World as World>::Command>;

    /// Whether a changing cell is in view is checked once in this number of readings.
    const VIEW_EVERY: usize;
    /// The swept cells are compared with the map once in this number of readings, and at every sample.
    const COMPARE_EVERY: usize;

    /// The name of the world.
    fn name(&self) -> &str;

    /// The length of a trial, from a number of steps or seconds.
    fn length(length: u64) -> Length;

    /// The range of the sensor of a grid world, in cells.
    fn sensor_radius(&self) -> Option<u32> {
        None
    }

    /// The world in the frame of the robot's own map; `None` if the robot knows the frame of the world.
    fn in_own_frame(&self, _: &Self::Robot, _seed: u64) -> Option<Self> {
        None
    }

    /// The world at its start.
    fn start(&self, seed: u64) -> Self::World;

    /// The ground truth of a world.
    fn truth(world: &Self::World) -> &Self::Truth;

    /// The number of collisions of the moving robot since the last reading; `None` where no robot can collide.
    fn collisions(_world: &Self::World) -> Option<u64> {
        None
    }

    /// The agent that follows `policy`.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    fn agent(trial: &TrialSettings<Self>, policy: &Policy) -> Result<Agent, TrialError>;
    /// The robot at its start in a world, whose pilot drives to the goals of `selector`.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    fn robot<G: GoalSelector>(
        trial: &TrialSettings<Self>,
        world: &mut Self::World,
        selector: G,
    ) -> Result<TrialRobot<Self, G>, TrialError>;
}

/// The robot of a trial, with what chooses its goals.
pub type TrialRobot<W, G> =
    Robot<<<W as TrialWorld>::World as World>::Reading, Autonomous<G, Controller<<W as TrialWorld>::Drive>>>;
