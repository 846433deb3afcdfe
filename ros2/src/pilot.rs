//! Who decides: nobody, the controller of this project, or Nav2 with goals of our agent.

mod navigation;

use crate::link::Navigation;
use crate::order::Order;
use crate::parameters::{Mode, Navigator, Parameters};
use agent::{Agent, AgentSettings, Features, Policy};
use anyhow::{Context, anyhow};
use controller::{Controller, DiffDrive, DiffDriveSettings};
use interfaces::{Purpose, RandomStream, SettingsError, Values};
use mapper::Mapper;
use nalgebra::Point2;
use navigation::NavigationPilot;
use robot::{Autonomous, Belief, GoalCount, Message, Pilot, StrategyState};

/// The side of the patches over which goal weights are averaged, m.
const PATCH_M: f64 = 0.5;
/// The most steps of local exploration at a goal: a step is a robot's diameter.
const LOCAL_STEPS: u32 = 15;
/// The time from a scan to the motion that follows from it, s.
const REACTION_S: f64 = 0.15;

/// Decides what the robot is asked to do.
pub(crate) enum LivePilot {
    /// The robot is driven by someone else.
    Watching,
    /// The controller drives.
    Driving {
        pilot: Box<Autonomous<Agent, DiffDrive>>,
        /// Whether the robot waits, see [`LivePilot::resume`].
        is_paused: bool,
    },
    /// Nav2 drives.
    Navigating(Box<NavigationPilot>),
}

impl LivePilot {
    /// The pilot for a mode.
    ///
    /// # Errors
    ///
    /// When a parameter is out of range.
    pub(crate) fn new(parameters: &Parameters) -> anyhow::Result<Self> {
        if parameters.mode == Mode::Map {
            return Ok(Self::Watching);
        }
        let seed = parameters.seed as u64;
        let settings = AgentSettings {
            patch_cells: (PATCH_M / parameters.resolution_m).round().max(1.0) as _,
            sensor_radius_m: parameters.max_laser_range_m,
            looks_at_unseen: true,
            ..AgentSettings::default()
        };
        let policy = policy(&parameters.strategy)?;
        let agent = Agent::new(&settings, &policy, RandomStream::new(seed, Purpose::Agent))?;
        let controller = controller(parameters, seed).context("cannot drive this robot")?;
        Ok(match parameters.navigator {
            Navigator::CmdVel => {
                Self::Driving { pilot: Box::new(Autonomous::new(agent, controller)), is_paused: false }
            }
            Navigator::Nav2 => Self::Navigating(Box::new(NavigationPilot::new(agent, controller, true))),
            Navigator::GoalPose => Self::Navigating(Box::new(NavigationPilot::new(agent, controller, false))),
        })
    }

    /// Lets the robot explore, or wait.
    pub(crate) fn resume(&mut self, resume: bool) {
        match self {
            Self::Watching => {}
            Self::Driving { pilot, is_paused } => {
                *is_paused = !resume;
                pilot.forget_map();
            }
            Self::Navigating(pilot) => pilot.resume(resume),
        }
    }

    /// Plans anew in a map that was replaced.
    pub(crate) fn forget_map(&mut self) {
        if let Self::Driving { pilot, .. } = self {
            pilot.forget_map();
        }
    }

    /// Takes the new state of the goal that Nav2 has.
    pub(crate) fn navigated(&mut self, navigation: Navigation) {
        if let Self::Navigating(pilot) = self {
            pilot.navigated(navigation);
        }
    }
}

fn controller(parameters: &Parameters, seed: u64) -> Result<Controller<DiffDrive>, SettingsError> {
    let defaults = DiffDriveSettings::default();
    let drive = DiffDriveSettings {
        radius_m: parameters.robot_radius_m,
        max_linear_mps: parameters.max_vel_x_mps,
        max_angular_radps: parameters.max_vel_theta_radps,
        acceleration_mps2: parameters.acc_lim_x_mps2,
        angular_acceleration_radps2: parameters.acc_lim_theta_radps2,
        tolerance_m: defaults.tolerance_m.min(parameters.robot_radius_m / 2.0),
        reaction_s: REACTION_S,
        ..defaults
    };
    let mut settings = controller::Settings::default();
    settings.exploration.max_steps = LOCAL_STEPS;
    Controller::new(settings, DiffDrive::new(drive)?, RandomStream::new(seed, Purpose::Controller))
}

fn policy(name: &str) -> anyhow::Result<Policy> {
    let known = Policy::built_in();
    known.iter().find(|policy| policy.name() == name).cloned().ok_or_else(|| {
        let names: Vec<&str> = known.iter().map(Policy::name).collect();
        anyhow!("the parameter `strategy` must be one of {}, not `{name}`", names.join(", "))
    })
}

impl Pilot for LivePilot {
    type Command = Order;

    fn command(&mut self, belief: &Belief) -> Order {
        match self {
            Self::Watching => Order::None,
            // The node stops the robot once. Then it leaves the robot to others.
            Self::Driving { is_paused: true, .. } => Order::None,
            Self::Driving { pilot, .. } => Order::Velocity(pilot.command(belief)),
            Self::Navigating(pilot) => pilot.command(belief),
        }
    }

    fn path(&self) -> &[Point2<f64>] {
        match self {
            Self::Driving { pilot, .. } => pilot.path(),
            Self::Watching | Self::Navigating(_) => &[],
        }
    }

    fn goal(&self) -> Option<Point2<f64>> {
        match self {
            Self::Watching => None,
            Self::Driving { pilot, .. } => pilot.goal(),
            Self::Navigating(pilot) => pilot.goal(),
        }
    }

    fn strategies(&self, features: Features) -> Vec<StrategyState> {
        match self {
            Self::Driving { pilot, .. } => pilot.strategies(features),
            Self::Watching | Self::Navigating(_) => Vec::new(),
        }
    }

    fn goals(&self) -> GoalCount {
        match self {
            Self::Watching => GoalCount::default(),
            Self::Driving { pilot, .. } => pilot.goals(),
            Self::Navigating(pilot) => pilot.goals(),
        }
    }

    fn take_messages(&mut self) -> Vec<Message> {
        match self {
            Self::Watching => Vec::new(),
            Self::Driving { pilot, .. } => pilot.take_messages(),
            Self::Navigating(pilot) => pilot.take_messages(),
        }
    }

    fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        match self {
            Self::Watching => Vec::new(),
            Self::Driving { pilot, .. } => pilot.values(mapper),
            Self::Navigating(pilot) => pilot.values(mapper),
        }
    }
}
