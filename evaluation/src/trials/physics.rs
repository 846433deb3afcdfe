use super::{Length, TrialError, TrialRobot, TrialSettings, TrialWorld};
use crate::physics_trial::{self, UnsupportedDrive};
use agent::{Agent, Policy};
use controller::DiffDrive;
use interfaces::PoseMode;
use robot::{GoalSelector, LOCAL_STEPS, Settings};
use sim::physics::{PhysicsGroundTruth, PhysicsWorld, WorldSpec};

/// The settings of the robot in physics worlds; all others are those of [`physics_trial::settings`].
#[derive(Clone, Copy, Debug)]
pub struct PhysicsRobot {
    /// The maximum number of steps of local exploration.
    pub max_steps: u32,
    /// How the robot knows its pose; `None`: as the world suggests.
    pub pose: Option<PoseMode>,
    /// Whether the robot looks into unseen space before it asks its strategy, as everywhere but in trials.
    pub unseen_first: bool,
}

impl Default for PhysicsRobot {
    fn default() -> Self {
        Self { max_steps: LOCAL_STEPS, pose: None, unseen_first: false }
    }
}

impl PhysicsRobot {
    fn settings(&self, spec: &WorldSpec) -> Result<Settings, UnsupportedDrive> {
        let mut settings = physics_trial::settings(spec)?;
        settings.local_steps = self.max_steps;
        settings.pose = self.pose.unwrap_or(settings.pose);
        settings.agent.unseen_first = self.unseen_first;
        Ok(settings)
    }
}

impl TrialWorld for WorldSpec {
    type World = PhysicsWorld;
    type Truth = PhysicsGroundTruth;
    type Robot = PhysicsRobot;
    type Drive = DiffDrive;
    // Each check is a pass over the map.
    const VIEW_EVERY: usize = 50;
    const COMPARE_EVERY: usize = 50;

    fn name(&self) -> &str {
        &self.name
    }

    fn length(length: u64) -> Length {
        Length::Physics { duration_s: length }
    }

    fn in_own_frame(&self, robot: &PhysicsRobot, seed: u64) -> Option<Self> {
        Some(physics_trial::in_own_frame(&robot.settings(self).ok()?, self, seed)?.0)
    }

    fn start(&self, seed: u64) -> PhysicsWorld {
        PhysicsWorld::new(self, seed)
    }

    fn truth(world: &PhysicsWorld) -> &PhysicsGroundTruth {
        world.truth()
    }

    fn physics(world: &PhysicsWorld) -> Option<&PhysicsWorld> {
        Some(world)
    }

    fn agent(trial: &TrialSettings<Self>, policy: &Policy) -> Result<Agent, TrialError> {
        Ok(trial.experiment.robot.settings(trial.world)?.agent(policy, trial.seed)?)
    }

    fn robot<G: GoalSelector>(
        trial: &TrialSettings<Self>,
        world: &mut PhysicsWorld,
        selector: G,
    ) -> Result<TrialRobot<Self, G>, TrialError> {
        let mut settings = trial.experiment.robot.settings(trial.world)?;
        settings.mapper.estimator = trial.estimator.clone();
        let pilot = settings.pilot(selector, trial.seed)?;
        Ok(physics_trial::robot(&settings, world, None, pilot)?)
    }
}
