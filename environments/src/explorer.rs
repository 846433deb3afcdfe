//! The robot of an exploring task in one of its worlds: what `Explore` and `ExploreGoals` share.

use crate::explore_place::{ExplorePlace, One, Reward, Start};
use crate::picture::{Picture, size_m};
use crate::task::TaskError;
use agent::Features;
use evaluation::metrics::{MAX_LOG_ERROR, mean_log_error};
use interfaces::{
    CellState, LaserReading, Purpose, RandomStream, SparseCells, Twist, World, from_bytes, heading_rad,
    to_bytes,
};
use mapper::Mapper;
use nalgebra::Point2;
use robot::{NoPilot, Robot};
use sim::physics::{PhysicsWorld, SnapshotError};
use std::sync::Arc;

/// The names of [`Explorer::info`].
pub(crate) const INFO: &[&str] =
    &["world", "map_updates", "log_error", "collisions", "found_changes", "seen_m2", "time"];

/// A change is found by a move if the cell was last seen from a place at least this far away, m: not what a door hides and
/// shows again.
pub(crate) const MOVE_M: f64 = 2.0;
/// The number of readings from one note of when each cell was seen to the next: 5 s, less than the gaps of found changes.
const NOTE_EVERY: usize = 50;

/// A robot that maps a world, and what it has earned.
pub(crate) struct Explorer {
    pub(crate) place: Arc<ExplorePlace>,
    number: usize,
    pub(crate) one: Arc<One>,
    pub(crate) world: PhysicsWorld,
    /// The robot without a pilot: the commands come from outside.
    pub(crate) robot: Robot<LaserReading, NoPilot>,
    pub(crate) reading: LaserReading,
    pub(crate) features: Features,
    pub(crate) episode: Episode,
    /// Per cell the changes that were found after a gap in its view.
    found: SparseCells<u32>,
    /// Per cell the number of the reading that had last seen it, at the last note.
    seen_at: SparseCells<u32>,
    /// The position at every reading, m.
    path: Vec<[f64; 2]>,
}

/// The present episode, for snapshots.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct Episode {
    /// The number of readings after the first one.
    pub(crate) steps: u32,
    log_error: f64,
    map_updates: u64,
    collisions: u32,
    found: u64,
    /// The known cells.
    known: i64,
    /// The map updates, found changes and new known cells of the last reading.
    last: [i64; 3],
}

impl Explorer {
    /// The robot in a place. It must be reset before the first step.
    pub(crate) fn new(place: &Arc<ExplorePlace>) -> Result<Self, TaskError> {
        let one = place.one(0)?;
        let mut world = one.world.clone();
        let (robot, reading, episode) = (one.robot()?, world.sense(), Episode::default());
        let (found, seen_at, path) = (none(&robot.mapper), none(&robot.mapper), Vec::new());
        let (place, features) = (Arc::clone(place), Features::default());
        Ok(Self { place, number: 0, one, world, robot, reading, features, episode, found, seen_at, path })
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

    /// Begins an episode.
    pub(crate) fn reset(&mut self, seed: u64) {
        let mut random = RandomStream::new(seed, Purpose::Task);
        let worlds = self.place.count();
        self.take((random.uniform(0.0..worlds as f64) as usize).min(worlds - 1));
        self.world.reset(seed);
        if let (Start::Anywhere, Some(free)) = (self.place.settings.starts, &self.one.free) {
            self.world.start_in(free, &mut random);
        }
        self.sense();
        self.episode.log_error = self.log_error();
    }

    /// Executes a command until the next reading. Returns the reward.
    pub(crate) fn advance(&mut self, command: &Twist) -> f64 {
        self.world.act(command);
        let hits = self.world.contacts().iter().filter(|contact| contact.moving).count() as u32;
        self.sense();
        self.episode.steps += 1;
        self.episode.collisions += hits;
        let settings = &self.place.settings;
        let [updates, found, seen] = self.episode.last.map(|count| count as f64);
        let changes = if settings.reward == Reward::Updates { updates } else { found };
        let mut reward = settings.update_reward * changes / self.one.cells_wide
            + settings.collision_reward * f64::from(hits);
        if settings.reward == Reward::Found {
            reward += settings.seen_reward * seen * self.cell_m2();
        }
        if self.is_over() || self.episode.steps.is_multiple_of(settings.error_every) {
            let log_error = self.log_error();
            if self.place.settings.reward == Reward::Updates {
                reward += self.place.settings.error_reward * (self.episode.log_error - log_error);
            }
            self.episode.log_error = log_error;
        }
        reward
    }

    /// Whether the episode is over.
    pub(crate) fn is_over(&self) -> bool {
        self.episode.steps >= self.place.settings.max_steps
    }

    /// Senses: one turn of the robot.
    fn sense(&mut self) {
        match self.robot.step(self.world.sense()) {
            Ok(turn) => (self.reading, self.features) = (turn.reading, turn.features),
            Err(why) => debug_assert!(false, "a simulated reading is valid: {why}"),
        }
        let at = self.reading.pose.translation.vector;
        self.path.push(at.into());
        let mapper = &self.robot.mapper;
        let (mut updates, mut found, mut seen) = (0, 0, 0);
        for transition in mapper.transitions() {
            let is_known = |state| i64::from(state != CellState::Unknown);
            seen += is_known(transition.after) - is_known(transition.before);
            if transition.event().is_none() {
                continue;
            }
            updates += 1;
            let Some(index) = mapper.frame().index(transition.cell) else { continue };
            let after_gaps = found_changes(mapper, index);
            if after_gaps > self.found[index] {
                let from = self.path[self.seen_at[index] as usize];
                found += i64::from((at.x - from[0]).hypot(at.y - from[1]) >= MOVE_M);
            }
            self.found.set(index, after_gaps);
        }
        let number = self.path.len() - 1;
        if number.is_multiple_of(NOTE_EVERY) {
            for index in mapper.seen() {
                let ago = mapper.recency(index) * self.one.rate_hz;
                self.seen_at.set(index, number.saturating_sub(ago.round() as usize) as u32);
            }
        }
        self.episode.last = [updates, found, seen];
        self.episode.map_updates += updates as u64;
        self.episode.found += found as u64;
        self.episode.known += seen;
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

    /// Position (shares of the size of the world), cosine and sine of the heading, velocities (shares of the maximum).
    pub(crate) fn state(&self) -> [f64; 6] {
        let (spec, pose) = (self.world.spec(), &self.reading.pose);
        let (drive, (width_m, height_m)) = (&spec.driven().drive, size_m(&spec.frame));
        let at = pose.translation.vector - spec.frame.origin().coords;
        let (sin, cos) = libm::sincos(heading_rad(pose));
        [
            at.x / width_m,
            at.y / height_m,
            cos,
            sin,
            self.reading.twist.linear_mps / drive.max_linear_mps,
            self.reading.twist.angular_radps / drive.max_angular_radps,
        ]
    }

    /// Writes the local map, the last part of an observation; nothing if it is not shown.
    pub(crate) fn write_local_map(&self, layers: &mut [f32]) {
        if let Some(local) = self.place.local_map() {
            local.write(&self.robot.mapper, &self.reading.pose, layers);
        }
    }

    /// From where the robot last saw a cell, m.
    pub(crate) fn seen_from(&self, index: usize) -> Point2<f64> {
        self.path[self.seen_at[index] as usize].into()
    }

    /// The area that is known, m².
    pub(crate) fn seen_m2(&self) -> f64 {
        self.episode.known as f64 * self.cell_m2()
    }

    /// The values of [`INFO`].
    pub(crate) fn info(&self, info: &mut [f32]) {
        let Episode { log_error, map_updates, collisions, found, .. } = self.episode;
        let values = [
            self.number as f32,
            map_updates as f32,
            log_error as f32,
            collisions as f32,
            found as f32,
            self.seen_m2() as f32,
            self.world.time_s() as f32,
        ];
        info.copy_from_slice(&values);
    }

    /// The map as the robot knows it: free, blocked and changing cells, and the robots.
    pub(crate) fn picture(&self, size: usize) -> Picture {
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

    /// The state as bytes.
    pub(crate) fn snapshot(&mut self) -> Vec<u8> {
        let filter = self.robot.filter_mut().map(|filter| interfaces::snapshot(filter.values()));
        let learned = (
            self.robot.mapper.snapshot(),
            self.robot.localization_mut().snapshot(),
            filter.unwrap_or_default(),
        );
        let world = self.world.snapshot().into_bytes();
        let views = (self.seen_at.to_vec(), &self.path);
        to_bytes(&(self.number, world, learned, &self.reading, self.features, self.episode, views))
    }

    /// Returns to the state of a snapshot.
    pub(crate) fn restore(&mut self, snapshot: &[u8]) -> Result<(), SnapshotError> {
        type Learned = (Vec<u8>, Vec<u8>, Vec<u8>);
        type Views = (Vec<u32>, Vec<[f64; 2]>);
        type Saved = (usize, Vec<u8>, Learned, LaserReading, Features, Episode, Views);
        let saved: Saved = from_bytes(snapshot).map_err(|_| SnapshotError::Damaged)?;
        let (number, world, (mapper, poses, filter), reading, features, episode, (seen_at, path)) = saved;
        if number >= self.place.count() {
            return Err(SnapshotError::OtherSpec);
        }
        self.take(number);
        if seen_at.len() != self.seen_at.len()
            || seen_at.iter().any(|&reading| reading as usize >= path.len())
        {
            return Err(SnapshotError::Damaged);
        }
        self.path = path;
        seen_at.into_iter().enumerate().for_each(|(index, reading)| self.seen_at.set(index, reading));
        self.world.restore(&world)?;
        self.robot.mapper.restore(&mapper).map_err(|_| SnapshotError::Damaged)?;
        self.robot.localization_mut().restore(&poses).map_err(|_| SnapshotError::Damaged)?;
        if let Some(own) = self.robot.filter_mut() {
            interfaces::restore(own.values(), &filter).map_err(|_| SnapshotError::Damaged)?;
        }
        (self.reading, self.features, self.episode) = (reading, features, episode);
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
