//! Arguments → the parts of a run.

use crate::args::{Args, DriveChoice};
use agent::Agent;
use anyhow::{Context, anyhow};
use cli::flags::value_of;
use cli::program::{Failure, input, open_state, state_failure};
use cli::terminal::say;
use controller::{Controller, DiffDrive};
use curious::reachability;
use curious::worlds::{self, Loaded};
use evaluation::physics_trial::{self, PhysicsTrial};
use evaluation::trial_state::TrialFacts;
use interfaces::{CellState, Grid, Twist};
use robot::state::{SavedSettings, Sessions, StateFile};
use robot::{Autonomous, PatrolDay, Pilot, Settings, Tour};
use sim::physics::shape::Transform;
use sim::physics::{PatrolDaySpec, WorldSpec};
use std::io;
use std::io::stderr;
use std::path::Path;
use worldfile::{Disk, Findings, Severity, TourSpec, ros_map};

/// The world and the settings of the robot.
pub(crate) struct Parts {
    pub(crate) spec: WorldSpec,
    pub(crate) settings: Settings,
    /// The map that the robot knows at the start.
    pub(crate) prior: Option<Grid<CellState>>,
}

impl Parts {
    pub(crate) fn new(args: &Args) -> Result<Self, Failure> {
        if args.tour.is_some() && args.drive != DriveChoice::Tour {
            return Err(input(anyhow!("--tour needs --drive tour")));
        }
        if args.strategy.is_some() && args.drive != DriveChoice::Agent {
            return Err(input(anyhow!("--strategy is for the agent: leave out --drive, or --strategy")));
        }
        let Loaded { spec, warnings } =
            worlds::load(&args.world).map_err(|error| input(value_of("--world", error)))?;
        warn(warnings);
        warn(reachability::warnings(spec.fleet()));
        let spec = with_patrol(args, spec)?;
        let settings = physics_trial::settings(&spec).with_context(|| format!("cannot run `{}`", args.world));
        let mut settings = settings.map_err(input)?;
        settings.mapper.estimator = args.estimator.clone();
        settings.mapper.occupancy = args.occupancy.clone();
        settings.pose = args.pose.unwrap_or(settings.pose);
        let prior = args.map.as_deref().map(|path| known_map(path, &spec)).transpose()?;
        Ok(Self { spec, settings, prior })
    }

    pub(crate) fn agent(&self, args: &Args) -> Result<Autonomous<Agent, Controller<DiffDrive>>, Failure> {
        let agent = self.settings.agent(&args.strategy(), args.seed).map_err(input)?;
        self.settings.pilot(agent, args.seed).map_err(input)
    }

    /// The run that a pilot begins.
    pub(crate) fn trial<P: Pilot<Command = Twist>>(
        &self,
        args: &Args,
        pilot: P,
    ) -> Result<PhysicsTrial<P>, Failure> {
        let trial = PhysicsTrial::new(&self.spec, args.seed, &self.settings, self.prior.clone(), pilot);
        trial.context("cannot make the mapper").map_err(input)
    }

    /// The agent of a robot with a battery, or with orders by others.
    pub(crate) fn agent_with_day(
        &self,
        args: &Args,
    ) -> Result<PatrolDay<Agent, Controller<DiffDrive>>, Failure> {
        let own = self.own_frame(args);
        let day = physics_trial::day(own.as_ref().map_or(&self.spec, |(spec, _)| spec));
        let day = day.context("the robot has no patrol").map_err(input)?;
        Ok(PatrolDay::new(self.agent(args)?, day))
    }

    /// The world in the frame of the map, and the motion to it, if this is another frame.
    fn own_frame(&self, args: &Args) -> Option<(WorldSpec, Transform)> {
        self.prior.is_none().then(|| physics_trial::in_own_frame(&self.settings, &self.spec, args.seed))?
    }

    pub(crate) fn tour(&self, args: &Args) -> Result<Autonomous<Tour, Controller<DiffDrive>>, Failure> {
        let (name, text) = worlds::TOUR;
        let home = worlds::SHIPPED[0].0;
        let tour = match &args.tour {
            Some(path) => TourSpec::load(path),
            None if worlds::load(home).is_ok_and(|home| home.spec.walls == self.spec.walls) => {
                TourSpec::parse(name, text)
            }
            None => {
                let name = &self.spec.name;
                return Err(input(anyhow!(
                    "the tour that ships is for the walls of `{home}`: for `{name}`, give waypoints by --tour FILE"
                )));
            }
        };
        let TourSpec { mut waypoints, repeat } = tour.map_err(input)?;
        if let Some((_, to_own)) = self.own_frame(args) {
            waypoints.iter_mut().for_each(|at| *at = to_own.point(at));
        }
        Ok(self.settings.pilot(Tour::new(waypoints, repeat), args.seed).map_err(input)?.patient())
    }

    /// What the state of a pilot belongs to, beside the settings.
    pub(crate) fn pilot_facts(&self, args: &Args) -> SavedSettings {
        let facts = SavedSettings::default().with("--drive", &args.drive.name());
        let facts = match &self.spec.driven().patrol {
            Some(day) if args.drive == DriveChoice::Agent => {
                facts.with("--patrol", &day.share).with("battery_s", &day.battery_s)
            }
            _ => facts,
        };
        match (args.drive, &args.tour) {
            (DriveChoice::Agent, _) => facts.with("--strategy", &args.strategy().name()),
            (DriveChoice::Tour, Some(tour)) => facts.with("--tour", &tour.display().to_string()),
            _ => facts,
        }
    }
}

/// The world with the patrol of the command line, if one is given.
fn with_patrol(args: &Args, spec: WorldSpec) -> Result<WorldSpec, Failure> {
    let Some(share) = args.patrol else { return Ok(spec) };
    if args.drive != DriveChoice::Agent {
        return Err(input(anyhow!("--patrol is for the agent: leave out --drive, or --patrol")));
    }
    let of_file = spec.driven().patrol.clone();
    let mut day = of_file.unwrap_or_else(|| PatrolDaySpec::of_share(share));
    day.share = share;
    Ok(spec.with_patrol(day))
}

/// Reads a ROS map as the knowledge of the robot in a world; warnings go to the error output.
fn known_map(path: &Path, spec: &WorldSpec) -> Result<Grid<CellState>, Failure> {
    let mut findings = Findings::default();
    let map = ros_map::read(path, &Disk, &mut findings);
    warn(findings.messages(Severity::Warning));
    let map = map.ok_or_else(|| input(anyhow!(findings.error_text())))?;
    let known = map.onto(&spec.frame);
    if known.cells().iter().all(|state| *state == CellState::Unknown) {
        return Err(input(anyhow!(
            "{}: the map shows nothing of the world `{}`: check `origin` and `resolution`",
            path.display(),
            spec.name
        )));
    }
    Ok(known)
}

fn warn(warnings: impl IntoIterator<Item = String>) {
    warnings.into_iter().for_each(|warning| say(stderr(), format_args!("{warning}\n")));
}

// `--state`: where a run goes on from, and what it leaves for the next one.

/// The state file of a run.
pub(crate) struct TrialStateFile {
    file: StateFile,
    facts: TrialFacts,
    sessions: Sessions,
}

impl TrialStateFile {
    /// The file of `--state`. If there is a state in it, the run goes on from there.
    pub(crate) fn open(
        args: &Args,
        parts: &Parts,
        trial: &mut PhysicsTrial<impl Pilot<Command = Twist>>,
    ) -> Result<Option<Self>, Failure> {
        let Some(path) = &args.state else { return Ok(None) };
        let (file, state) = open_state(path, args.state_every)?;
        let mut facts = TrialFacts::new(&parts.spec, args.seed, &parts.settings, parts.pilot_facts(args));
        facts.allows_other_build = args.allow_other_build;
        let mut sessions = Sessions::of("four_rooms");
        if let Some(state) = state {
            trial.restore(&state, &facts).map_err(|why| state_failure(path, why))?;
            sessions.go_on(&state, &trial.robot.mapper);
        }
        Ok(Some(Self { file, facts, sessions }))
    }

    pub(crate) fn is_due(&self) -> bool {
        self.file.is_due()
    }

    /// Begins to write the state. An error is that of the writing before.
    pub(crate) fn save(&mut self, trial: &mut PhysicsTrial<impl Pilot<Command = Twist>>) -> io::Result<()> {
        self.file.save(trial.snapshot(&self.facts, &self.sessions))
    }

    /// Writes the state, and waits until it is on the disk.
    pub(crate) fn finish(mut self, trial: &mut PhysicsTrial<impl Pilot<Command = Twist>>) -> io::Result<()> {
        // What could not be written before is in this state as well.
        self.save(trial).ok();
        self.file.wait()
    }
}
