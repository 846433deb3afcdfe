//! Trials of exploring robots, with strategies of the library or of Python.

use crate::convert::{Table, optional_index, pose_array, value_error, whole, world_error};
use crate::mapper::Mapper;
use crate::spec::{driving, spec_of};
use agent::{Policy, Situation as Inputs, Strategy};
use evaluation::trials::{Experiment, Metric, PhysicsRobot, Trial, TrialStrategy, run_trial};
use mapper::EstimatorChoice;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sim::physics::WorldSpec;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// What a strategy of Python knows when it weighs the cells.
#[pyclass(frozen, module = "curious")]
pub(crate) struct Situation {
    /// A copy of the map.
    #[pyo3(get)]
    mapper: Py<Mapper>,
    /// The pose of the robot: x (m), y (m), heading (rad).
    #[pyo3(get)]
    pose: Py<PyArray1<f64>>,
    travel: Vec<f64>,
}

#[pymethods]
impl Situation {
    /// The travel time to every cell, s, shape (rows, columns); inf where no path is known.
    /// `AttributeError`: the strategy does not have the attribute `needs_travel = True`.
    #[getter]
    fn travel<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        if self.travel.is_empty() {
            return Err(pyo3::exceptions::PyAttributeError::new_err(
                "travel times are computed only for a strategy with `needs_travel = True`",
            ));
        }
        let (rows, columns) = self.mapper.borrow(py).size();
        self.travel.clone().into_pyarray(py).reshape([rows, columns])
    }
}

/// The first error of a strategy of Python.
type FirstError = Arc<Mutex<Option<PyErr>>>;

/// A strategy of Python.
#[derive(Debug)]
struct OfPython {
    strategy: Py<PyAny>,
    needs_travel: bool,
    error: FirstError,
}

impl OfPython {
    fn try_weigh(&self, inputs: &Inputs<'_>, weights: &mut [f64]) -> PyResult<()> {
        Python::attach(|py| {
            let mapper = Py::new(py, Mapper { mapper: inputs.mapper.clone() })?;
            let pose = pose_array(py, inputs.pose).unbind();
            let situation = Situation { mapper, pose, travel: inputs.travel.to_vec() };
            let found = self.strategy.bind(py).call_method1("weigh", (situation,))?;
            let Table(found) = found.extract()?;
            let (array, frame) = (found.as_array(), inputs.mapper.frame());
            if array.shape() != [frame.height(), frame.width()] {
                return Err(value_error(format!(
                    "`weigh` returned an array of the shape {:?}, and must return one weight per cell: ({}, {})",
                    array.shape(),
                    frame.height(),
                    frame.width()
                )));
            }
            weights.iter_mut().zip(array.iter()).for_each(|(weight, value)| *weight = *value);
            Ok(())
        })
    }
}

impl Strategy for OfPython {
    fn name(&self) -> &'static str {
        "python"
    }

    fn weigh(&mut self, inputs: &Inputs<'_>, weights: &mut [f64]) {
        if let Err(error) = self.try_weigh(inputs, weights) {
            self.error.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        }
    }

    fn needs_travel(&self) -> bool {
        self.needs_travel
    }
}

/// The strategy with a name, or an object with a method `weigh`.
fn strategy_of(strategy: &Bound<'_, PyAny>, error: &FirstError) -> PyResult<TrialStrategy> {
    if let Ok(name) = strategy.extract::<String>() {
        return TrialStrategy::all().find(|known| known.name() == name).ok_or_else(|| {
            let names: Vec<&str> = TrialStrategy::all().map(|known| known.name()).collect();
            value_error(format!("no strategy is called `{name}`; there are {}", names.join(", ")))
        });
    }
    if !strategy.hasattr("weigh")? {
        let what = "a strategy is a name, or an object with a method `weigh(situation)` that returns one weight per cell";
        return Err(pyo3::exceptions::PyTypeError::new_err(what));
    }
    let needs_travel = match strategy.getattr_opt("needs_travel")? {
        Some(needs) => needs.is_truthy()?,
        None => false,
    };
    let (strategy, error) = (strategy.clone().unbind(), Arc::clone(error));
    let policy = Policy::single("python", "what a strategy of Python says", move |_| OfPython {
        strategy: Python::attach(|py| strategy.clone_ref(py)),
        needs_travel,
        error: Arc::clone(&error),
    });
    Ok(TrialStrategy::Agent(policy))
}

/// Lets a robot explore a world for some time, and scores what it has learned.
///
/// `world`: a physics world (`Spec`, name or path). `seconds`: the length of the trial. `strategy`: the name of one of the library (`curious.strategies()`), or an object with a method `weigh(situation) -> array` of one weight per cell,
/// shape (rows, columns): a goal is drawn with a probability in proportion to the weight of its patch. `estimator`: see
/// `Mapper.estimators()`. `unseen_first`: the robot looks into unseen space before it asks the strategy; otherwise the strategy chooses
/// every goal.
///
/// Returns a dict: the last value of every metric, `samples` (a dict of lists over the time), `strategy_share`,
/// `collisions`, `false_change_events`, `false_map_changes`, `map_hash`. Times are in s. The same arguments give the same result,
/// also in `house_trials`. An exception of the strategy ends the trial.
#[pyfunction]
#[pyo3(signature = (world, strategy = None, *, seed = 0, seconds = 600, estimator = None, robot = None, unseen_first = false))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn trial<'py>(
    py: Python<'py>,
    world: &Bound<'py, PyAny>,
    strategy: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = whole)] seed: u64,
    #[pyo3(from_py_with = whole)] seconds: u64,
    estimator: Option<&str>,
    #[pyo3(from_py_with = optional_index)] robot: Option<usize>,
    unseen_first: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let error = FirstError::default();
    let strategies = vec![match strategy {
        Some(strategy) => strategy_of(strategy, &error)?,
        None => TrialStrategy::Agent(Policy::default()),
    }];
    let estimator = estimator.map(str::parse::<EstimatorChoice>).transpose().map_err(value_error)?;
    let estimator = estimator.unwrap_or(robot::default_mapper().estimator);
    if seconds == 0 {
        return Err(value_error("a trial has at least 1 of `seconds`"));
    }
    let experiment = Experiment {
        worlds: vec![driving(&spec_of(py, world)?, robot)?],
        estimators: vec![estimator],
        strategies,
        trials: 1,
        seed,
        length: seconds,
        robot: PhysicsRobot { unseen_first, ..PhysicsRobot::default() },
    };
    let trial = run(py, &experiment, &error)?;
    let (dict, samples) = (PyDict::new(py), PyDict::new(py));
    for (name, value) in
        [("world", &trial.world), ("strategy", &trial.strategy), ("estimator", &trial.estimator)]
    {
        dict.set_item(name, value)?;
    }
    dict.set_item("seed", trial.seed)?;
    samples.set_item("time", trial.samples.iter().map(|sample| sample.time).collect::<Vec<u64>>())?;
    for metric in Metric::ALL {
        let values: Vec<f64> = trial.samples.iter().map(|sample| metric.of(sample)).collect();
        dict.set_item(metric.name(), values.last().copied())?;
        samples.set_item(metric.name(), values)?;
    }
    dict.set_item("samples", samples)?;
    dict.set_item("strategy_share", trial.strategy_share.into_iter().collect::<BTreeMap<_, _>>())?;
    dict.set_item("collisions", trial.collisions)?;
    dict.set_item("false_change_events", trial.false_change_events)?;
    dict.set_item("false_map_changes", trial.false_map_changes)?;
    dict.set_item("map_hash", trial.map_hash)?;
    Ok(dict)
}

/// Runs the only trial of an experiment. Ctrl-C and an error of the strategy end it.
fn run(py: Python<'_>, experiment: &Experiment<WorldSpec>, error: &FirstError) -> PyResult<Trial> {
    let error = || error.lock().unwrap_or_else(PoisonError::into_inner);
    let mut readings = 0_u32;
    let goes_on = || {
        readings = readings.wrapping_add(1);
        if readings.is_multiple_of(256)
            && let Err(signal) = Python::attach(|py| py.check_signals())
        {
            *error() = Some(signal);
        }
        error().is_none()
    };
    let result = py.detach(|| experiment.jobs().into_iter().next().map(|job| run_trial(&job, goes_on)));
    if let Some(error) = error().take() {
        return Err(error);
    }
    let result = result.ok_or_else(|| value_error("there is no trial"))?.map_err(world_error)?;
    result.ok_or_else(|| value_error("the trial was canceled"))
}

/// The names of the strategies of the library.
#[pyfunction]
pub(crate) fn strategies() -> Vec<&'static str> {
    TrialStrategy::all().map(|strategy| strategy.name()).collect()
}
