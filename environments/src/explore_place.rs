//! The worlds of exploring tasks, built once and shared.

use crate::place::check_beams;
use crate::task::{TaskError, check_rewards};
use evaluation::physics_trial;
use interfaces::{Cell, CellState, GridFrame, LaserReading, PoseMode, SettingsCheck, SettingsError};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};
use robot::{NoPilot, Robot, Settings};
use sim::physics::building_ranges::HOUSE;
use sim::physics::{ContactModel, FleetSpec, FreePoses, PhysicsWorld, WorldSpec};
use std::sync::Arc;

/// Settings of [`Explore`](crate::Explore).
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ExploreSettings {
    /// The number of readings after which an episode is truncated.
    pub max_steps: u32,
    /// The number of beams of the laser; `None`: as in the world. Its other properties are those of the world.
    pub beams: Option<usize>,
    /// The reward per change that a move has shown, divided by the number of cells in the width of the robot.
    pub update_reward: f64,
    /// The reward per square meter that becomes known.
    pub seen_reward: f64,
    /// The reward (below 0) of a collision of the moving robot.
    pub collision_reward: f64,
}

impl Default for ExploreSettings {
    fn default() -> Self {
        Self {
            max_steps: 3000,
            beams: Some(180),
            update_reward: 1.0,
            seen_reward: 0.2,
            collision_reward: -0.5,
        }
    }
}

impl ExploreSettings {
    fn check(&self) -> Result<(), SettingsError> {
        let check = SettingsCheck { part: "exploring task" };
        check.within("max_steps", self.max_steps, 1.0..=1e9, "from 1 to 1000000000")?;
        if let Some(beams) = self.beams {
            check.within("beams", beams as f64, 2.0..=1e4, "from 2 to 10000")?;
        }
        let rewards = [
            ("update_reward", self.update_reward),
            ("seen_reward", self.seen_reward),
            ("collision_reward", self.collision_reward),
        ];
        check_rewards(&check, &rewards)
    }
}

/// The worlds of exploring tasks; every episode is in one of them.
pub struct ExplorePlace {
    pub(crate) settings: ExploreSettings,
    worlds: Worlds,
    pub(crate) patches: Patches,
    pub(crate) beams: usize,
}

/// Worlds that are kept, or seeds of houses that are built when an episode begins in them: a hundredth of a second.
enum Worlds {
    Kept(Vec<Arc<One>>),
    Houses(Vec<u64>),
}

/// A world at its start, and the settings of its robot.
pub(crate) struct One {
    pub(crate) world: PhysicsWorld,
    pub(crate) settings: Settings,
    /// Where an episode can begin.
    pub(crate) free: Option<FreePoses>,
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
        let expected = worlds.first().ok_or_else(no_world)?.beams();
        for One { world, .. } in &worlds {
            let of = format!("the robot in `{}`", world.spec().name);
            check_beams(&of, world.spec().driven().laser.beams, expected)?;
        }
        let patches = Patches::covering(worlds.iter().map(|one| &one.world.spec().frame));
        let worlds = Worlds::Kept(worlds.into_iter().map(Arc::new).collect());
        Ok(Self { settings, worlds, patches, beams: expected })
    }

    /// The place for generated houses, by their seeds. A house is built when an episode begins in it: any number of houses
    /// takes no memory. The map of the observation has the size of the largest house that can be generated.
    ///
    /// # Errors
    ///
    /// When there is no house, or a setting is out of range.
    pub fn of_houses(seeds: Vec<u64>, settings: ExploreSettings) -> Result<Self, TaskError> {
        settings.check()?;
        let first = seeds.first().ok_or_else(no_world)?;
        let first = One::new(&WorldSpec::generate_house(*first), &settings)?;
        let cell_m = first.world.spec().frame.resolution_m();
        let largest = GridFrame::covering(Point2::origin(), HOUSE.length_m[1], HOUSE.width_m[1], cell_m);
        let patches = Patches::covering(largest.iter());
        Ok(Self { settings, worlds: Worlds::Houses(seeds), patches, beams: first.beams() })
    }

    /// The number of worlds.
    pub(crate) fn count(&self) -> usize {
        match &self.worlds {
            Worlds::Kept(worlds) => worlds.len(),
            Worlds::Houses(seeds) => seeds.len(),
        }
    }

    /// The world with an index.
    pub(crate) fn one(&self, number: usize) -> Result<Arc<One>, TaskError> {
        match &self.worlds {
            Worlds::Kept(worlds) => Ok(Arc::clone(&worlds[number])),
            Worlds::Houses(seeds) => {
                One::new(&WorldSpec::generate_house(seeds[number]), &self.settings).map(Arc::new)
            }
        }
    }
}

impl One {
    fn new(spec: &WorldSpec, task: &ExploreSettings) -> Result<Self, TaskError> {
        let mut fleet = FleetSpec { contacts: ContactModel::Sliding, ..spec.fleet().clone() };
        let driven = spec.driven_index();
        let laser = &mut fleet.robots[driven].laser;
        laser.beams = task.beams.unwrap_or(laser.beams);
        let spec = WorldSpec::driving(fleet, driven).unwrap_or_else(|| spec.clone());
        let settings = Settings { pose: PoseMode::Exact, ..physics_trial::settings(&spec)? };
        let mut world = PhysicsWorld::new(&spec, 0);
        world.correct_odometry();
        let free = FreePoses::reachable(spec.fleet(), spec.driven_index());
        let one = Self { world, settings, free };
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

fn no_world() -> TaskError {
    TaskError::World("exploring needs at least one world".to_owned())
}

// The map at the resolution of patches: what a learner sees of it.

/// The side of a patch, m.
const PATCH_M: f64 = 0.5;
/// The cells that are read in a patch, along each side.
const SAMPLES: usize = 2;
/// The time after which the recency of a cell is 1 − 1/e, s.
const RECENCY_S: f64 = 60.0;

/// The layers of [`Patches::write`].
pub(crate) const LAYERS: [(&str, usize); 4] = [("seen", 1), ("blocked", 1), ("age", 1), ("changed", 1)];

/// A grid of patches that covers the largest of several maps.
#[derive(Clone, Debug)]
pub(crate) struct Patches {
    pub(crate) rows: usize,
    pub(crate) columns: usize,
}

impl Patches {
    pub(crate) fn covering<'a>(frames: impl Iterator<Item = &'a GridFrame>) -> Self {
        let count = |cells: usize, frame: &GridFrame| {
            (cells as f64 * frame.resolution_m() / PATCH_M - 1e-6).ceil() as usize
        };
        frames.fold(Self { rows: 1, columns: 1 }, |most, frame| Self {
            rows: most.rows.max(count(frame.height(), frame)),
            columns: most.columns.max(count(frame.width(), frame)),
        })
    }

    /// The number of values of all layers.
    pub(crate) fn len(&self) -> usize {
        LAYERS.len() * self.rows * self.columns
    }

    /// Writes four layers, row 0 at the lowest y, each with values from 0 to 1: the share of the patch that was seen,
    /// the share that is blocked, how long ago it was seen (1 − e^(−time / 60 s); 1 where it was never seen), and the
    /// mean probability that a cell changed since then. Four cells are read in each patch; beyond the map all is 0.
    pub(crate) fn write(&self, mapper: &Mapper, layers: &mut [f32]) {
        layers.fill(0.0);
        let (frame, size) = (mapper.frame(), self.rows * self.columns);
        let per_patch = PATCH_M / frame.resolution_m();
        let cell = |patch: usize, sample: usize| {
            ((patch as f64 + (sample as f64 + 0.5) / SAMPLES as f64) * per_patch) as i32
        };
        let weight = 1.0 / (SAMPLES * SAMPLES) as f32;
        for patch in 0..size {
            let (row, column) = (patch / self.columns, patch % self.columns);
            for sample in 0..SAMPLES * SAMPLES {
                let at = Cell::new(cell(column, sample % SAMPLES), cell(row, sample / SAMPLES));
                let Some(index) = frame.index(at) else { continue };
                if !mapper.was_ever_seen(index) {
                    layers[2 * size + patch] += weight;
                    continue;
                }
                let is_blocked = mapper.states().cells()[index] == CellState::Blocked;
                let age = 1.0 - libm::exp(-mapper.recency(index) / RECENCY_S);
                layers[patch] += weight;
                layers[size + patch] += weight * f32::from(u8::from(is_blocked));
                layers[2 * size + patch] += weight * age as f32;
                layers[3 * size + patch] += weight * mapper.change_probability(index) as f32;
            }
        }
    }
}
