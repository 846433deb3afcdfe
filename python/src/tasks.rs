use crate::convert::{index, snapshot_error, value_error, whole};
use crate::settings::{drive_settings, explore_settings};
use crate::snapshots::{Kind, check_build};
use crate::spec::{driving, spec_of};
use environments::{Drive, DrivePlace, Explore, ExplorePlace, Picture, ResultsMut, Task, TaskError};
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyIndexError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use std::sync::Arc;

/// A number of tasks that are stepped by one call: the native part of the environments.
///
/// There is one row per agent, environment by environment. Use it through `curious.envs`, which has the interfaces of
/// Gymnasium and PettingZoo.
#[pyclass(module = "curious")]
pub(crate) struct Batch {
    tasks: Tasks,
    /// The last observations of episodes that ended in a step.
    last: Vec<f32>,
    environments: usize,
    agents: usize,
    /// Whether every environment was reset once.
    is_ready: bool,
    is_autoreset: bool,
}

enum Tasks {
    Drive(environments::Batch<Drive>),
    Explore(environments::Batch<Explore>),
}

/// Does the same with both kinds of tasks.
macro_rules! each {
    ($tasks:expr, $batch:ident => $result:expr) => {
        match $tasks {
            Tasks::Drive($batch) => $result,
            Tasks::Explore($batch) => $result,
        }
    };
}

/// The arrays of a step.
type Stepped<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<bool>>,
    Option<Bound<'py, PyArray2<f32>>>,
);

impl Batch {
    fn with(tasks: Tasks, environments: usize, threads: usize) -> PyResult<Self> {
        let pool = match threads {
            0 | 1 => None,
            threads => {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                Some(Arc::new(pool.map_err(|error| PyRuntimeError::new_err(error.to_string()))?))
            }
        };
        let agents = each!(&tasks, batch => batch.tasks().first().map_or(1, Task::agents));
        let mut batch =
            Self { tasks, last: Vec::new(), environments, agents, is_ready: false, is_autoreset: true };
        each!(&mut batch.tasks, batch => {
            batch.set_pool(pool);
            if threads == 1 {
                batch.set_parallel(false);
            }
        });
        batch.last = vec![0.0; environments * agents * batch.observation_len()];
        Ok(batch)
    }

    fn rows(&self) -> usize {
        self.environments * self.agents
    }

    fn check(&self, environment: usize) -> PyResult<()> {
        if environment < self.environments {
            return Ok(());
        }
        let count = self.environments;
        Err(PyIndexError::new_err(format!(
            "there is no environment {environment}: there are {count}, counted from 0"
        )))
    }

    fn kind(&self) -> Kind {
        match &self.tasks {
            Tasks::Drive(_) => Kind("driving environment"),
            Tasks::Explore(_) => Kind("exploring environment"),
        }
    }

    fn check_count(environments: usize) -> PyResult<()> {
        if (1..=1 << 20).contains(&environments) {
            return Ok(());
        }
        Err(value_error(format!("the number of environments must be from 1 to 1048576, not {environments}")))
    }
}

#[pymethods]
impl Batch {
    /// Driving tasks in a world. `threads`: 0 for all, 1 for none beside the caller.
    #[staticmethod]
    #[pyo3(signature = (world, environments, threads = 0, **settings))]
    fn drive(
        py: Python<'_>,
        world: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = whole)] environments: usize,
        #[pyo3(from_py_with = whole)] threads: usize,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        Self::check_count(environments)?;
        let (spec, settings) = (spec_of(py, world)?, drive_settings(settings)?);
        let tasks: Result<Vec<Drive>, TaskError> = py.detach(|| {
            let place = Arc::new(DrivePlace::new(&spec, settings)?);
            Ok((0..environments).map(|_| Drive::new(&place)).collect())
        });
        let tasks = tasks.map_err(value_error)?;
        Self::with(Tasks::Drive(environments::Batch::new(tasks)), environments, threads)
    }

    /// Exploring tasks in some worlds; each episode is in one of them. `threads` as above.
    #[staticmethod]
    #[pyo3(signature = (worlds, environments, threads = 0, **settings))]
    fn explore(
        py: Python<'_>,
        worlds: &Bound<'_, PyList>,
        #[pyo3(from_py_with = whole)] environments: usize,
        #[pyo3(from_py_with = whole)] threads: usize,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        Self::check_count(environments)?;
        let specs = worlds.iter().map(|world| driving(&spec_of(py, &world)?, None));
        let (specs, settings) = (specs.collect::<PyResult<Vec<_>>>()?, explore_settings(settings)?);
        let tasks: Result<Vec<Explore>, TaskError> = py.detach(|| {
            let place = Arc::new(ExplorePlace::new(&specs, settings)?);
            (0..environments).map(|_| Explore::new(&place)).collect()
        });
        let tasks = tasks.map_err(value_error)?;
        Self::with(Tasks::Explore(environments::Batch::new(tasks)), environments, threads)
    }

    /// The number of environments.
    #[getter]
    fn environments(&self) -> usize {
        self.environments
    }

    /// The number of agents of an environment.
    #[getter]
    fn agents(&self) -> usize {
        self.agents
    }

    /// The number of values of an observation.
    #[getter]
    fn observation_len(&self) -> usize {
        each!(&self.tasks, batch => batch.observation_len())
    }

    /// The parts of an observation: names and shapes.
    #[getter]
    fn parts(&self) -> Vec<(&'static str, Vec<usize>)> {
        let parts = each!(&self.tasks, batch => batch.tasks().first().map(Task::parts)).unwrap_or_default();
        parts.into_iter().map(|part| (part.name, part.shape)).collect()
    }

    /// The names of the columns of the information about a step.
    #[getter]
    fn info_names(&self) -> Vec<&'static str> {
        each!(&self.tasks, batch => batch.tasks().first().map_or(Vec::new(), |task| task.info_names().to_vec()))
    }

    /// Whether an environment that is over is reset in the same step: set it to False to reset it by `reset_one`.
    #[getter]
    fn autoreset(&self) -> bool {
        self.is_autoreset
    }

    #[setter]
    fn set_autoreset(&mut self, is_autoreset: bool) {
        self.is_autoreset = is_autoreset;
        each!(&mut self.tasks, batch => batch.set_autoreset(is_autoreset));
    }

    /// Begins an episode in every environment. `seeds`: uint64, one per environment. Returns the observations, shape
    /// (environments * agents, observation_len), float32.
    fn reset<'py>(
        &mut self,
        py: Python<'py>,
        seeds: PyReadonlyArray1<'py, u64>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let (rows, values) = (self.rows(), self.observation_len());
        let seeds = seeds.as_array().to_vec();
        let tasks = &mut self.tasks;
        let mut observations = vec![0.0; rows * values];
        py.detach(|| each!(tasks, batch => batch.reset(&seeds, &mut observations))).map_err(value_error)?;
        self.is_ready = true;
        observations.into_pyarray(py).reshape([rows, values])
    }

    /// Begins an episode in one environment, and returns its observations, shape (agents, observation_len).
    fn reset_one<'py>(
        &mut self,
        py: Python<'py>,
        #[pyo3(from_py_with = index)] environment: usize,
        #[pyo3(from_py_with = whole)] seed: u64,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.check(environment)?;
        self.is_ready |= self.environments == 1;
        let mut observations = vec![0.0; self.agents * self.observation_len()];
        let tasks = &mut self.tasks;
        py.detach(|| {
            each!(tasks, batch => {
                let task = &mut batch.tasks_mut()[environment];
                task.reset(seed);
                task.observe(&mut observations);
            });
        });
        observations.into_pyarray(py).reshape([self.agents, self.observation_len()])
    }

    /// Simulates one step. `actions`: float32, shape (environments * agents, 2), from -1 to 1. `next_seeds`: uint64,
    /// one per environment, for the episodes that begin in this step.
    ///
    /// Returns observations, rewards, terminated, truncated, information, whether each environment was reset, and the
    /// last observations of the episodes that ended (None if none ended; other rows are not meaningful).
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        actions: PyReadonlyArray2<'py, f32>,
        next_seeds: PyReadonlyArray1<'py, u64>,
    ) -> PyResult<Stepped<'py>> {
        if !self.is_ready {
            return Err(PyRuntimeError::new_err("call reset() before step()"));
        }
        let (rows, values, environments) = (self.rows(), self.observation_len(), self.environments);
        let shape = actions.as_array().dim();
        if shape != (rows, 2) {
            return Err(value_error(format!(
                "the actions have the shape {shape:?}, and must have ({rows}, 2)"
            )));
        }
        let copied: Vec<f32>;
        let actions = match actions.as_slice().ok().filter(|_| actions.is_c_contiguous()) {
            Some(actions) => actions,
            None => {
                copied = actions.as_array().iter().copied().collect();
                &copied
            }
        };
        let next_seeds = next_seeds.as_array().to_vec();
        let infos = self.info_names().len();
        let (mut observations, mut rewards) = (vec![0.0; rows * values], vec![0.0; rows]);
        let (mut terminated, mut truncated) = (vec![false; rows], vec![false; rows]);
        let (mut info, mut was_reset) = (vec![0.0; rows * infos], vec![false; environments]);
        let (tasks, last) = (&mut self.tasks, &mut self.last);
        let results = ResultsMut {
            observations: &mut observations,
            rewards: &mut rewards,
            terminated: &mut terminated,
            truncated: &mut truncated,
            last_observations: last,
            info: &mut info,
            was_reset: &mut was_reset,
        };
        py.detach(|| each!(tasks, batch => batch.step(actions, &next_seeds, results)))
            .map_err(value_error)?;
        let last = if was_reset.contains(&true) {
            Some(PyArray1::from_slice(py, &self.last).reshape([rows, values])?)
        } else {
            None
        };
        Ok((
            observations.into_pyarray(py).reshape([rows, values])?,
            rewards.into_pyarray(py),
            terminated.into_pyarray(py),
            truncated.into_pyarray(py),
            info.into_pyarray(py).reshape([rows, infos])?,
            was_reset.into_pyarray(py),
            last,
        ))
    }

    /// One environment from above, shape (rows, columns, 3), uint8; the longer side has `size` pixels.
    #[pyo3(signature = (environment = 0, size = 480))]
    fn picture<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = index)] environment: usize,
        #[pyo3(from_py_with = whole)] size: usize,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        self.check(environment)?;
        let Picture { width, height, pixels, .. } = match &self.tasks {
            Tasks::Drive(batch) => batch.tasks()[environment].picture(size),
            Tasks::Explore(batch) => batch.tasks()[environment].picture(size),
        };
        pixels.into_pyarray(py).reshape([height, width, 3])
    }

    /// The position of the goal of an agent of a driving task, m: (x, y); None for other tasks.
    #[pyo3(signature = (environment = 0, agent = 0))]
    fn goal(
        &self,
        #[pyo3(from_py_with = index)] environment: usize,
        #[pyo3(from_py_with = index)] agent: usize,
    ) -> PyResult<Option<(f64, f64)>> {
        self.check(environment)?;
        let Tasks::Drive(batch) = &self.tasks else { return Ok(None) };
        Ok(batch.tasks()[environment].goal(agent).map(|goal| (goal.x, goal.y)))
    }

    /// The true poses of all robots of an environment, shape (robots, 3).
    #[pyo3(signature = (environment = 0))]
    fn poses<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = index)] environment: usize,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.check(environment)?;
        let fleet = match &self.tasks {
            Tasks::Drive(batch) => batch.tasks()[environment].fleet(),
            Tasks::Explore(batch) => batch.tasks()[environment].world().fleet(),
        };
        let mut poses = vec![[0.0; 3]; fleet.spec().robots.len()];
        fleet.copy_poses(&mut poses).map_err(value_error)?;
        poses.concat().into_pyarray(py).reshape([poses.len(), 3])
    }

    /// The state of an environment as bytes.
    #[pyo3(signature = (environment = 0))]
    fn snapshot<'py>(
        &mut self,
        py: Python<'py>,
        #[pyo3(from_py_with = index)] environment: usize,
    ) -> PyResult<Bound<'py, PyBytes>> {
        self.check(environment)?;
        let bytes = each!(&mut self.tasks, batch => batch.tasks_mut()[environment].snapshot());
        Ok(self.kind().seal(py, &bytes))
    }

    /// Returns an environment to a snapshot of one with the same settings, and returns its observations.
    /// `SnapshotError`: the bytes are not one, or were written by another build of the package; the environment must be
    /// reset then.
    #[pyo3(signature = (environment, snapshot, *, allow_other_build = false))]
    fn restore<'py>(
        &mut self,
        py: Python<'py>,
        #[pyo3(from_py_with = index)] environment: usize,
        snapshot: &[u8],
        allow_other_build: bool,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.check(environment)?;
        let state = self.kind().open(snapshot)?;
        check_build(snapshot, allow_other_build)?;
        let mut observations = vec![0.0; self.agents * self.observation_len()];
        each!(&mut self.tasks, batch => {
            let task = &mut batch.tasks_mut()[environment];
            task.restore(state).map_err(snapshot_error)?;
            task.observe(&mut observations);
        });
        self.is_ready |= self.environments == 1;
        observations.into_pyarray(py).reshape([self.agents, self.observation_len()])
    }
}
