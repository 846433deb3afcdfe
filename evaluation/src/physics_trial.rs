//! A run in a physics world as a library call: the settings of the robot, its parts, and the loop with the
//! observer.

use crate::map_hash::map_hash;
use crate::metrics::{age, map_scores, rate_scores, reachable_scores};
use crate::observer::Observer;
use crate::summary::{Contacts, Liveliest, RunResults};
use agent::{Agent, AgentSettings, Features, Policy};
use controller::{Controller, DiffDrive, DiffDriveSettings};
use interfaces::{CellState, Grid, LaserReading, Purpose, RandomStream, SettingsError, Twist, World};
use localizer::{GivenPoses, Localizer, LocalizerSettings, LoopClosingLocalizer, Start};
use mapper::{Mapper, MapperSettings, ReadingError};
use robot::{Autonomous, Belief, GoalSelector, Localization, Pilot, explore};
use serde::Serialize;
use sim::physics::shape::Transform;
use sim::physics::{BehaviorSpec, DriveKind, PhysicsWorld, WorldSpec};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// The side of the patches over which goal weights are averaged, m.
const PATCH_M: f64 = 0.5;
/// The time for which a body can hide a cell without interrupting the view of the cell, s: the time in which a slow
/// robot and its shadow pass. Without this time, only changes that are seen from the right side would count, one in
/// five.
const HIDING_S: f64 = 8.0;
/// The maximum number of steps of local exploration. The paper's 42 steps suit a block that moves one cell per
/// step. Here a step is a robot's diameter, and if the robot follows the dummy robot for longer, other rooms stay
/// unseen.
pub const LOCAL_STEPS: u32 = 15;
/// The maximum range noise that the mapper accepts, m.
const MAX_NOISE_M: f64 = 0.5;

/// How the robot knows its pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PoseChoice {
    /// The true pose: odometry without any error.
    #[default]
    Exact,
    /// The pose by odometry, with its errors.
    Odometry,
    /// The pose that the localizer estimates.
    Localized,
}

impl PoseChoice {
    /// Exact poses where the world says that its poses are exact, otherwise a localizer.
    pub fn of(spec: &WorldSpec) -> Self {
        if spec.driven().odometry.is_exact() { Self::Exact } else { Self::Localized }
    }

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Odometry => "odometry",
            Self::Localized => "localized",
        }
    }
}

/// All settings of a robot in a physics world.
#[derive(Clone, Debug, Serialize)]
pub struct PhysicsSettings {
    /// The settings of the mapper.
    pub mapper: MapperSettings,
    /// The settings of the agent.
    pub agent: AgentSettings,
    /// The settings of the controller.
    pub controller: controller::Settings,
    /// The settings of the drive.
    pub drive: DiffDriveSettings,
    /// How the robot knows its pose.
    pub pose: PoseChoice,
    /// The settings of the localizer.
    pub localizer: LocalizerSettings,
}

/// The error for a driven robot that the controller cannot drive.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the driven robot `{robot}` has a drive of `kind = \"{drive}\"`, but the controller supports only \
     `kind = \"diff\"`: change `[robot.drive]`, or let another robot be the driven one"
)]
pub struct UnsupportedDrive {
    /// The name of the robot.
    pub robot: String,
    /// The kind of the drive, as in the world file.
    pub drive: &'static str,
}

impl PhysicsSettings {
    /// The default settings for the driven robot of a world.
    ///
    /// # Errors
    ///
    /// When the robot has no differential drive.
    pub fn of(spec: &WorldSpec) -> Result<Self, UnsupportedDrive> {
        let (robot, defaults) = (spec.driven(), DiffDriveSettings::default());
        let unsupported = |drive| Err(UnsupportedDrive { robot: robot.name.clone(), drive });
        match robot.drive.kind {
            DriveKind::Differential => {}
            DriveKind::Omni { .. } => return unsupported("omni"),
            DriveKind::Car { .. } => return unsupported("car"),
        }
        let mut mapper = MapperSettings { max_gap: HIDING_S, ..MapperSettings::default() };
        let noise_m = &mut mapper.steady.range_noise_std_m;
        *noise_m = noise_m.max(robot.laser.noise_std_m).min(MAX_NOISE_M);
        let cell_m = spec.frame.resolution_m();
        let mut agent = AgentSettings {
            patch_cells: (PATCH_M / cell_m).round().max(1.0) as _,
            sensor_radius_m: robot.laser.range_max_m,
            looks_at_unseen: true,
            ..AgentSettings::default()
        };
        // A reward counts cells. The paper's temperature is for blocks of one cell; a robot is many cells wide, and
        // each of its moves changes about as many cells.
        agent.curious.temperature *= (2.0 * robot.radius_m / cell_m).max(1.0);
        let mut controller = controller::Settings::default();
        controller.exploration.max_steps = LOCAL_STEPS;
        let drive = DiffDriveSettings {
            radius_m: robot.radius_m,
            max_linear_mps: robot.drive.max_linear_mps,
            max_angular_radps: robot.drive.max_angular_radps,
            acceleration_mps2: robot.drive.max_linear_acceleration_mps2,
            angular_acceleration_radps2: robot.drive.max_angular_acceleration_radps2,
            tolerance_m: defaults.tolerance_m.min(robot.radius_m / 2.0),
            reaction_s: 1.0 / robot.laser.rate_hz + spec.step_s,
            ..defaults
        };
        let noise = mapper.steady.range_noise_std_m;
        let localizer = LocalizerSettings { range_noise_std_m: noise, ..LocalizerSettings::default() };
        Ok(Self { mapper, agent, controller, drive, pose: PoseChoice::of(spec), localizer })
    }

    /// The world in the frame of the map of a robot that is localized and knows no map, and the motion to it: the robot
    /// starts at the origin, and its heading follows from the seed, so that no wall is aligned with the cells. `None` for
    /// a robot that knows the frame of the world.
    pub fn in_own_frame(&self, spec: &WorldSpec, seed: u64) -> Option<(WorldSpec, Transform)> {
        let heading_rad = RandomStream::new(seed, Purpose::MapFrame).uniform(-PI..PI);
        (self.pose == PoseChoice::Localized).then(|| spec.around_robot(heading_rad))?
    }

    /// What gives the readings of a world their poses. `prior` is the map that the robot knows at the start.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn localization(
        &self,
        world: &mut PhysicsWorld,
        prior: Option<&Grid<CellState>>,
    ) -> Result<Box<dyn Localization<LaserReading>>, SettingsError> {
        Ok(match (self.pose, prior) {
            (PoseChoice::Exact, _) => {
                world.correct_odometry();
                Box::new(GivenPoses::default())
            }
            (PoseChoice::Odometry, _) => Box::new(GivenPoses::default()),
            (PoseChoice::Localized, None) => {
                let (start, frame) = (*world.true_pose(), world.spec().frame);
                Box::new(LoopClosingLocalizer::from_nothing(&self.localizer, &frame, start)?)
            }
            (PoseChoice::Localized, Some(map)) => {
                Box::new(Localizer::in_map(&self.localizer, map, Start::Unknown)?)
            }
        })
    }

    /// The pilot that drives to the goals of `selector`.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn pilot<G: GoalSelector>(
        &self,
        selector: G,
        seed: u64,
    ) -> Result<Autonomous<G, DiffDrive>, SettingsError> {
        let stream = RandomStream::new(seed, Purpose::Controller);
        let controller = Controller::new(self.controller, DiffDrive::new(self.drive)?, stream)?;
        Ok(Autonomous::new(selector, controller))
    }

    /// The agent that follows `policy`.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn agent(&self, policy: &Policy, seed: u64) -> Result<Agent, SettingsError> {
        Agent::new(&self.agent, policy, RandomStream::new(seed, Purpose::Agent))
    }
}

/// A run in a physics world: the world, the robot, and the measurements.
pub struct PhysicsTrial<P> {
    /// The world.
    pub world: PhysicsWorld,
    /// How the robot knows its pose.
    pub pose: PoseChoice,
    /// What gives readings their poses.
    pub localization: Box<dyn Localization<LaserReading>>,
    /// The map and the change statistics.
    pub mapper: Mapper,
    /// The pilot.
    pub pilot: P,
    /// The measurements.
    pub observer: Observer,
    /// The last command of a run that was ended, which the world has not executed.
    pub(crate) pending: Option<Twist>,
}

impl<P: Pilot<Command = Twist>> PhysicsTrial<P> {
    /// A run that has not started. `prior` is the map that the robot knows at the start.
    ///
    /// # Errors
    ///
    /// When a setting of the mapper is out of range.
    pub fn new(
        spec: &WorldSpec,
        seed: u64,
        settings: &PhysicsSettings,
        prior: Option<Grid<CellState>>,
        pilot: P,
    ) -> Result<Self, SettingsError> {
        let own = if prior.is_none() { settings.in_own_frame(spec, seed) } else { None };
        let spec = own.as_ref().map_or(spec, |(spec, _)| spec);
        let mut world = PhysicsWorld::new(spec, seed);
        let localization = settings.localization(&mut world, prior.as_ref())?;
        let mapper = match prior {
            None => Mapper::new(&settings.mapper, spec.frame)?,
            Some(map) => Mapper::with_prior(&settings.mapper, map)?,
        };
        let (pose, observer) = (settings.pose, Observer::default());
        Ok(Self { world, pose, localization, mapper, pilot, observer, pending: None })
    }

    /// Runs until `watch` breaks; the next call goes on from there. `watch` is called once per reading, after the
    /// measurement.
    ///
    /// # Errors
    ///
    /// When `watch` fails.
    pub fn run_with<E: From<ReadingError>>(
        &mut self,
        mut watch: impl FnMut(
            &PhysicsWorld,
            &LaserReading,
            &Belief,
            &mut P,
            &Observer,
        ) -> Result<ControlFlow<()>, E>,
    ) -> Result<(), E> {
        let Self { world, localization, mapper, pilot, observer, pending, .. } = self;
        pending.take().into_iter().for_each(|command| world.act(&command));
        let command =
            explore(world, localization.as_mut(), mapper, pilot, |world, reading, belief, pilot| {
                observer.observe(world, reading, belief, pilot);
                watch(world, reading, belief, pilot, observer)
            })?;
        *pending = Some(command);
        Ok(())
    }

    /// Runs until `end_s` of simulated time, or until the pilot is done.
    ///
    /// # Errors
    ///
    /// When the mapper refuses a reading.
    pub fn run(&mut self, end_s: f64) -> Result<(), ReadingError> {
        self.run_with(|_, reading, _, pilot, _| {
            let is_over = reading.time_s >= end_s || pilot.is_done();
            Ok(if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        })
    }

    /// The results so far.
    pub fn results(&self) -> RunResults {
        let Self { world, pose, mapper, pilot, observer, .. } = self;
        let truth = world.truth();
        let [block_latency, free_latency] = observer.latency.delays();
        let [contacts_while_standing, collisions] = observer.contacts;
        let strategies = pilot.strategies(Features::default()).into_iter();
        RunResults {
            map: map_scores(mapper, truth),
            reachable: reachable_scores(mapper, truth, &world.spec().visible_cells()),
            changing: observer.changing.scores(),
            predicted: observer.prediction.scores(),
            rates: rate_scores(mapper, truth),
            age: age(mapper, truth),
            block_latency,
            free_latency,
            collisions,
            contacts_while_standing,
            contacts: Contacts {
                own_motion: observer.own_contacts,
                run_into: contacts_while_standing + collisions - observer.own_contacts,
            },
            longest_standstill_s: longest_standstill_s(world, observer),
            pose: observer.poses.scores(pose.name()),
            goals: pilot.goals(),
            strategy_share: strategies.map(|strategy| (strategy.name, strategy.share)).collect(),
            things: observer.things.reports().cloned().collect(),
            curve: observer.curve.samples().to_vec(),
            map_hash: map_hash(mapper),
            liveliest: Liveliest::of(mapper),
        }
    }
}

/// The longest standstills of the robots that can move, by name.
fn longest_standstill_s(world: &PhysicsWorld, observer: &Observer) -> BTreeMap<String, f64> {
    let robots = world.spec().robots.iter().zip(observer.standstills.longest());
    let moving = robots.filter(|(robot, _)| robot.behavior != BehaviorSpec::Standing);
    moving.map(|(robot, (longest_s, _))| (robot.name.clone(), *longest_s)).collect()
}
