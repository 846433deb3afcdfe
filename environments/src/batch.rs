//! Many tasks, stepped by one call.

use crate::task::{Outcome, Task, TaskError};
use crate::threads::share;
use rayon::ThreadPool;
use std::sync::Arc;

/// What rounding may add to an action.
const ROUNDING: f32 = 1e-6;

/// A number of tasks of the same kind.
pub struct Batch<T> {
    tasks: Vec<T>,
    agents: usize,
    action_len: usize,
    observation_len: usize,
    info_len: usize,
    is_parallel: bool,
    pool: Option<Arc<ThreadPool>>,
    is_autoreset: bool,
}

/// The results of a step, each with one part per task; in a task, one part per agent.
#[derive(Clone, Debug, Default)]
pub struct Results {
    /// The observations after the step; of a task that was over, after its reset.
    pub observations: Vec<f32>,
    /// The rewards.
    pub rewards: Vec<f32>,
    /// Whether the episode ended by what happened.
    pub terminated: Vec<bool>,
    /// Whether the episode ended by its length.
    pub truncated: Vec<bool>,
    /// The last observations of tasks that were over; those of other tasks stay as they were.
    pub last_observations: Vec<f32>,
    /// The values of [`Task::info`] after the step, before a reset.
    pub info: Vec<f32>,
    /// Whether the task was over for all of its agents, and was reset; one value per task.
    pub was_reset: Vec<bool>,
}

/// As [`Results`], in memory of the caller.
pub struct ResultsMut<'a> {
    /// See [`Results::observations`].
    pub observations: &'a mut [f32],
    /// See [`Results::rewards`].
    pub rewards: &'a mut [f32],
    /// See [`Results::terminated`].
    pub terminated: &'a mut [bool],
    /// See [`Results::truncated`].
    pub truncated: &'a mut [bool],
    /// See [`Results::last_observations`].
    pub last_observations: &'a mut [f32],
    /// See [`Results::info`].
    pub info: &'a mut [f32],
    /// See [`Results::was_reset`].
    pub was_reset: &'a mut [bool],
}

impl<'a> From<&'a mut Results> for ResultsMut<'a> {
    fn from(results: &'a mut Results) -> Self {
        Self {
            observations: &mut results.observations,
            rewards: &mut results.rewards,
            terminated: &mut results.terminated,
            truncated: &mut results.truncated,
            last_observations: &mut results.last_observations,
            info: &mut results.info,
            was_reset: &mut results.was_reset,
        }
    }
}

/// What one task reads and writes in a step.
struct Job<'a, T> {
    task: &'a mut T,
    actions: &'a [f32],
    next_seed: u64,
    observations: &'a mut [f32],
    outcome: Outcome<'a>,
    last_observations: &'a mut [f32],
    info: &'a mut [f32],
    was_reset: &'a mut bool,
    is_autoreset: bool,
}

impl<T: Task> Job<'_, T> {
    fn run(self) {
        let Self {
            task,
            actions,
            next_seed,
            observations,
            mut outcome,
            last_observations,
            info,
            was_reset,
            ..
        } = self;
        let Outcome { rewards, terminated, truncated } = &mut outcome;
        task.step(actions, Outcome { rewards, terminated, truncated });
        task.info(info);
        *was_reset = self.is_autoreset && outcome.is_over();
        if *was_reset {
            task.observe(last_observations);
            task.reset(next_seed);
        }
        task.observe(observations);
    }
}

impl<T: Task> Batch<T> {
    /// A batch of tasks of the same kind and place; at least one. The tasks must be reset before the first step.
    pub fn new(tasks: Vec<T>) -> Self {
        let first = tasks.first();
        let of = |value: fn(&T) -> usize| first.map_or(0, value);
        Self {
            agents: of(Task::agents).max(1),
            action_len: of(Task::action_len),
            observation_len: of(|task| task.parts().iter().map(|part| part.values()).sum()),
            info_len: of(|task| task.info_names().len()),
            is_parallel: tasks.len() > 1,
            pool: None,
            is_autoreset: true,
            tasks,
        }
    }

    /// Whether the tasks are stepped on as many threads as the pool has (the default for more than one task), one of which
    /// is this thread, or on this thread alone. The results are the same.
    pub fn set_parallel(&mut self, is_parallel: bool) {
        self.is_parallel = is_parallel;
    }

    /// The pool of threads; `None` (the default): the present rayon pool.
    pub fn set_pool(&mut self, pool: Option<Arc<ThreadPool>>) {
        self.pool = pool;
    }

    /// Whether a task that is over is reset in the same step (the default), or stands still until it is reset.
    pub fn set_autoreset(&mut self, is_autoreset: bool) {
        self.is_autoreset = is_autoreset;
    }

    /// The tasks.
    pub fn tasks(&self) -> &[T] {
        &self.tasks
    }

    /// The tasks, for changes between steps.
    pub fn tasks_mut(&mut self) -> &mut [T] {
        &mut self.tasks
    }

    /// The number of values of the observation of an agent.
    pub fn observation_len(&self) -> usize {
        self.observation_len
    }

    /// Memory for the results of a step.
    pub fn results(&self) -> Results {
        let agents = self.tasks.len() * self.agents;
        Results {
            observations: vec![0.0; agents * self.observation_len],
            rewards: vec![0.0; agents],
            terminated: vec![false; agents],
            truncated: vec![false; agents],
            last_observations: vec![0.0; agents * self.observation_len],
            info: vec![0.0; agents * self.info_len],
            was_reset: vec![false; self.tasks.len()],
        }
    }

    /// Begins an episode in every task.
    ///
    /// # Errors
    ///
    /// When a slice has the wrong length. Nothing is changed then.
    pub fn reset(&mut self, seeds: &[u64], observations: &mut [f32]) -> Result<(), TaskError> {
        let values = self.agents * self.observation_len;
        check("seeds", seeds.len(), self.tasks.len())?;
        check("observations", observations.len(), self.tasks.len() * values)?;
        let jobs = self.tasks.iter_mut().zip(seeds).zip(observations.chunks_mut(values.max(1)));
        let run = |((task, seed), observations): ((&mut T, &u64), &mut [f32])| {
            task.reset(*seed);
            task.observe(observations);
        };
        if self.is_parallel {
            share(self.pool.as_deref(), jobs, run);
        } else {
            jobs.for_each(run);
        }
        Ok(())
    }

    /// Simulates one step of every task. `next_seeds` has, for every task, the seed of its next episode, which begins
    /// if the present one ends in this step.
    ///
    /// # Errors
    ///
    /// When an action is out of range, or a slice has the wrong length. Nothing is changed then.
    pub fn step<'a>(
        &mut self,
        actions: &[f32],
        next_seeds: &[u64],
        results: impl Into<ResultsMut<'a>>,
    ) -> Result<(), TaskError> {
        let ResultsMut { observations, rewards, terminated, truncated, last_observations, info, was_reset } =
            results.into();
        let (tasks, agents) = (self.tasks.len(), self.agents);
        let (actions_len, values, infos) =
            (agents * self.action_len, agents * self.observation_len, agents * self.info_len);
        check("actions", actions.len(), tasks * actions_len)?;
        check("seeds", next_seeds.len(), tasks)?;
        check("observations", observations.len(), tasks * values)?;
        check("last observations", last_observations.len(), tasks * values)?;
        check("rewards", rewards.len(), tasks * agents)?;
        check("terminated", terminated.len(), tasks * agents)?;
        check("truncated", truncated.len(), tasks * agents)?;
        check("info", info.len(), tasks * infos)?;
        check("resets", was_reset.len(), tasks)?;
        if let Some(at) = actions.iter().position(|action| action.is_nan() || action.abs() > 1.0 + ROUNDING) {
            return Err(TaskError::Action { environment: at / actions_len.max(1), value: actions[at] });
        }
        let is_autoreset = self.is_autoreset;
        let results = observations.chunks_mut(values.max(1)).zip(last_observations.chunks_mut(values.max(1)));
        let ends =
            rewards.chunks_mut(agents).zip(terminated.chunks_mut(agents)).zip(truncated.chunks_mut(agents));
        let jobs = self
            .tasks
            .iter_mut()
            .zip(actions.chunks(actions_len.max(1)))
            .zip(next_seeds)
            .zip(results)
            .zip(ends);
        let jobs = jobs.zip(info.chunks_mut(infos.max(1))).zip(was_reset);
        let jobs = jobs.map(|((inputs, info), was_reset)| {
            let ((((task, actions), &next_seed), (observations, last_observations)), ends) = inputs;
            let ((rewards, terminated), truncated) = ends;
            let outcome = Outcome { rewards, terminated, truncated };
            Job {
                task,
                actions,
                next_seed,
                observations,
                outcome,
                last_observations,
                info,
                was_reset,
                is_autoreset,
            }
        });
        if self.is_parallel {
            share(self.pool.as_deref(), jobs, Job::run);
        } else {
            jobs.for_each(Job::run);
        }
        Ok(())
    }
}

fn check(what: &'static str, found: usize, expected: usize) -> Result<(), TaskError> {
    if found == expected { Ok(()) } else { Err(TaskError::Length { what, found, expected }) }
}
