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
/// map is refreshed at every tenth reading. With [`shows_local_map`](crate::ExploreSettings::shows_local_map), a fourth part
/// follows: `local_map`, the map around the robot in its own frame, refreshed at every reading.
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
        let map = Part::new("map", vec![LAYERS.len(), rows, columns]);
        let mut parts = vec![
            Part::new("scan", vec![place.beams]),
            Part { slices: state, ..Part::new("state", vec![STATE]) },
            Part { slices: LAYERS.to_vec(), ..map },
        ];
        parts.extend(place.local_map().map(|local| local.part()));
        parts
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
        let reward = if self.explorer.is_over() { 0.0 } else { self.explorer.advance(&twist) };
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
        let (state, rest) = rest.split_at_mut(STATE);
        let (map, local_map) = rest.split_at_mut(layers.len());
        write_scan(scan, &explorer.reading.scan.ranges_m, explorer.one.range_max_m);
        write_state(state, explorer.state());
        map.copy_from_slice(layers);
        explorer.write_local_map(local_map);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ExploreSettings;
    use crate::local_map;
    use interfaces::CellState::{Blocked, Free, Unknown};
    use interfaces::heading_rad;

    const CELLS: usize = 24;
    const CELL_M: f64 = 0.5;

    /// A task with a local map, after a drive of three minutes.
    fn driven() -> Explore {
        let settings = ExploreSettings {
            beams: Some(90),
            shows_local_map: true,
            local_map_cells: CELLS,
            local_map_cell_m: CELL_M,
            ..ExploreSettings::default()
        };
        let place = Arc::new(ExplorePlace::of_houses(vec![7], settings).unwrap());
        let mut task = Explore::new(&place).unwrap();
        task.reset(3);
        let mut results = Results::of(&task);
        for step in 0..1800 {
            task.step(&[0.5, if step % 80 < 50 { 0.1 } else { 0.7 }], &mut results);
        }
        task
    }

    /// The mean of a value of the cells at the four points in a cell of the local map; 0 beyond the map.
    fn mean(task: &Explore, row: usize, column: usize, value: &dyn Fn(usize) -> f64) -> f64 {
        let (mapper, pose) = (&task.explorer.robot.mapper, &task.explorer.reading.pose);
        let (sin, cos) = libm::sincos(heading_rad(pose));
        let half_m = CELLS as f64 * CELL_M / 2.0;
        let mut sum = 0.0;
        for (dx, dy) in [(0.25, 0.25), (0.25, 0.75), (0.75, 0.25), (0.75, 0.75)] {
            let ahead_m = (column as f64 + dx) * CELL_M - half_m;
            let left_m = (row as f64 + dy) * CELL_M - half_m;
            let mut point = nalgebra::Point2::from(pose.translation.vector);
            point.x += cos * ahead_m - sin * left_m;
            point.y += sin * ahead_m + cos * left_m;
            sum += mapper.frame().index(mapper.frame().cell_at(&point)).map_or(0.0, value);
        }
        sum / 4.0
    }

    #[test]
    fn the_local_map_has_the_cells_around_the_robot() {
        let mut task = driven();
        let parts = task.parts();
        let lengths: Vec<usize> = parts.iter().map(Part::values).collect();
        assert_eq!((parts[3].name, lengths[3]), ("local_map", local_map::LAYERS.len() * CELLS * CELLS));
        let mut observation = vec![0.0; lengths.iter().sum()];
        task.observe(&mut observation);
        let layers = &observation[lengths[..3].iter().sum()..];
        let mapper = &task.explorer.robot.mapper;
        let is = |is: bool| f64::from(u8::from(is));
        let state = |index: usize| mapper.states().cells()[index];
        let beside_free = |index: usize| mapper.frame().beside(index).any(|other| state(other) == Free);
        let age =
            |index: usize| if mapper.was_ever_seen(index) { mapper.recency(index) } else { f64::INFINITY };
        let oracle: [&dyn Fn(usize) -> f64; local_map::LAYERS.len()] = [
            &|index| is(state(index) == Free),
            &|index| is(state(index) == Blocked),
            &|index| is(state(index) == Unknown),
            &|index| is(state(index) == Unknown && beside_free(index)),
            &|index| 1.0 - libm::exp(-age(index) / 60.0),
            &|index| mapper.change_probability(index) * is(mapper.was_ever_seen(index)),
            &|index| 1.0 - 0.01 / (0.01 + mapper.acting_rate(index)),
        ];
        for (layer, value) in oracle.into_iter().enumerate() {
            let mut most = 0.0_f32;
            for (row, column) in (0..CELLS).flat_map(|row| (0..CELLS).map(move |column| (row, column))) {
                let found = layers[(layer * CELLS + row) * CELLS + column];
                let expected = mean(&task, row, column, value);
                let name = local_map::LAYERS[layer].0;
                assert!(
                    (f64::from(found) - expected).abs() < 1e-5,
                    "{name}, {row}, {column}: {found}, {expected}"
                );
                most = most.max(found);
            }
            assert!(most > 0.01, "nothing in `{}`", local_map::LAYERS[layer].0);
        }
    }
}
