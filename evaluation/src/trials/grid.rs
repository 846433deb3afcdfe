use super::{Length, TrialError, TrialRobot, TrialSettings, TrialWorld};
use agent::{Agent, AgentSettings, Policy};
use controller::{CellDrive, Controller};
use interfaces::{Purpose, RandomStream};
use mapper::{Mapper, MapperSettings};
use robot::{Autonomous, ExactPoses, GoalSelector, Robot};
use sim::grid::{GridGroundTruth, GridSpec, GridWorld};

/// The settings of the robot in grid worlds.
#[derive(Clone, Debug)]
pub struct GridRobot {
    /// The maximum number of steps of local exploration.
    pub max_steps: u32,
}

impl Default for GridRobot {
    fn default() -> Self {
        Self { max_steps: 42 }
    }
}

impl TrialWorld for GridSpec {
    type World = GridWorld;
    type Truth = GridGroundTruth;
    type Robot = GridRobot;
    type Drive = CellDrive;
    const VIEW_EVERY: usize = 1;
    const COMPARE_EVERY: usize = 10;

    fn name(&self) -> &str {
        &self.name
    }

    fn length(length: u64) -> Length {
        Length::Grid { steps: length }
    }

    fn sensor_radius(&self) -> Option<u32> {
        Some(self.sensor_radius)
    }

    fn start(&self, seed: u64) -> GridWorld {
        GridWorld::new(self, seed)
    }

    fn truth(world: &GridWorld) -> &GridGroundTruth {
        world.truth()
    }

    fn agent(trial: &TrialSettings<Self>, policy: &Policy) -> Result<Agent, TrialError> {
        let sensor_radius_m = f64::from(trial.world.sensor_radius) * trial.world.frame().resolution_m();
        let settings = AgentSettings { sensor_radius_m, ..AgentSettings::default() };
        Ok(Agent::new(&settings, policy, RandomStream::new(trial.seed, Purpose::GridAgent))?)
    }

    fn robot<G: GoalSelector>(
        trial: &TrialSettings<Self>,
        _: &mut GridWorld,
        selector: G,
    ) -> Result<TrialRobot<Self, G>, TrialError> {
        let stream = RandomStream::new(trial.seed, Purpose::GridController);
        let pilot =
            Autonomous::new(selector, Controller::new(CellDrive, trial.experiment.robot.max_steps, stream));
        let settings = MapperSettings { estimator: trial.estimator.clone(), ..MapperSettings::default() };
        Ok(Robot::new(Box::new(ExactPoses), Mapper::new(&settings, *trial.world.frame())?, pilot))
    }
}
