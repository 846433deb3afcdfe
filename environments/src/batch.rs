//! Many tasks, stepped by one call.

use crate::drive::Drive;
use crate::results::{ACTIONS, Results, TaskError};
use interfaces::{from_bytes, to_bytes};
use rayon::prelude::*;
use sim::physics::SnapshotError;

/// What rounding may add to an action.
const ROUNDING: f32 = 1e-6;

/// A number of tasks.
pub struct Batch {
    slots: Vec<Slot>,
    /// Whether the tasks are stepped on the threads of the present rayon pool (the default for more than one
    /// task), or on this thread alone. The results are the same.
    pub is_parallel: bool,
    /// Whether a task that is over is reset in the same step (the default), or stands still until it is reset.
    pub is_autoreset: bool,
}

/// A task, the seed of its episode, and the results of its last step.
struct Slot {
    task: Drive,
    seed: u64,
    results: Results,
}

impl Slot {
    fn reset(&mut self, seed: u64) {
        self.seed = seed;
        self.task.reset(seed);
        self.task.observe(&mut self.results.observations);
    }

    fn step(&mut self, actions: &[f32], next_seed: u64, is_autoreset: bool) {
        let Self { task, seed, results } = self;
        task.step(actions, results);
        task.info(&mut results.info);
        results.was_reset[0] = is_autoreset && results.is_over();
        if results.was_reset[0] {
            task.observe(&mut results.last_observations);
            *seed = next_seed;
            task.reset(next_seed);
        }
        task.observe(&mut results.observations);
    }
}

impl Batch {
    /// A batch of tasks in the same place; at least one. The tasks must be reset before the first step.
    pub fn new(tasks: impl IntoIterator<Item = Drive>) -> Self {
        let slot = |task: Drive| {
            let results = Results::new(task.agents(), task.observation_len(), Drive::INFO_NAMES.len());
            Slot { task, seed: 0, results }
        };
        let slots: Vec<Slot> = tasks.into_iter().map(slot).collect();
        Self { is_parallel: slots.len() > 1, slots, is_autoreset: true }
    }

    /// The number of tasks.
    pub fn count(&self) -> usize {
        self.slots.len()
    }

    /// A task.
    pub fn task(&self, index: usize) -> &Drive {
        &self.slots[index].task
    }

    /// The number of values of the observation of an agent.
    pub fn observation_len(&self) -> usize {
        self.slots.first().map_or(0, |first| first.task.observation_len())
    }

    /// Calls `run` with every slot and its input.
    fn each<I: Send>(&mut self, inputs: Vec<I>, run: impl Fn(&mut Slot, I) + Sync + Send) {
        let slots = &mut self.slots;
        if self.is_parallel {
            slots.par_iter_mut().zip(inputs).for_each(|(slot, input)| run(slot, input));
        } else {
            slots.iter_mut().zip(inputs).for_each(|(slot, input)| run(slot, input));
        }
    }

    /// Begins an episode in every task. Returns the observations.
    ///
    /// # Errors
    ///
    /// When the number of seeds is not that of the tasks. Nothing is changed then.
    pub fn reset(&mut self, seeds: &[u64]) -> Result<Vec<f32>, TaskError> {
        check("seeds", seeds.len(), self.slots.len())?;
        self.each(seeds.to_vec(), Slot::reset);
        Ok(self.slots.iter().flat_map(|slot| &slot.results.observations).copied().collect())
    }

    /// Simulates one step of every task. `next_seeds` has, for every task, the seed of its next episode, which begins
    /// if the present one ends in this step.
    ///
    /// # Errors
    ///
    /// When an action is out of range, or a slice has the wrong length. Nothing is changed then.
    pub fn step(&mut self, actions: &[f32], next_seeds: &[u64]) -> Result<Results, TaskError> {
        let tasks = self.slots.len();
        let of_task = self.slots.first().map_or(1, |first| first.task.agents()) * ACTIONS;
        check("actions", actions.len(), tasks * of_task)?;
        check("seeds", next_seeds.len(), tasks)?;
        // Not NaN, and rounding may add a little.
        let is_valid = |action: &f32| action.abs() <= 1.0 + ROUNDING;
        if let Some(at) = actions.iter().position(|action| !is_valid(action)) {
            let (environment, value) = (at / of_task, actions[at]);
            let why = format!("action {value} of environment {environment} is not from -1 to 1");
            return Err(TaskError::Values(why));
        }
        let is_autoreset = self.is_autoreset;
        let inputs = actions.chunks(of_task).zip(next_seeds).collect();
        self.each(inputs, |slot, (actions, seed)| slot.step(actions, *seed, is_autoreset));
        Ok(Results::joined(self.slots.iter().map(|slot| &slot.results)))
    }

    /// The seed of the present episode of one task; 0 before its first reset.
    pub fn seed(&self, index: usize) -> u64 {
        self.slots[index].seed
    }

    /// The state of one task as bytes, with the seed of its episode.
    pub fn snapshot(&self, index: usize) -> Vec<u8> {
        let Slot { task, seed, .. } = &self.slots[index];
        to_bytes(&(*seed, task.snapshot()))
    }

    /// Returns one task to the state of a snapshot of a task with the same settings. Returns its observations.
    ///
    /// # Errors
    ///
    /// When the bytes are not such a snapshot. Nothing is changed then.
    pub fn restore(&mut self, index: usize, snapshot: &[u8]) -> Result<&[f32], SnapshotError> {
        let (saved, state): (u64, Vec<u8>) = from_bytes(snapshot).map_err(|_| SnapshotError::Damaged)?;
        let Slot { task, seed, results } = &mut self.slots[index];
        task.restore(&state)?;
        *seed = saved;
        task.observe(&mut results.observations);
        Ok(&results.observations)
    }
}

fn check(what: &str, found: usize, expected: usize) -> Result<(), TaskError> {
    let why = || format!("{what}: {found} values, and not {expected}");
    if found == expected { Ok(()) } else { Err(TaskError::Values(why())) }
}
