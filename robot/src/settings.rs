use crate::autonomous::Autonomous;
use crate::pilot::Pilot;
use crate::robot::{Localization, Robot};
use crate::session::max_step_s;
use agent::{Agent, AgentSettings, GoalSelector, Policy};
use controller::{Controller, DiffDrive, DiffDriveSettings};
use interfaces::{CellState, Grid, GridFrame, LaserReading, PoseMode, Purpose, RandomStream, SettingsError};
use localizer::{GivenPoses, LocalizerSettings, LoopClosingLocalizer, Switch};
use mapper::{Mapper, MapperSettings, NoReturn, ScanFilter, ScanFilterSettings, SharedPrior};
use nalgebra::Isometry2;
use serde::Serialize;

/// The side of the patches over which goal weights are averaged, m.
const PATCH_M: f64 = 0.5;
/// The time for which a body can hide a cell without interrupting the view of the cell, s: the time in which a slow robot and
/// its shadow pass. Without this time, only changes that are seen from the right side would count, one in five.
const HIDING_S: f64 = 8.0;
/// The maximum number of steps of local exploration. The paper's 42 steps suit a block that moves one cell per step. Here a
/// step is a robot's diameter, and if the robot follows another one for longer, other rooms stay unseen.
pub const LOCAL_STEPS: u32 = 15;
/// The range noise that the mapper accepts, m.
const NOISE_M: [f64; 2] = [0.01, 0.5];
/// The range noise of a source that declares none, m: with exact poses, and with poses that have errors of some centimeters.
const UNKNOWN_NOISE_M: [f64; 2] = [0.03, 0.06];

/// What a source of readings says of itself and of its robot: a world file, a log, the parameters of a live robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// How poses are known.
    pub pose: PoseMode,
    /// The side of a cell of the map, m.
    pub cell_m: f64,
    /// The maximum range of the laser, m.
    pub range_max_m: f64,
    /// The declared standard deviation of ranges, m; `None` if the source declares none.
    pub range_noise_m: Option<f64>,
    /// What the laser says by a beam without a return.
    pub no_return: NoReturn,
    /// The time from one scan to the next, s.
    pub period_s: f64,
    /// The body of the robot, its limits, and the time in which it reacts.
    pub drive: DiffDriveSettings,
}

impl Default for Source {
    /// A source that says nothing.
    fn default() -> Self {
        Self {
            pose: PoseMode::Localized,
            cell_m: 0.05,
            range_max_m: ScanFilterSettings::default().max_range_m,
            range_noise_m: None,
            no_return: NoReturn::Learn,
            period_s: 0.1,
            drive: DiffDriveSettings::default(),
        }
    }
}

/// All settings of a robot with a laser.
#[derive(Clone, Debug, Serialize)]
pub struct Settings {
    /// What is removed from scans.
    pub filter: ScanFilterSettings,
    /// The settings of the mapper.
    pub mapper: MapperSettings,
    /// The settings of the agent.
    pub agent: AgentSettings,
    /// The maximum number of steps of local exploration.
    pub local_steps: u32,
    /// The settings of the drive.
    pub drive: DiffDriveSettings,
    /// How the robot knows its pose.
    pub pose: PoseMode,
    /// The settings of the localizer.
    pub localizer: LocalizerSettings,
    /// When the robot changes to a map that it has learned again.
    #[serde(skip)]
    pub switch: Switch,
    /// Between readings that are farther apart, nothing was in view, s.
    #[serde(skip)]
    pub max_step_s: f64,
}

/// The default settings of the mapper of a robot with a laser. Its rates are those of the estimator that predicts best where
/// doors, people and robots move; the default of a mapper alone, `two-state-gaps`, is best for blocks in a grid world.
pub fn default_mapper() -> MapperSettings {
    MapperSettings { estimator: SharedPrior.into(), ..MapperSettings::default() }
}

impl Settings {
    /// The default settings for a source.
    pub fn of(source: &Source) -> Self {
        let noise_m = match source.range_noise_m {
            Some(noise_m) => noise_m.clamp(NOISE_M[0], NOISE_M[1]),
            None => UNKNOWN_NOISE_M[usize::from(source.pose != PoseMode::Exact)],
        };
        let mut mapper = MapperSettings { max_gap: HIDING_S, ..default_mapper() };
        mapper.steady.range_noise_std_m = noise_m;
        let mut agent = AgentSettings {
            patch_cells: (PATCH_M / source.cell_m).round().max(1.0) as _,
            sensor_radius_m: source.range_max_m,
            unseen_first: true,
            ..AgentSettings::default()
        };
        // A reward counts cells. The paper's temperature is for blocks of one cell; a robot is many cells wide, and each of its
        // moves changes about as many cells.
        agent.temperature *= (2.0 * source.drive.radius_m / source.cell_m).max(1.0);
        let filter = ScanFilterSettings {
            max_range_m: source.range_max_m.clamp(0.1, 1000.0),
            no_return: source.no_return,
            ..ScanFilterSettings::default()
        };
        let tolerance_m = source.drive.tolerance_m.min(source.drive.radius_m / 2.0);
        Self {
            filter: if source.pose == PoseMode::Exact { filter } else { filter.for_noise(noise_m) },
            mapper,
            agent,
            local_steps: LOCAL_STEPS,
            drive: DiffDriveSettings { tolerance_m, ..source.drive },
            pose: source.pose,
            localizer: LocalizerSettings { range_noise_std_m: noise_m, ..LocalizerSettings::default() },
            switch: Switch::default(),
            max_step_s: max_step_s(HIDING_S, source.period_s),
        }
    }

    /// The agent that follows `policy`.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn agent(&self, policy: &Policy, seed: u64) -> Result<Agent, SettingsError> {
        Agent::new(&self.agent, policy, RandomStream::new(seed, Purpose::Agent))
    }

    /// The controller that drives the robot.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn controller(&self, seed: u64) -> Result<Controller<DiffDrive>, SettingsError> {
        let stream = RandomStream::new(seed, Purpose::Controller);
        Ok(Controller::new(DiffDrive::new(self.drive)?, self.local_steps, stream))
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
    ) -> Result<Autonomous<G, Controller<DiffDrive>>, SettingsError> {
        Ok(Autonomous::new(selector, self.controller(seed)?))
    }

    /// A robot that has seen nothing, and that starts at a pose in the frame of an unknown map, or anywhere in a known one.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn robot<P: Pilot>(
        &self,
        frame: GridFrame,
        prior: Option<Grid<CellState>>,
        start: Isometry2<f64>,
        pilot: P,
    ) -> Result<Robot<LaserReading, P>, SettingsError> {
        let localization: Box<dyn Localization<LaserReading> + Send + Sync> = match self.pose {
            PoseMode::Exact | PoseMode::Odometry | PoseMode::Corrected => Box::new(GivenPoses::default()),
            PoseMode::Localized => {
                let mut localizer = LoopClosingLocalizer::from_nothing(&self.localizer, &frame, start)?;
                if let Some(map) = &prior {
                    localizer.begin_in(&[], map).unwrap_or_default(); // no bytes are invalid
                }
                Box::new(localizer.switching(self.switch))
            }
        };
        let mapper = match prior {
            None => Mapper::new(&self.mapper, frame)?,
            Some(map) => Mapper::with_prior(&self.mapper, map)?,
        };
        let filter = ScanFilter::new(&self.filter)?;
        let mut robot = Robot::new(localization, mapper, pilot).with_filter(filter);
        robot.session_mut().max_step_s = self.max_step_s;
        Ok(robot)
    }
}
