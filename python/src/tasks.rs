use crate::convert::{index, snapshot_error, value_error, whole};
use crate::settings::task_settings;
use crate::snapshots::Kind;
use crate::spec::spec_of;
use crate::threads::on_threads;
use environments::{ACTIONS, Drive, DrivePlace, Results, TaskError};
use numpy::{IntoPyArray, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyIndexError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use std::sync::Arc;

/// A number of tasks that are stepped by one call: the native part of the environments.
///
/// There is one row per agent, environment by environment. Use it through `curious.envs`, which has the interfaces of
/// Gymnasium and PettingZoo.
#[pyclass(module = "curious")]
pub(crate) struct Batch {
    batch: environments::Batch,
    /// 0 for one per core.
    threads: usize,
    /// Whether every environment was reset once.
    is_ready: bool,
}

/// What a snapshot of an environment is of.
const KIND: Kind = Kind("driving environment");

impl Batch {
    fn rows(&self) -> usize {
        self.environments() * self.agents()
    }

    fn check(&self, environment: usize) -> PyResult<()> {
        let count = self.environments();
        if environment < count {
            return Ok(());
        }
        Err(PyIndexError::new_err(format!(
            "there is no environment {environment}: there are {count}, counted from 0"
        )))
    }

    /// Observations of one environment as an array.
    fn rows_of_one<'py>(&self, py: Python<'py>, values: Vec<f32>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        values.into_pyarray(py).reshape([self.agents(), self.observation_len()])
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
        if !(1..=1 << 20).contains(&environments) {
            let why = format!("the number of environments must be from 1 to 1048576, not {environments}");
            return Err(value_error(why));
        }
        let (spec, settings) = (spec_of(py, world)?, task_settings(settings)?);
        let batch = py.detach(|| {
            let place = Arc::new(DrivePlace::new(&spec, settings)?);
            Ok(environments::Batch::new((0..environments).map(|_| Drive::new(&place))))
        });
        let mut batch = batch.map_err(|why: TaskError| value_error(why))?;
        batch.is_parallel &= threads != 1;
        Ok(Self { batch, threads, is_ready: false })
    }

    /// The number of environments.
    #[getter]
    fn environments(&self) -> usize {
        self.batch.count()
    }

    /// The number of agents of an environment.
    #[getter]
    fn agents(&self) -> usize {
        self.batch.task(0).agents()
    }

    /// The number of values of an observation.
    #[getter]
    fn observation_len(&self) -> usize {
        self.batch.observation_len()
    }

    /// The names and lengths of the parts of an observation, in their order.
    #[getter]
    fn slices(&self) -> Vec<(&'static str, usize)> {
        self.batch.task(0).slices()
    }

    /// The names of the columns of the information about a step.
    #[getter]
    fn info_names(&self) -> [&'static str; 3] {
        Drive::INFO_NAMES
    }

    /// The information about every environment as it is now, shape (environments * agents, info_names).
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let (rows, names) = (self.rows(), Drive::INFO_NAMES.len());
        let mut values = vec![0.0; rows * names];
        let of_one = values.len() / self.environments();
        for (environment, values) in values.chunks_mut(of_one).enumerate() {
            self.batch.task(environment).info(values);
        }
        values.into_pyarray(py).reshape([rows, names])
    }

    /// Whether an environment that is over is reset in the same step: set it to False to reset all of them by `reset`.
    #[getter]
    fn autoreset(&self) -> bool {
        self.batch.is_autoreset
    }

    #[setter]
    fn set_autoreset(&mut self, is_autoreset: bool) {
        self.batch.is_autoreset = is_autoreset;
    }

    /// Begins an episode in every environment. `seeds`: uint64, one per environment. Returns the observations, shape
    /// (environments * agents, observation_len), float32.
    fn reset<'py>(
        &mut self,
        py: Python<'py>,
        seeds: PyReadonlyArray1<'py, u64>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let (batch, seeds) = (&mut self.batch, seeds.as_array().to_vec());
        let observations = on_threads(py, self.threads, || batch.reset(&seeds))?.map_err(value_error)?;
        self.is_ready = true;
        observations.into_pyarray(py).reshape([self.rows(), self.observation_len()])
    }

    /// Simulates one step. `actions`: float32, shape (environments * agents, 2), from -1 to 1. `next_seeds`: uint64, one per
    /// environment, for the episodes that begin in this step.
    ///
    /// Returns observations, rewards, terminated, truncated, information, whether each environment was reset, and the
    /// last observations of the episodes that ended (None if none ended; other rows are not meaningful).
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        actions: PyReadonlyArray2<'py, f32>,
        next_seeds: PyReadonlyArray1<'py, u64>,
    ) -> PyResult<Bound<'py, PyTuple>> {
        if !self.is_ready {
            return Err(PyRuntimeError::new_err("call reset() before step()"));
        }
        let (rows, values, infos) = (self.rows(), self.observation_len(), Drive::INFO_NAMES.len());
        let shape = actions.as_array().dim();
        if shape != (rows, ACTIONS) {
            return Err(value_error(format!(
                "the actions have the shape {shape:?}, and must have ({rows}, {ACTIONS})"
            )));
        }
        let (actions, next_seeds) =
            (actions.as_array().iter().copied().collect::<Vec<f32>>(), next_seeds.as_array().to_vec());
        let batch = &mut self.batch;
        let results =
            on_threads(py, self.threads, || batch.step(&actions, &next_seeds))?.map_err(value_error)?;
        let Results { observations, rewards, terminated, truncated, last_observations, info, was_reset } =
            results;
        let last = was_reset.contains(&true).then(|| last_observations.into_pyarray(py));
        let arrays = (
            observations.into_pyarray(py).reshape([rows, values])?,
            rewards.into_pyarray(py),
            terminated.into_pyarray(py),
            truncated.into_pyarray(py),
            info.into_pyarray(py).reshape([rows, infos])?,
            was_reset.into_pyarray(py),
            last.map(|last| last.reshape([rows, values])).transpose()?,
        );
        arrays.into_pyobject(py)
    }

    /// One environment from above, shape (rows, columns, 3), uint8; the longer side has `size` pixels.
    #[pyo3(signature = (environment = 0, size = 480))]
    fn picture<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = index)] environment: usize,
        #[pyo3(from_py_with = whole)] size: u32,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        self.check(environment)?;
        let picture = self.batch.task(environment).picture(size);
        let picture = picture.map_err(|why| PyRuntimeError::new_err(why.to_string()))?;
        let [width, height] = picture.size.map(|length| length as usize);
        picture.pixels.into_pyarray(py).reshape([height, width, 3])
    }

    /// The seed of the present episode of an environment; 0 before its first reset.
    #[pyo3(signature = (environment = 0))]
    fn seed(&self, #[pyo3(from_py_with = index)] environment: usize) -> PyResult<u64> {
        self.check(environment)?;
        Ok(self.batch.seed(environment))
    }

    /// The state of an environment as bytes, with the seed of its episode.
    #[pyo3(signature = (environment = 0))]
    fn snapshot<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = index)] environment: usize,
    ) -> PyResult<Bound<'py, PyBytes>> {
        self.check(environment)?;
        Ok(KIND.seal(py, &self.batch.snapshot(environment)))
    }

    /// Returns an environment to a snapshot of one with the same settings, and returns its observations.
    /// `SnapshotError`: the bytes are not one, or were written by another build of the package; nothing is changed then.
    #[pyo3(signature = (environment, snapshot, *, allow_other_build = false))]
    fn restore<'py>(
        &mut self,
        py: Python<'py>,
        #[pyo3(from_py_with = index)] environment: usize,
        snapshot: &[u8],
        allow_other_build: bool,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.check(environment)?;
        let state = KIND.open(snapshot, allow_other_build)?;
        let observations = self.batch.restore(environment, state).map_err(snapshot_error)?.to_vec();
        self.is_ready |= self.environments() == 1;
        self.rows_of_one(py, observations)
    }
}
