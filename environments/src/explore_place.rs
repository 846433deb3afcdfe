//! The worlds of exploring tasks, built once and shared.

use crate::patches::Patches;
use crate::task::TaskError;
use evaluation::physics_trial;
use interfaces::{LaserReading, PoseMode, SettingsCheck, SettingsError};
use nalgebra::Isometry2;
use robot::{NoPilot, Robot, Settings};
use sim::physics::{ContactModel, FleetSpec, PhysicsWorld, WorldSpec};

/// Settings of [`Explore`](crate::Explore).
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ExploreSettings {
    /// The number of readings after which an episode is truncated.
    pub max_steps: u32,
    /// The number of beams of the laser; `None`: as in the world. Its other properties are those of the world.
    pub beams: Option<usize>,
    /// The number of readings from one measurement of the log error to the next.
    pub error_every: u32,
    /// The number of readings from one refresh of the map in the observation to the next.
    pub map_every: u32,
    /// The reward per map update (a known cell that is found changed), divided by the number of cells in the width of
    /// the robot.
    pub update_reward: f64,
    /// The reward per fall of the log error of the rates by 1.
    pub error_reward: f64,
    /// The reward (below 0) of a collision of the moving robot.
    pub collision_reward: f64,
}

impl Default for ExploreSettings {
    fn default() -> Self {
        Self {
            max_steps: 3000,
            beams: Some(180),
            error_every: 50,
            map_every: 10,
            update_reward: 1.0,
            error_reward: 10.0,
            collision_reward: -0.5,
        }
    }
}

impl ExploreSettings {
    fn check(&self) -> Result<(), SettingsError> {
        let check = SettingsCheck { part: "exploring task" };
        check.within("max_steps", self.max_steps, 1.0..=1e9, "from 1 to 1000000000")?;
        check.within("error_every", self.error_every, 1.0..=1e9, "from 1 to 1000000000")?;
        check.within("map_every", self.map_every, 1.0..=1e9, "from 1 to 1000000000")?;
        if let Some(beams) = self.beams {
            check.within("beams", beams as f64, 2.0..=1e4, "from 2 to 10000")?;
        }
        for (key, reward) in [
            ("update_reward", self.update_reward),
            ("error_reward", self.error_reward),
            ("collision_reward", self.collision_reward),
        ] {
            check.within(key, reward, -1e6..=1e6, "from -1000000 to 1000000")?;
        }
        Ok(())
    }
}

/// The worlds of exploring tasks; every episode is in one of them.
pub struct ExplorePlace {
    pub(crate) settings: ExploreSettings,
    pub(crate) worlds: Vec<One>,
    pub(crate) patches: Patches,
    pub(crate) beams: usize,
}

/// A world at its start, and the settings of its robot.
pub(crate) struct One {
    pub(crate) world: PhysicsWorld,
    settings: Settings,
    pub(crate) range_max_m: f64,
    /// The number of cells in the width of the robot.
    pub(crate) cells_wide: f64,
}

impl ExplorePlace {
    /// The place for some worlds. Their contacts are those of [`ContactModel::Sliding`], whatever their specs say: a trial in
    /// the same world has other last bits.
    ///
    /// # Errors
    ///
    /// When there is no world, the lasers of the worlds differ in their beams, the robot of a world has no
    /// differential drive, or a setting is out of range.
    pub fn new(worlds: &[WorldSpec], settings: ExploreSettings) -> Result<Self, TaskError> {
        settings.check()?;
        let worlds = worlds.iter().map(|spec| One::new(spec, &settings)).collect::<Result<Vec<_>, _>>()?;
        let expected = worlds.first().ok_or(TaskError::NoWorld)?.beams();
        if let Some(other) = worlds.iter().find(|one| one.beams() != expected) {
            let (world, found) = (other.world.spec().name.clone(), other.beams());
            return Err(TaskError::OtherExplorer { world, found, expected });
        }
        let patches = Patches::covering(worlds.iter().map(|one| &one.world.spec().frame));
        Ok(Self { settings, worlds, patches, beams: expected })
    }
}

impl One {
    fn new(spec: &WorldSpec, settings: &ExploreSettings) -> Result<Self, TaskError> {
        let mut fleet = FleetSpec { contacts: ContactModel::Sliding, ..spec.fleet().clone() };
        let driven = spec.driven_index();
        let laser = &mut fleet.robots[driven].laser;
        laser.beams = settings.beams.unwrap_or(laser.beams);
        let spec = WorldSpec::driving(fleet, driven).unwrap_or_else(|| spec.clone());
        let settings = Settings { pose: PoseMode::Exact, ..physics_trial::settings(&spec)? };
        let robot = spec.driven();
        let cells_wide = (2.0 * robot.radius_m / spec.frame.resolution_m()).max(1.0);
        let (range_max_m, mut world) = (robot.laser.range_max_m, PhysicsWorld::new(&spec, 0));
        world.correct_odometry();
        let one = Self { world, settings, range_max_m, cells_wide };
        // Errors of the settings and of the size of the map are found here, and not in an episode.
        one.robot()?;
        Ok(one)
    }

    /// The robot at its start.
    pub(crate) fn robot(&self) -> Result<Robot<LaserReading, NoPilot>, SettingsError> {
        self.settings.robot(self.world.spec().frame, None, Isometry2::identity(), NoPilot)
    }

    fn beams(&self) -> usize {
        self.world.spec().driven().laser.beams
    }
}
