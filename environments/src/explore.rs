//! Exploring a place that changes.

use crate::explore_place::{ExplorePlace, LAYERS, One, Patches};
use crate::task::{Part, Results, Task, TaskError, present_scene, twist, write_scan, write_state};
use draw::canvas::{Canvas, PictureError};
use draw::pictures::bare;
use draw::scene::{Scene, extent};
use evaluation::metrics::{MAX_LOG_ERROR, mean_log_error};
use interfaces::{
    CellState, LaserReading, Purpose, RandomStream, SparseCells, Twist, World, from_bytes, heading_rad,
    to_bytes,
};
use mapper::Mapper;
use robot::state::{Sessions, State, learned, restore};
use robot::{NoPilot, Robot};
use sim::physics::{PhysicsWorld, SnapshotError};
use std::sync::Arc;

/// The numbers of an observation beside scan and map.
const STATE: usize = 6;
/// A change is found by a move if the cell was last seen from a place at least this far away, m: not what a door hides and
/// shows again.
const MOVE_M: f64 = 2.0;
/// The number of readings from one note of when each cell was seen to the next: 5 s, less than the gaps of found changes.
const NOTE_EVERY: usize = 50;
/// The number of readings from one refresh of the map in the observation to the next.
const MAP_EVERY: u32 = 10;
/// The number of readings from one measurement of the log error to the next.
const ERROR_EVERY: u32 = 50;

/// A robot with exact poses maps a place in which things move.
///
/// The observation has three parts. `scan`: from 0 to 1, share of the maximum range; 1 without a return, 0 where
/// invalid. `state`: position (shares of the size of the world), cosine and sine of the heading, linear and angular
/// velocity (shares of the maximum). `map`: four layers of patches of 0.5 m, row 0 at the lowest y: share that was
/// seen, share that is blocked, how long ago it was seen, mean probability of a change since then; from 0 to 1. The
/// map is refreshed at every tenth reading.
///
/// The two actions are the wanted linear and angular velocity, as shares of the maximum. One step is one scan of the
/// laser of the world. An episode begins anywhere in the free space that the robot can reach.
///
/// The reward is for what the map did not have and a move of the robot has shown: the changes that are found in cells that
/// were out of view for eight seconds or more and were last seen from a place at least two meters away, and the area that
/// becomes known. A robot that stands still earns next to nothing.
pub struct Explore {
    place: Arc<ExplorePlace>,
    /// The index of the world, and the world at its start.
    number: usize,
    one: Arc<One>,
    world: PhysicsWorld,
    /// The robot without a pilot: the commands come from outside.
    robot: Robot<LaserReading, NoPilot>,
    reading: LaserReading,
    episode: Episode,
    /// The map of the observation.
    layers: Vec<f32>,
    /// Per cell the changes that were found after a gap in its view.
    found: SparseCells<u32>,
    /// Per cell the number of the reading that had last seen it, at the last note.
    seen_at: SparseCells<u32>,
    /// The position at every reading, m.
    path: Vec<[f64; 2]>,
}

/// The present episode, for snapshots.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
struct Episode {
    /// The number of readings after the first one.
    steps: u32,
    log_error: f64,
    map_updates: u64,
    collisions: u32,
    found: u64,
    /// The known cells.
    known: i64,
}

impl Explore {
    /// The task in a place. It must be reset before the first step.
    ///
    /// # Errors
    ///
    /// When the mapper refuses its settings.
    pub fn new(place: &Arc<ExplorePlace>) -> Result<Self, TaskError> {
        let one = place.one(0)?;
        let mut world = one.world.clone();
        let (robot, reading, place) = (one.robot()?, world.sense(), Arc::clone(place));
        let (found, seen_at, path) = (none(&robot.mapper), none(&robot.mapper), Vec::new());
        let (layers, episode) = (vec![0.0; place.patches.len()], Episode::default());
        Ok(Self { place, number: 0, one, world, robot, reading, episode, layers, found, seen_at, path })
    }

    /// Takes the world with an index, at its start, and an empty map.
    fn take(&mut self, number: usize) {
        if number != self.number {
            match self.place.one(number) {
                Ok(one) => (self.world, self.one, self.number) = (one.world.clone(), one, number),
                Err(why) => debug_assert!(false, "all generated houses are valid: {why}"),
            }
        }
        // It was made with these settings once before.
        if let Ok(robot) = self.one.robot() {
            self.robot = robot;
        }
        self.episode = Episode::default();
        self.path.clear();
        self.seen_at = none(&self.robot.mapper);
        self.count_found();
    }

    /// Executes a command until the next reading. Returns the reward.
    fn advance(&mut self, command: &Twist) -> f64 {
        self.world.act(command);
        let hits = self.world.contacts().iter().filter(|contact| contact.moving).count() as u32;
        let before = self.episode;
        self.sense();
        self.episode.steps += 1;
        self.episode.collisions += hits;
        let (settings, after) = (&self.place.settings, self.episode);
        let spec = self.world.spec();
        let cells_wide = (2.0 * spec.driven().radius_m / spec.frame.resolution_m()).max(1.0);
        let reward = settings.update_reward * (after.found - before.found) as f64 / cells_wide
            + settings.collision_reward * f64::from(hits)
            + settings.seen_reward * (after.known - before.known) as f64 * self.cell_m2();
        if self.is_over() || after.steps.is_multiple_of(ERROR_EVERY) {
            self.episode.log_error = self.log_error();
        }
        reward
    }

    fn is_over(&self) -> bool {
        self.episode.steps >= self.place.settings.max_steps
    }

    /// Senses: one turn of the robot.
    fn sense(&mut self) {
        match self.robot.step(self.world.sense()) {
            Ok(turn) => self.reading = turn.reading,
            Err(why) => debug_assert!(false, "a simulated reading is valid: {why}"),
        }
        let at = self.reading.pose.translation.vector;
        self.path.push(at.into());
        let mapper = &self.robot.mapper;
        for transition in mapper.transitions() {
            let is_known = |state| i64::from(state != CellState::Unknown);
            self.episode.known += is_known(transition.after) - is_known(transition.before);
            if transition.event().is_none() {
                continue;
            }
            self.episode.map_updates += 1;
            let Some(index) = mapper.frame().index(transition.cell) else { continue };
            let after_gaps = found_changes(mapper, index);
            if after_gaps > self.found[index] {
                let from = self.path[self.seen_at[index] as usize];
                self.episode.found += u64::from((at.x - from[0]).hypot(at.y - from[1]) >= MOVE_M);
            }
            self.found.set(index, after_gaps);
        }
        let number = self.path.len() - 1;
        if number.is_multiple_of(NOTE_EVERY) {
            for index in mapper.seen() {
                let ago = mapper.recency(index) * self.world.spec().driven().laser.rate_hz;
                self.seen_at.set(index, number.saturating_sub(ago.round() as usize) as u32);
            }
        }
    }

    /// Counts the found changes of all cells anew.
    fn count_found(&mut self) {
        let mapper = &self.robot.mapper;
        self.found = none(mapper);
        for index in mapper.changed() {
            self.found.set(index, found_changes(mapper, index));
        }
    }

    fn log_error(&self) -> f64 {
        mean_log_error(&self.robot.mapper, self.world.truth()).unwrap_or(MAX_LOG_ERROR)
    }

    fn cell_m2(&self) -> f64 {
        self.robot.mapper.frame().resolution_m().powi(2)
    }

    fn write_map(&mut self) {
        self.place.patches.write(&self.robot.mapper, &mut self.layers);
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
        let state = vec![("position", 2), ("heading", 2), ("velocity", 2)];
        vec![
            Part { name: "scan", shape: vec![self.place.beams], slices: Vec::new() },
            Part { name: "state", shape: vec![STATE], slices: state },
            Part { name: "map", shape: vec![LAYERS.len(), rows, columns], slices: LAYERS.to_vec() },
        ]
    }

    fn info_names(&self) -> &'static [&'static str] {
        &["world", "map_updates", "log_error", "collisions", "found_changes", "seen_m2", "time"]
    }

    fn reset(&mut self, seed: u64) {
        let mut random = RandomStream::new(seed, Purpose::Task);
        let worlds = self.place.count();
        self.take((random.uniform(0.0..worlds as f64) as usize).min(worlds - 1));
        self.world.reset(seed);
        if let Some(free) = &self.one.free {
            self.world.start_in(free, &mut random);
        }
        self.sense();
        self.episode.log_error = self.log_error();
        self.write_map();
    }

    fn step(&mut self, actions: &[f32], results: &mut Results) {
        let twist = twist(&self.world.spec().driven().drive, actions);
        let reward = if self.is_over() { 0.0 } else { self.advance(&twist) };
        let is_over = self.is_over();
        if is_over || self.episode.steps.is_multiple_of(MAP_EVERY) {
            self.write_map();
        }
        let Results { rewards, terminated, truncated, .. } = results;
        (rewards[0], terminated[0], truncated[0]) = (reward as f32, false, is_over);
    }

    fn observe(&mut self, observations: &mut [f32]) {
        let (scan, rest) = observations.split_at_mut(self.place.beams);
        let (state, map) = rest.split_at_mut(STATE);
        let (spec, pose) = (self.world.spec(), &self.reading.pose);
        write_scan(scan, &self.reading.scan.ranges_m, spec.driven().laser.range_max_m);
        let (drive, (origin, size_m)) = (&spec.driven().drive, extent(&spec.frame));
        let at = pose.translation.vector - origin.coords;
        let (sin, cos) = libm::sincos(heading_rad(pose));
        let (linear, angular) = (self.reading.twist.linear_mps, self.reading.twist.angular_radps);
        let velocity = [linear / drive.max_linear_mps, angular / drive.max_angular_radps];
        write_state(state, [at.x / size_m.x, at.y / size_m.y, cos, sin, velocity[0], velocity[1]]);
        map.copy_from_slice(&self.layers);
    }

    fn info(&self, info: &mut [f32]) {
        let Episode { log_error, map_updates, collisions, found, known, .. } = self.episode;
        let values = [
            self.number as f32,
            map_updates as f32,
            log_error as f32,
            collisions as f32,
            found as f32,
            (known as f64 * self.cell_m2()) as f32,
            self.world.time_s() as f32,
        ];
        info.copy_from_slice(&values);
    }

    /// The map as the robot knows it, with the cycle times of cells that change, and the robots.
    fn picture(&self, size: u32) -> Result<Canvas, PictureError> {
        let scene = present_scene(self.world.fleet());
        let scene = Scene { walls: Vec::new(), obstacles: Vec::new(), ..scene };
        bare(&scene, Some(&self.robot.mapper), &[], size)
    }

    fn snapshot(&mut self) -> Vec<u8> {
        let learned = learned(&mut self.robot, &self.one.settings, &Sessions::of("explore"))();
        let world = self.world.snapshot().into_bytes();
        let views = (self.seen_at.to_vec(), &self.path, &self.layers);
        to_bytes(&(self.number, world, learned, &self.reading, self.episode, views))
    }

    fn restore(&mut self, snapshot: &[u8]) -> Result<(), SnapshotError> {
        type Views = (Vec<u32>, Vec<[f64; 2]>, Vec<f32>);
        type Saved = (usize, Vec<u8>, State, LaserReading, Episode, Views);
        let saved: Saved = from_bytes(snapshot).map_err(|_| SnapshotError::Damaged)?;
        let (number, world, learned, reading, episode, (seen_at, path, layers)) = saved;
        if number >= self.place.count() || layers.len() != self.layers.len() {
            return Err(SnapshotError::OtherSpec);
        }
        self.take(number);
        if seen_at.len() != self.seen_at.len()
            || seen_at.iter().any(|&reading| reading as usize >= path.len())
        {
            return Err(SnapshotError::Damaged);
        }
        (self.path, self.layers) = (path, layers);
        seen_at.into_iter().enumerate().for_each(|(index, reading)| self.seen_at.set(index, reading));
        self.world.restore(&world)?;
        restore(&learned, &mut self.robot, &self.one.settings).map_err(|_| SnapshotError::Damaged)?;
        (self.reading, self.episode) = (reading, episode);
        self.count_found();
        Ok(())
    }
}

/// A number per cell that is 0 for most of them.
fn none(mapper: &Mapper) -> SparseCells<u32> {
    SparseCells::in_blocks(mapper.frame().width(), mapper.frame().height(), 0)
}

/// The changes of a cell that were found at the end of a gap in its view: the mapper counts a cell that was hidden for less
/// than eight seconds as watched.
fn found_changes(mapper: &Mapper, index: usize) -> u32 {
    let seen = mapper.statistics(index);
    seen.block_events_after_gap + seen.free_events_after_gap
}
