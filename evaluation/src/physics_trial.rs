//! A run in a physics world as a library call: what the world says of itself, the robot, and the loop with the observer.

use crate::known_things::KnownThingsScores;
use crate::metrics::{age, interval_scores, map_scores, passage_scores, rate_scores};
use crate::observer::{Observer, map_hash};
use crate::scheduled_things::ScheduledThings;
use crate::summary::{Contacts, CurvePoint, RunResults};
use agent::Features;
use controller::{DiffDriveSettings, Driver};
use interfaces::{CellState, Grid, LaserReading, PoseMode, Purpose, RandomStream, SettingsError, Twist};
use mapper::{NoReturn, ReadingError};
use robot::{Battery, DaySettings, GoalSelector, PatrolDay, Pilot, Robot, Settings, Source, Turn};
use sim::physics::shape::Transform;
use sim::physics::{DriveKind, PatrolDaySpec, PhysicsWorld, WorldSpec};
use std::f64::consts::PI;

/// The Monday on which a week of a world with a calendar begins: 2024-01-01, s since 1970-01-01 UTC.
const MONDAY_S: f64 = 1_704_067_200.0;

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

/// What a world says of itself and of its driven robot.
///
/// # Errors
///
/// When the robot has no differential drive.
pub fn source(spec: &WorldSpec) -> Result<Source, UnsupportedDrive> {
    let robot = spec.driven();
    let unsupported = |drive| Err(UnsupportedDrive { robot: robot.name.clone(), drive });
    match robot.drive.kind {
        DriveKind::Differential => {}
        DriveKind::Omni { .. } => return unsupported("omni"),
        DriveKind::Car { .. } => return unsupported("car"),
    }
    let period_s = 1.0 / robot.laser.rate_hz;
    Ok(Source {
        pose: if robot.odometry.is_exact() { PoseMode::Exact } else { PoseMode::Localized },
        cell_m: spec.frame.resolution_m(),
        range_max_m: robot.laser.range_max_m,
        range_noise_m: Some(robot.laser.noise_std_m),
        // Without glass, nothing in a simulated world swallows beams.
        no_return: if spec.glass.is_empty() { NoReturn::Free } else { NoReturn::Learn },
        period_s,
        drive: DiffDriveSettings {
            radius_m: robot.radius_m,
            max_linear_mps: robot.drive.max_linear_mps,
            max_angular_radps: robot.drive.max_angular_radps,
            acceleration_mps2: robot.drive.max_linear_acceleration_mps2,
            angular_acceleration_radps2: robot.drive.max_angular_acceleration_radps2,
            reaction_s: period_s + spec.step_s,
            ..DiffDriveSettings::default()
        },
    })
}

/// The default settings for the driven robot of a world.
///
/// # Errors
///
/// When the robot has no differential drive.
pub fn settings(spec: &WorldSpec) -> Result<Settings, UnsupportedDrive> {
    let mut settings = Settings::of(&source(spec)?);
    if spec.starts_s.is_some() {
        settings.mapper.clocks = true;
        settings.mapper.time_zone = Some("UTC".to_owned());
    }
    Ok(settings)
}

/// The world in the frame of the map of a robot that is localized and knows no map, and the motion to it: the robot starts
/// at the origin, and its heading follows from the seed, so that no wall is aligned with the cells. `None` for a robot that
/// knows the frame of the world.
pub fn in_own_frame(settings: &Settings, spec: &WorldSpec, seed: u64) -> Option<(WorldSpec, Transform)> {
    let heading_rad = RandomStream::new(seed, Purpose::MapFrame).uniform(-PI..PI);
    (settings.pose == PoseMode::Localized).then(|| spec.around_robot(heading_rad))?
}

/// The driven robot of a world at its start. `prior` is the map that it knows.
///
/// # Errors
///
/// When a setting is out of range.
pub fn robot<P: Pilot>(
    settings: &Settings,
    world: &mut PhysicsWorld,
    prior: Option<Grid<CellState>>,
    pilot: P,
) -> Result<Robot<LaserReading, P>, SettingsError> {
    if settings.pose == PoseMode::Exact {
        world.correct_odometry();
    }
    let mut robot = settings.robot(world.spec().frame, prior, *world.true_pose(), pilot)?;
    if let Some(starts_s) = world.spec().starts_s {
        robot.mapper.set_epoch(MONDAY_S + starts_s, true);
    }
    Ok(robot)
}

/// A robot's day by a world: `None` for a robot that is always free to drive. `spec` is the world in the frame of the map.
pub fn day(spec: &WorldSpec) -> Option<DaySettings> {
    let PatrolDaySpec { dock, battery_s, share, busy } = spec.driven().patrol.clone()?;
    let dock = dock.unwrap_or(spec.driven().pose.translation.vector.into());
    Some(DaySettings { dock, battery_s, share, busy, starts_s: spec.starts_s.unwrap_or_default() })
}

/// A run in a physics world: the world, the robot, and the measurements.
pub struct PhysicsTrial<P> {
    /// The world.
    pub world: PhysicsWorld,
    /// How the robot knows its pose.
    pub pose: PoseMode,
    /// The robot.
    pub robot: Robot<LaserReading, P>,
    /// The measurements.
    pub observer: Observer,
    /// The last command, which the world executes at the next turn.
    pub(crate) command: Option<Twist>,
    /// The battery of the robot, where its pilot has one.
    battery: fn(&P) -> Option<&Battery>,
}

impl<G: GoalSelector, D: Driver<Command = Twist>> PhysicsTrial<PatrolDay<G, D>> {
    /// The same run: where the battery charges, time passes without readings.
    #[must_use]
    pub fn on_battery(self) -> Self {
        Self { battery: |pilot| Some(pilot.battery()), ..self }
    }
}

impl<P: Pilot<Command = Twist>> PhysicsTrial<P> {
    /// A run that has not started. `prior` is the map that the robot knows at the start.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn new(
        spec: &WorldSpec,
        seed: u64,
        settings: &Settings,
        prior: Option<Grid<CellState>>,
        pilot: P,
    ) -> Result<Self, SettingsError> {
        let own = if prior.is_none() { in_own_frame(settings, spec, seed) } else { None };
        let mut world = PhysicsWorld::new(own.as_ref().map_or(spec, |(spec, _)| spec), seed);
        let robot = robot(settings, &mut world, prior, pilot)?;
        Ok(Self {
            world,
            pose: settings.pose,
            robot,
            observer: Observer::default(),
            command: None,
            battery: |_| None,
        })
    }

    /// One turn: the world executes the last command, or passes the time for which the robot rests;
    /// the robot makes of the next reading another command, and the observer measures. Between two turns, the run can be saved.
    ///
    /// # Errors
    ///
    /// When the mapper refuses the reading.
    pub fn turn(&mut self) -> Result<Turn<LaserReading, Twist>, ReadingError> {
        if let Some(until_s) = self.rests_until_s() {
            self.rest(until_s);
        }
        let turn = robot::turn(&mut self.world, &mut self.robot, &mut self.command)?;
        self.observer.observe(&self.world, &mut self.robot, &turn);
        Ok(turn)
    }

    /// Runs until `end_s` of simulated time, or until the pilot is done. A rest at `end_s` is cut off; the run cannot be continued
    /// then.
    ///
    /// # Errors
    ///
    /// When the mapper refuses a reading.
    pub fn run(&mut self, end_s: f64) -> Result<(), ReadingError> {
        loop {
            if self.rests_until_s().is_some_and(|until_s| until_s > end_s) {
                self.rest(end_s);
                return Ok(());
            }
            if self.turn()?.reading.time_s >= end_s || self.robot.pilot.view().is_done {
                return Ok(());
            }
        }
    }

    /// Until when the robot rests in place of its last command, s; `None` if it drives.
    fn rests_until_s(&self) -> Option<f64> {
        let battery = (self.battery)(&self.robot.pilot)?;
        battery.rests_until_s().filter(|_| self.command.is_some())
    }

    /// Lets time pass. The map is compared with the world also while the robot does not look.
    fn rest(&mut self, until_s: f64) {
        self.command = None;
        self.world.rest_watched(until_s, ScheduledThings::EVERY_S, |world| {
            self.observer.scheduled.sample(world, &self.robot.mapper);
            self.observer.known_things.sample(world, &self.robot.mapper);
        });
        self.observer.poses.rest(until_s);
    }

    /// The results so far.
    pub fn results(&self) -> RunResults {
        let Self { world, pose, robot: Robot { mapper, pilot, .. }, observer, .. } = self;
        let truth = world.truth();
        let [block_latency, free_latency] = observer.latency.delays();
        let [contacts_while_standing, collisions] = observer.contacts;
        let strategies = pilot.strategies(Features::default()).into_iter();
        let curve = observer.curve.samples().iter();
        RunResults {
            map: map_scores(mapper, truth),
            changing: observer.changing.scores(),
            predicted: observer.prediction.scores(),
            forecasts: observer.forecasts.scores(),
            intervals: interval_scores(mapper, truth),
            passages: passage_scores(mapper, truth),
            rates: rate_scores(mapper, truth),
            age: age(mapper, truth),
            block_latency,
            free_latency,
            collisions,
            contacts: Contacts {
                own_motion: observer.own_contacts,
                run_into: contacts_while_standing + collisions - observer.own_contacts,
            },
            pose: observer.poses.scores(pose.name()),
            goals: pilot.view().goals,
            day: (self.battery)(pilot).map(Battery::totals),
            scheduled: observer.scheduled.scores(),
            known_things: KnownThingsScores::of(&observer.known_things.rows(world, mapper)),
            strategy_share: strategies.map(|strategy| (strategy.name, strategy.share)).collect(),
            curve: curve.map(|&(time_s, scores)| CurvePoint { time_s, scores }).collect(),
            map_hash: map_hash(mapper),
        }
    }
}
