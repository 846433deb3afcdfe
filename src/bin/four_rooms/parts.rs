//! Arguments → the parts of a run.

use crate::args::{Args, DriveChoice};
use agent::Agent;
use anyhow::{Context, anyhow};
use controller::DiffDrive;
use curious::keyboard::Keyboard;
use curious::program::{Failure, input};
use curious::terminal::say;
use curious::worlds::{self, Loaded};
use evaluation::physics_trial::PhysicsSettings;
use interfaces::{CellState, Grid, Twist};
use robot::{Autonomous, Tour};
use sim::physics::WorldSpec;
use std::io::stderr;
use std::path::Path;
use worldfile::ros_map::{self, RosMap};
use worldfile::{Disk, Findings, Severity, TourSpec};

/// The world and the settings of the robot.
pub(crate) struct Parts {
    pub(crate) spec: WorldSpec,
    pub(crate) settings: PhysicsSettings,
    /// The map that the robot knows at the start.
    pub(crate) prior: Option<Grid<CellState>>,
}

impl Parts {
    pub(crate) fn new(args: &Args) -> Result<Self, Failure> {
        if args.tour.is_some() && args.drive != DriveChoice::Tour {
            return Err(input(anyhow!("--tour needs --drive tour")));
        }
        let Loaded { spec, warnings } = worlds::load(&args.world).map_err(input)?;
        for warning in warnings {
            say(stderr(), format_args!("{warning}\n"));
        }
        let settings = PhysicsSettings::of(&spec).with_context(|| format!("cannot run `{}`", args.world));
        let mut settings = settings.map_err(input)?;
        settings.mapper.estimator = args.estimator.clone();
        settings.mapper.occupancy = args.occupancy.clone();
        let read = |path| read_map(path).map(|map| map.onto(&spec.frame));
        let prior = args.map.as_deref().map(read).transpose()?;
        Ok(Self { spec, settings, prior })
    }

    pub(crate) fn agent(&self, args: &Args) -> Result<Autonomous<Agent, DiffDrive>, Failure> {
        let agent = self.settings.agent(&args.strategy, args.seed).map_err(input)?;
        self.settings.pilot(agent, args.seed).map_err(input)
    }

    pub(crate) fn tour(&self, args: &Args) -> Result<Autonomous<Tour, DiffDrive>, Failure> {
        let (name, text) = worlds::TOUR;
        let tour = match &args.tour {
            Some(path) => TourSpec::load(path),
            None => TourSpec::parse(name, text),
        };
        let TourSpec { waypoints, repeat } = tour.map_err(input)?;
        self.settings.pilot(Tour::new(waypoints, repeat), args.seed).map_err(input)
    }

    pub(crate) fn keyboard(&self) -> Result<Keyboard, Failure> {
        let drive = &self.settings.drive;
        let max = Twist { linear_mps: drive.max_linear_mps, angular_radps: drive.max_angular_radps };
        Keyboard::new(max).map_err(input)
    }
}

/// Reads a ROS map; its warnings go to the error output.
fn read_map(path: &Path) -> Result<RosMap, Failure> {
    let mut findings = Findings::default();
    let map = ros_map::read(path, &Disk, &mut findings);
    for warning in findings.messages(Severity::Warning) {
        say(stderr(), format_args!("{warning}\n"));
    }
    map.ok_or_else(|| input(anyhow!(findings.error_text())))
}
