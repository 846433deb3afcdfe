//! Arguments → the parts of the loop.

use crate::args::{Args, DriveChoice};
use agent::{Agent, AgentSettings};
use anyhow::{Context, anyhow};
use controller::{Controller, DiffDrive, DiffDriveSettings};
use curious::keyboard::Keyboard;
use curious::worlds::{self, Loaded};
use evaluation::output::say;
use interfaces::{Purpose, RandomStream, Twist};
use mapper::{Mapper, MapperSettings};
use robot::{Autonomous, Tour};
use serde::Serialize;
use sim::physics::{PhysicsWorld, WorldSpec};
use std::io::stderr;
use std::path::Path;
use worldfile::{Disk, Findings, Severity, TourSpec, ros_map};

/// Why there is no result.
pub(crate) enum Failure {
    /// An argument or a file that was given is wrong.
    Input(anyhow::Error),
    /// Everything given was right, and still.
    Run(anyhow::Error),
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Self::Run(error)
    }
}

fn input(error: impl Into<anyhow::Error>) -> Failure {
    Failure::Input(error.into())
}

/// The side of the patches in which goals are weighed, m.
const PATCH_M: f64 = 0.5;
/// How long something can hide a cell before that interrupts its view, s: what a slow robot and its
/// shadow take to pass. Without this, the robot would only count the changes that it happens to see
/// from the right side, one in five.
const HIDING_S: f64 = 8.0;
/// Steps of local exploration. The paper's 42 suit a block that moves a cell per step; here a step
/// is a robot's diameter, and following the dummy for longer leaves other rooms unseen.
const LOCAL_STEPS: u32 = 15;

/// Noise beyond this is no laser's; the mapper takes no more.
const MAX_NOISE_M: f64 = 0.5;

/// All settings, as they go into the summary.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Settings {
    pub(crate) mapper: MapperSettings,
    pub(crate) agent: AgentSettings,
    pub(crate) controller: controller::Settings,
    pub(crate) drive: DiffDriveSettings,
}

impl Settings {
    fn new(args: &Args, spec: &WorldSpec) -> Self {
        let (robot, defaults) = (spec.driven(), DiffDriveSettings::default());
        let mut mapper = MapperSettings {
            estimator: args.estimator,
            occupancy: args.occupancy,
            max_gap: HIDING_S,
            ..MapperSettings::default()
        };
        // A laser's data sheet tells its noise.
        let noise_m = &mut mapper.steady.range_noise_std_m;
        *noise_m = noise_m.max(robot.laser.noise_std_m).min(MAX_NOISE_M);
        let cell_m = spec.frame.resolution_m();
        let mut agent = AgentSettings {
            patch_cells: (PATCH_M / cell_m).round().max(1.0) as _,
            sensor_radius_m: robot.laser.range_max_m,
            ..AgentSettings::default()
        };
        // A reward counts cells. The paper's temperature is for blocks of one cell; a robot is many
        // cells wide, and each of its moves changes as many.
        agent.curious.temperature *= (2.0 * robot.radius_m / cell_m).max(1.0);
        let mut controller = controller::Settings::default();
        controller.exploration.max_steps = LOCAL_STEPS;
        Self {
            mapper,
            agent,
            controller,
            drive: DiffDriveSettings {
                radius_m: robot.radius_m,
                max_linear_mps: robot.drive.max_linear_mps,
                max_angular_radps: robot.drive.max_angular_radps,
                acceleration_mps2: robot.drive.max_linear_acceleration_mps2,
                angular_acceleration_radps2: robot.drive.max_angular_acceleration_radps2,
                tolerance_m: defaults.tolerance_m.min(robot.radius_m / 2.0),
                reaction_s: 1.0 / robot.laser.rate_hz + spec.step_s,
                ..defaults
            },
        }
    }

    fn controller(&self, seed: u64) -> Result<Controller<DiffDrive>, Failure> {
        let drive = DiffDrive::new(self.drive).map_err(input)?;
        Controller::new(self.controller, drive, RandomStream::new(seed, Purpose::Controller)).map_err(input)
    }

    pub(crate) fn agent(&self, args: &Args) -> Result<Autonomous<Agent, DiffDrive>, Failure> {
        let agent = Agent::new(&self.agent, &args.strategy, RandomStream::new(args.seed, Purpose::Agent))
            .map_err(input)?;
        Ok(Autonomous::new(agent, self.controller(args.seed)?))
    }

    pub(crate) fn tour(&self, args: &Args) -> Result<Autonomous<Tour, DiffDrive>, Failure> {
        let (name, text) = worlds::TOUR;
        let tour = match &args.tour {
            Some(path) => TourSpec::load(path),
            None => TourSpec::parse(name, text),
        };
        let TourSpec { waypoints, repeat } = tour.map_err(input)?;
        Ok(Autonomous::new(Tour::new(waypoints, repeat), self.controller(args.seed)?))
    }

    pub(crate) fn keyboard(&self) -> Result<Keyboard, Failure> {
        let max =
            Twist { linear_mps: self.drive.max_linear_mps, angular_radps: self.drive.max_angular_radps };
        Keyboard::new(max).map_err(input)
    }
}

/// The world and the mind, before the run.
pub(crate) struct Parts {
    pub(crate) world: PhysicsWorld,
    pub(crate) mapper: Mapper,
    pub(crate) settings: Settings,
}

impl Parts {
    pub(crate) fn new(args: &Args) -> Result<Self, Failure> {
        if args.tour.is_some() && args.drive != DriveChoice::Tour {
            return Err(input(anyhow!("--tour is for --drive tour")));
        }
        let Loaded { spec, warnings } = worlds::load(&args.world).map_err(input)?;
        for warning in warnings {
            say(stderr(), format_args!("{warning}\n"));
        }
        let settings = Settings::new(args, &spec);
        let mapper = match &args.map {
            None => Mapper::new(&settings.mapper, spec.frame),
            Some(path) => {
                let mut findings = Findings::default();
                let map = ros_map::read(path, &Disk, &mut findings);
                for warning in findings.messages(Severity::Warning) {
                    say(stderr(), format_args!("{warning}\n"));
                }
                let map = map.ok_or_else(|| input(anyhow!(findings.error_text())))?;
                Mapper::with_prior(&settings.mapper, map.onto(&spec.frame))
            }
        };
        let mapper = mapper.context("cannot make the mapper").map_err(input)?;
        Ok(Self { world: PhysicsWorld::new(&spec, args.seed), mapper, settings })
    }
}
