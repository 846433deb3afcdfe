//! Exploring a place that changes.

use crate::explore_place::ExplorePlace;
use crate::explorer::{Explorer, INFO};
use crate::patches::{LAYERS, Patches};
use crate::picture::Picture;
use crate::task::{Part, Results, Task, TaskError, twist, write_scan, write_state};
use interfaces::{from_bytes, to_bytes};
use sim::physics::{Fleet, SnapshotError};
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
/// The reward is in [`ExploreSettings::reward`](crate::ExploreSettings::reward).
pub struct Explore {
    explorer: Explorer,
    /// The map of the observation.
    layers: Vec<f32>,
}

impl Explore {
    /// The task in a place. It must be reset before the first step.
    ///
    /// # Errors
    ///
    /// When the mapper refuses its settings.
    pub fn new(place: &Arc<ExplorePlace>) -> Result<Self, TaskError> {
        Ok(Self { explorer: Explorer::new(place)?, layers: vec![0.0; place.patches.len()] })
    }

    fn write_map(&mut self) {
        self.explorer.place.patches.write(&self.explorer.robot.mapper, &mut self.layers);
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
        let place = &self.explorer.place;
        let Patches { rows, columns } = place.patches;
        let state = vec![("position", 2), ("heading", 2), ("velocity", 2)];
        vec![
            Part::new("scan", vec![place.beams]),
            Part { slices: state, ..Part::new("state", vec![STATE]) },
            Part::new("map", vec![LAYERS, rows, columns]),
        ]
    }

    fn info_names(&self) -> &'static [&'static str] {
        INFO
    }

    fn reset(&mut self, seed: u64) {
        self.explorer.reset(seed);
        self.write_map();
    }

    fn step(&mut self, actions: &[f32], results: &mut Results) {
        let twist = twist(&self.explorer.world.spec().driven().drive, actions);
        let reward = self.explorer.advance(&twist);
        let is_over = self.explorer.is_over();
        let map_every = self.explorer.place.settings.map_every;
        if is_over || self.explorer.episode.steps.is_multiple_of(map_every) {
            self.write_map();
        }
        let Results { rewards, terminated, truncated, .. } = results;
        (rewards[0], terminated[0], truncated[0]) = (reward as f32, false, is_over);
    }

    fn observe(&mut self, observations: &mut [f32]) {
        let Self { explorer, layers } = self;
        let (scan, rest) = observations.split_at_mut(explorer.place.beams);
        let (state, map) = rest.split_at_mut(STATE);
        write_scan(scan, &explorer.reading.scan.ranges_m, explorer.one.range_max_m);
        write_state(state, explorer.state());
        map.copy_from_slice(layers);
    }

    fn info(&self, info: &mut [f32]) {
        self.explorer.info(info);
    }

    fn fleet(&self) -> &Fleet {
        self.explorer.world.fleet()
    }

    fn picture(&self, size: usize) -> Picture {
        self.explorer.picture(size)
    }

    fn snapshot(&mut self) -> Vec<u8> {
        to_bytes(&(self.explorer.snapshot(), &self.layers))
    }

    fn restore(&mut self, snapshot: &[u8]) -> Result<(), SnapshotError> {
        let (explorer, layers): (Vec<u8>, Vec<f32>) =
            from_bytes(snapshot).map_err(|_| SnapshotError::Damaged)?;
        if layers.len() != self.layers.len() {
            return Err(SnapshotError::OtherSpec);
        }
        self.explorer.restore(&explorer)?;
        self.layers = layers;
        Ok(())
    }
}
