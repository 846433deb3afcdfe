//! Exploring a place that changes.

use crate::explore_place::ExplorePlace;
use crate::patches::{LAYERS, Patches};
use crate::picture::Picture;
use crate::picture::size_m;
use crate::task::{Part, Results, Task, TaskError, twist, write_scan, write_state};
use evaluation::metrics::{MAX_LOG_ERROR, mean_log_error};
use interfaces::{CellState, LaserReading, Purpose, RandomStream, World, from_bytes, heading_rad, to_bytes};
use robot::{NoPilot, Robot};
use sim::physics::{Fleet, PhysicsWorld, SnapshotError};
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
    /// The robot without a pilot: the commands are the actions.
    robot: Robot<LaserReading, NoPilot>,
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
        let (robot, reading, episode) = (one.robot()?, world.sense(), Episode::default());
        let layers = vec![0.0; place.patches.len()];
        Ok(Self { place: Arc::clone(place), number: 0, world, robot, reading, episode, layers })
    }

    /// Senses: one turn of the robot.
    fn sense(&mut self) {
        match self.robot.step(self.world.sense()) {
            Ok(turn) => self.reading = turn.reading,
            Err(why) => debug_assert!(false, "a simulated reading is valid: {why}"),
        }
        let updates =
            self.robot.mapper.transitions().iter().filter(|transition| transition.event().is_some());
        self.episode.last_updates = updates.count() as u32;
        self.episode.map_updates += u64::from(self.episode.last_updates);
    }

    fn log_error(&self) -> f64 {
        mean_log_error(&self.robot.mapper, self.world.truth()).unwrap_or(MAX_LOG_ERROR)
    }

    /// Takes the world with an index, at its start, and an empty map.
    fn take(&mut self, number: usize) {
        let one = &self.place.worlds[number];
        if number != self.number {
            self.world = one.world.clone();
            self.number = number;
        }
        // It was made with these settings once before.
        if let Ok(robot) = one.robot() {
            self.robot = robot;
        }
        self.episode = Episode::default();
    }
}

impl Task for Explore {
    fn agents(&self) -> usize {
        1
    }

    fn kind(&self) -> &'static str {
        "exploring environment"
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
        self.place.patches.write(&self.robot.mapper, &mut self.layers);
    }

    fn step(&mut self, actions: &[f32], results: &mut Results) {
        let place = Arc::clone(&self.place);
        let (settings, one) = (&place.settings, &place.worlds[self.number]);
        let twist = twist(&self.world.spec().driven().drive, actions);
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
            place.patches.write(&self.robot.mapper, &mut self.layers);
        }
        let Results { rewards, terminated, truncated, .. } = results;
        (rewards[0], terminated[0], truncated[0]) = (reward as f32, false, is_over);
    }

    fn observe(&mut self, observations: &mut [f32]) {
        let place = &*self.place;
        let (scan, rest) = observations.split_at_mut(place.beams);
        let (state, map) = rest.split_at_mut(STATE);
        write_scan(scan, &self.reading.scan.ranges_m, place.worlds[self.number].range_max_m);
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
        write_state(state, values);
        map.copy_from_slice(&self.layers);
    }

    fn info(&self, info: &mut [f32]) {
        let Episode { log_error, map_updates, collisions, .. } = self.episode;
        let values = [self.number as f32, map_updates as f32, log_error as f32, collisions as f32];
        info.copy_from_slice(&values);
    }

    fn fleet(&self) -> &Fleet {
        self.world.fleet()
    }

    /// The map as the robot knows it: free, blocked and changing cells, and the robots.
    fn picture(&self, size: usize) -> Picture {
        let mut picture = Picture::floor(&self.world.spec().frame, size);
        picture.cells(self.robot.mapper.frame(), |index| match self.robot.mapper.states().cells()[index] {
            CellState::Unknown => Some([160, 160, 165]),
            CellState::Blocked => Some([70, 70, 75]),
            CellState::Free if self.robot.mapper.acting_rate(index) > 0.0 => Some([245, 180, 90]),
            CellState::Free => None,
        });
        picture.robots(self.world.fleet(), &[self.world.spec().driven_index()]);
        picture
    }

    fn snapshot(&mut self) -> Vec<u8> {
        let learned = (self.robot.mapper.snapshot(), self.robot.localization_mut().snapshot());
        let world = self.world.snapshot().into_bytes();
        to_bytes(&(self.number, world, learned, &self.reading, self.episode, &self.layers))
    }

    fn restore(&mut self, snapshot: &[u8]) -> Result<(), SnapshotError> {
        type Learned = (Vec<u8>, Vec<u8>);
        type Saved = (usize, Vec<u8>, Learned, LaserReading, Episode, Vec<f32>);
        let saved: Saved = from_bytes(snapshot).map_err(|_| SnapshotError::Damaged)?;
        let (number, world, (mapper, poses), reading, episode, layers) = saved;
        if number >= self.place.worlds.len() || layers.len() != self.layers.len() {
            return Err(SnapshotError::OtherSpec);
        }
        self.take(number);
        self.world.restore(&world)?;
        self.robot.mapper.restore(&mapper).map_err(|_| SnapshotError::Damaged)?;
        self.robot.localization_mut().restore(&poses).map_err(|_| SnapshotError::Damaged)?;
        (self.reading, self.episode, self.layers) = (reading, episode, layers);
        Ok(())
    }
}
