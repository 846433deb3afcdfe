use super::Length;
use super::{Poses, TrialError, TrialWorld};
use crate::oracle::Oracle;
use crate::physics_trial::{LOCAL_STEPS, PhysicsSettings, PoseChoice, UnsupportedDrive};
use agent::{Agent, Policy, Reward};
use controller::DiffDrive;
use mapper::MapperSettings;
use robot::{Autonomous, GoalSelector};
use sim::physics::{PhysicsGroundTruth, PhysicsWorld, WorldSpec};

/// The settings of the robot in physics worlds; all others are those of [`PhysicsSettings::of`].
#[derive(Clone, Copy, Debug)]
pub struct PhysicsRobot {
    /// The reward of the learner.
    pub reward: Reward,
    /// The maximum number of steps of local exploration.
    pub max_steps: u32,
    /// How the robot knows its pose; `None`: as the world suggests.
    pub pose: Option<PoseChoice>,
}

impl Default for PhysicsRobot {
    fn default() -> Self {
        Self { reward: Reward::default(), max_steps: LOCAL_STEPS, pose: None }
    }
}

impl PhysicsRobot {
    fn settings(&self, spec: &WorldSpec) -> Result<PhysicsSettings, UnsupportedDrive> {
        let mut settings = PhysicsSettings::of(spec)?;
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
        Some(robot.settings(self).ok()?.in_own_frame(self, seed)?.0)
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

    fn mapper(&self, robot: &PhysicsRobot) -> Result<MapperSettings, TrialError> {
        Ok(robot.settings(self)?.mapper)
    }

    fn localization(
        &self,
        robot: &PhysicsRobot,
        world: &mut PhysicsWorld,
    ) -> Result<Poses<Self>, TrialError> {
        Ok(robot.settings(self)?.localization(world, None)?)
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
    ) -> Result<Autonomous<G, DiffDrive>, TrialError> {
        Ok(robot.settings(self)?.pilot(selector, seed)?)
    }
}
