use super::Length;
use super::{TrialError, TrialWorld};
use crate::oracle::Oracle;
use crate::physics_trial::{self, UnsupportedDrive};
use agent::{Agent, Policy, Reward};
use controller::{Controller, DiffDrive};
use interfaces::{LaserReading, PoseMode};
use mapper::EstimatorChoice;
use robot::{Autonomous, GoalSelector, LOCAL_STEPS, Pilot, Robot, Settings};
use sim::physics::{PhysicsGroundTruth, PhysicsWorld, WorldSpec};

/// The settings of the robot in physics worlds; all others are those of [`physics_trial::settings`].
#[derive(Clone, Copy, Debug)]
pub struct PhysicsRobot {
    /// The reward of the learner.
    pub reward: Reward,
    /// The maximum number of steps of local exploration.
    pub max_steps: u32,
    /// How the robot knows its pose; `None`: as the world suggests.
    pub pose: Option<PoseMode>,
}

impl Default for PhysicsRobot {
    fn default() -> Self {
        Self { reward: Reward::default(), max_steps: LOCAL_STEPS, pose: None }
    }
}

impl PhysicsRobot {
    fn settings(&self, spec: &WorldSpec) -> Result<Settings, UnsupportedDrive> {
        let mut settings = physics_trial::settings(spec)?;
        settings.agent.reward = self.reward;
        settings.controller.exploration.max_steps = self.max_steps;
        settings.pose = self.pose.unwrap_or(settings.pose);
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

    fn sensor_radius(&self) -> Option<u32> {
        None
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

    fn collisions(world: &PhysicsWorld) -> Option<u64> {
        Some(world.contacts().iter().filter(|contact| contact.moving).count() as u64)
    }

    fn agent(&self, robot: &PhysicsRobot, policy: &Policy, seed: u64) -> Result<Agent, TrialError> {
        Ok(robot.settings(self)?.agent(policy, seed)?)
    }

    fn oracle(&self) -> Oracle {
        Oracle::in_physics(self)
    }

    fn pilot<G: GoalSelector>(
        &self,
        robot: &PhysicsRobot,
        selector: G,
        seed: u64,
    ) -> Result<Autonomous<G, Controller<DiffDrive>>, TrialError> {
        Ok(robot.settings(self)?.pilot(selector, seed)?)
    }

    fn robot<P: Pilot>(
        &self,
        robot: &PhysicsRobot,
        estimator: &EstimatorChoice,
        world: &mut PhysicsWorld,
        pilot: P,
    ) -> Result<Robot<LaserReading, P>, TrialError> {
        let mut settings = robot.settings(self)?;
        settings.mapper.estimator = estimator.clone();
        Ok(physics_trial::robot(&settings, world, None, pilot)?)
    }
}
