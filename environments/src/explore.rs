//! Exploring a place that changes.

use crate::explore_place::ExplorePlace;
use crate::patches::{LAYERS, Patches};
use crate::picture::Picture;
use crate::place::size_m;
use crate::task::{Outcome, Part, Task, TaskError};
use evaluation::metrics::{MAX_LOG_ERROR, mean_log_error};
use interfaces::{CellState, LaserReading, Purpose, RandomStream, Twist, Values, World, heading_rad, value};
use localizer::GivenPoses;
use mapper::Mapper;
use sim::physics::{PhysicsWorld, SnapshotError};
use std::sync::Arc;

/// The numbers of an observation beside scan and map.
const STATE: usize = 6;

/// A robot with exact poses maps a place in which things move.
///
/// The observation has three parts. `scan`: from 0 to 1, share of the maximum range; 1 without a return, 0 where
/// invalid. `state`: position (shares of the size of the world), cosine and sine of the heading, linear and angular
/// velocity (shares of the maximum). `map`: four layers of patches of 0.5 m, row 0 at the lowest y: share that was
/// seen, share that is blocked, how long ago it was seen, mean probability of a change since then; from 0 to 1. The
/// map is refreshed at every tenth reading.
///
/// The two actions are the wanted linear and angular velocity, as shares of the maximum. One step is one scan of the
/// laser of the world.
///
/// The reward is what the paper's agent earns, the map updates of the reading, and the fall of the log error of the
/// rates.
pub struct Explore {
    place: Arc<ExplorePlace>,
    number: usize,
    world: PhysicsWorld,
    mapper: Mapper,
    poses: GivenPoses,
    reading: LaserReading,
    episode: Episode,
    /// The map of the observation.
    layers: Vec<f32>,
}

/// The present episode, for snapshots.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
struct Episode {
    steps: u32,
    log_error: f64,
    map_updates: u64,
    collisions: u32,
    /// The map updates of the last reading.
    last_updates: u32,
}

impl Explore {
    /// The task in a place. It must be reset before the first step.
    ///
    /// # Errors
    ///
    /// When the mapper refuses its settings.
    pub fn new(place: &Arc<ExplorePlace>) -> Result<Self, TaskError> {
        let one = &place.worlds[0];
        let mut world = one.world.clone();
        let mapper = Mapper::new(&one.mapper, world.spec().frame)?;
        let reading = world.sense();
        let (poses, episode) = (GivenPoses::default(), Episode::default());
        let layers = vec![0.0; place.patches.len()];
        Ok(Self { place: Arc::clone(place), number: 0, world, mapper, poses, reading, episode, layers })
    }

    /// The simulated world.
    pub fn world(&self) -> &PhysicsWorld {
        &self.world
    }

    /// The map, and what was learned about it.
    pub fn mapper(&self) -> &Mapper {
        &self.mapper
    }

    /// The index of the world of the present episode.
    pub fn number(&self) -> usize {
        self.number
    }

    /// The map as the robot knows it, at most `size` pixels wide and high: free, blocked and changing cells, and the
    /// robots.
    pub fn picture(&self, size: usize) -> Picture {
        let mut picture = Picture::floor(&self.world.spec().frame, size);
        picture.cells(self.mapper.frame(), |index| match self.mapper.states().cells()[index] {
            CellState::Unknown => Some([160, 160, 165]),
            CellState::Blocked => Some([70, 70, 75]),
            CellState::Free if self.mapper.rate(index) > 0.0 => Some([245, 180, 90]),
            CellState::Free => None,
        });
        picture.robots(self.world.fleet(), &[self.world.spec().driven_index()]);
        picture
    }

    /// Senses, and updates the map.
    fn sense(&mut self) {
        self.reading = self.poses.deskewed(self.world.sense());
        let update = self.mapper.update(&self.reading);
        debug_assert!(update.is_ok(), "a simulated reading is valid: {update:?}");
        let updates = self.mapper.transitions().iter().filter(|transition| transition.event().is_some());
        self.episode.last_updates = updates.count() as u32;
        self.episode.map_updates += u64::from(self.episode.last_updates);
    }

    fn log_error(&self) -> f64 {
        mean_log_error(&self.mapper, self.world.truth()).unwrap_or(MAX_LOG_ERROR)
    }

    /// Takes the world with an index, at its start, and an empty map.
    fn take(&mut self, number: usize) {
        let one = &self.place.worlds[number];
        if number != self.number {
            self.world = one.world.clone();
            self.number = number;
        }
        // It was made with these settings once before.
        if let Ok(mapper) = Mapper::new(&one.mapper, self.world.spec().frame) {
            self.mapper = mapper;
        }
        (self.poses, self.episode) = (GivenPoses::default(), Episode::default());
    }
}

impl Task for Explore {
    fn agents(&self) -> usize {
        1
    }

    fn action_len(&self) -> usize {
        2
    }

    fn parts(&self) -> Vec<Part> {
        let Patches { rows, columns } = self.place.patches;
        vec![
            Part { name: "scan", shape: vec![self.place.beams] },
            Part { name: "state", shape: vec![STATE] },
            Part { name: "map", shape: vec![LAYERS, rows, columns] },
        ]
    }

    fn info_names(&self) -> &'static [&'static str] {
        &["world", "map_updates", "log_error", "collisions"]
    }

    fn reset(&mut self, seed: u64) {
        let mut random = RandomStream::new(seed, Purpose::Task);
        let worlds = self.place.worlds.len();
        self.take((random.uniform(0.0..worlds as f64) as usize).min(worlds - 1));
        self.world.reset(seed);
        self.sense();
        self.episode.log_error = self.log_error();
        self.place.patches.write(&self.mapper, &mut self.layers);
    }

    fn step(&mut self, actions: &[f32], outcome: Outcome<'_>) {
        let place = Arc::clone(&self.place);
        let (settings, one) = (&place.settings, &place.worlds[self.number]);
        let drive = &self.world.spec().driven().drive;
        let [linear, angular] = [0, 1].map(|index| f64::from(actions.get(index).copied().unwrap_or(0.0)));
        let twist = Twist {
            linear_mps: linear * drive.max_linear_mps,
            angular_radps: angular * drive.max_angular_radps,
        };
        self.world.act(&twist);
        let hits = self.world.contacts().iter().filter(|contact| contact.moving).count() as u32;
        self.sense();
        self.episode.steps += 1;
        self.episode.collisions += hits;
        let mut reward = settings.update_reward * f64::from(self.episode.last_updates) / one.cells_wide
            + settings.collision_reward * f64::from(hits);
        let is_over = self.episode.steps >= settings.max_steps;
        if is_over || self.episode.steps.is_multiple_of(settings.error_every) {
            let log_error = self.log_error();
            reward += settings.error_reward * (self.episode.log_error - log_error);
            self.episode.log_error = log_error;
        }
        if is_over || self.episode.steps.is_multiple_of(settings.map_every) {
            place.patches.write(&self.mapper, &mut self.layers);
        }
        let Outcome { rewards, terminated, truncated } = outcome;
        (rewards[0], terminated[0], truncated[0]) = (reward as f32, false, is_over);
    }

    fn observe(&mut self, observations: &mut [f32]) {
        let place = &*self.place;
        let (scan, rest) = observations.split_at_mut(place.beams);
        let (state, map) = rest.split_at_mut(STATE);
        let scale = 1.0 / place.worlds[self.number].range_max_m as f32;
        for (value, range_m) in scan.iter_mut().zip(&self.reading.scan.ranges_m) {
            *value = if range_m.is_nan() { 0.0 } else { (range_m * scale).clamp(0.0, 1.0) };
        }
        let (spec, pose) = (self.world.spec(), &self.reading.pose);
        let (drive, (width_m, height_m)) = (&spec.driven().drive, size_m(&spec.frame));
        let at = pose.translation.vector - spec.frame.origin().coords;
        let (sin, cos) = libm::sincos(heading_rad(pose));
        let values = [
            at.x / width_m,
            at.y / height_m,
            cos,
            sin,
            self.reading.twist.linear_mps / drive.max_linear_mps,
            self.reading.twist.angular_radps / drive.max_angular_radps,
        ];
        for (state, value) in state.iter_mut().zip(values) {
            *state = value.clamp(-1.0, 1.0) as f32;
        }
        map.copy_from_slice(&self.layers);
    }

    fn info(&self, info: &mut [f32]) {
        let Episode { log_error, map_updates, collisions, .. } = self.episode;
        let values = [self.number as f32, map_updates as f32, log_error as f32, collisions as f32];
        info.copy_from_slice(&values);
    }

    fn snapshot(&self) -> Vec<u8> {
        let mut parts = Parts {
            number: self.number,
            world: self.world.snapshot().into_bytes(),
            mapper: self.mapper.clone().snapshot(),
            poses: self.poses.clone().snapshot(),
            reading: self.reading.clone(),
            episode: self.episode,
            layers: self.layers.clone(),
        };
        interfaces::snapshot(parts.values())
    }

    fn restore(&mut self, snapshot: &[u8]) -> Result<(), SnapshotError> {
        let mut parts = Parts {
            number: 0,
            world: Vec::new(),
            mapper: Vec::new(),
            poses: Vec::new(),
            reading: self.reading.clone(),
            episode: Episode::default(),
            layers: Vec::new(),
        };
        interfaces::restore(parts.values(), snapshot).map_err(|_| SnapshotError::Damaged)?;
        if parts.number >= self.place.worlds.len() || parts.layers.len() != self.layers.len() {
            return Err(SnapshotError::OtherSpec);
        }
        self.take(parts.number);
        self.world.restore(&parts.world)?;
        self.mapper.restore(&parts.mapper).map_err(|_| SnapshotError::Damaged)?;
        self.poses.restore(&parts.poses).map_err(|_| SnapshotError::Damaged)?;
        (self.reading, self.episode, self.layers) = (parts.reading, parts.episode, parts.layers);
        Ok(())
    }
}

/// What a snapshot contains, in its order.
struct Parts {
    number: usize,
    world: Vec<u8>,
    mapper: Vec<u8>,
    poses: Vec<u8>,
    reading: LaserReading,
    episode: Episode,
    layers: Vec<f32>,
}

impl Parts {
    fn values(&mut self) -> Values<'_> {
        vec![
            value(&mut self.number),
            value(&mut self.world),
            value(&mut self.mapper),
            value(&mut self.poses),
            value(&mut self.reading),
            value(&mut self.episode),
            value(&mut self.layers),
        ]
    }
}
