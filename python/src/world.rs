use crate::convert::{from_json, grid, optional_index, pose_array, value_error, whole};
use crate::mapper::Mapper;
use crate::reading::Reading;
use crate::spec::{driving, spec_of};
use evaluation::metrics::{MapScores, RateScores, map_scores, rate_scores};
use interfaces::{GroundTruth, TrueState, Twist, World as _};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use sim::physics::PhysicsWorld;

/// A world in which one robot is driven, with the ground truth of every cell.
#[pyclass(module = "curious")]
pub(crate) struct World {
    pub(crate) world: PhysicsWorld,
}

/// How good a map is.
#[derive(serde::Serialize)]
struct Scores {
    #[serde(flatten)]
    rates: RateScores,
    #[serde(flatten)]
    map: MapScores,
}

#[pymethods]
impl World {
    /// The world (`Spec`, name or path) at its start. `robot`: the index of the driven robot, where it is not the
    /// only one. `exact`: readings have the true pose in place of that by odometry.
    #[new]
    #[pyo3(signature = (world, seed = 0, *, robot = None, exact = false))]
    fn new(
        py: Python<'_>,
        world: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = whole)] seed: u64,
        #[pyo3(from_py_with = optional_index)] robot: Option<usize>,
        exact: bool,
    ) -> PyResult<Self> {
        let spec = driving(&spec_of(py, world)?, robot)?;
        let mut world = py.detach(|| PhysicsWorld::new(&spec, seed));
        if exact {
            world.correct_odometry();
        }
        Ok(Self { world })
    }

    /// The time since the start, s.
    #[getter]
    fn time(&self) -> f64 {
        self.world.time_s()
    }

    /// The index of the driven robot.
    #[getter]
    fn driven(&self) -> usize {
        self.world.spec().driven_index()
    }

    /// The scan of the driven robot now, with its pose by odometry.
    fn sense(&mut self, py: Python<'_>) -> Reading {
        let world = &mut self.world;
        Reading::of(py.detach(|| world.sense()))
    }

    /// Drives with a linear (m/s) and an angular (rad/s) velocity until the next scan is due.
    fn act(&mut self, py: Python<'_>, linear: f64, angular: f64) -> PyResult<()> {
        if !(linear.is_finite() && angular.is_finite()) {
            return Err(value_error(format!("a command is finite, and not [{linear}, {angular}]")));
        }
        let world = &mut self.world;
        py.detach(|| world.act(&Twist { linear_mps: linear, angular_radps: angular }));
        Ok(())
    }

    /// The true pose of the driven robot: x (m), y (m), heading (rad).
    #[getter]
    fn true_pose<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        pose_array(py, self.world.true_pose())
    }

    /// The number of collisions of the moving robot in the last `act`.
    #[getter]
    fn collisions(&self) -> usize {
        self.world.contacts().iter().filter(|contact| contact.moving).count()
    }

    /// The true state of every cell, shape (rows, columns), int8: 0 free, 1 blocked, -1 partly covered.
    fn true_states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i8>>> {
        let truth = self.world.truth();
        let state = |index| match truth.state(index) {
            TrueState::Free => 0,
            TrueState::Blocked => 1,
            TrueState::PartlyCovered => -1,
        };
        grid(py, truth.frame(), (0..truth.frame().len()).map(state).collect())
    }

    /// The true rate of every cell so far, shape (rows, columns), cycles per second.
    fn true_rates<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let truth = self.world.truth();
        grid(py, truth.frame(), (0..truth.frame().len()).map(|index| truth.cycle_rate(index)).collect())
    }

    /// An empty map for this world, with its cells and the settings that the programs use.
    #[pyo3(signature = (*, estimator = None, occupancy = None, max_gap = None))]
    fn mapper(
        &self,
        estimator: Option<&str>,
        occupancy: Option<&str>,
        max_gap: Option<f64>,
    ) -> PyResult<Mapper> {
        Mapper::for_world(self.world.spec(), estimator, occupancy, max_gap)
    }

    /// The scores of a map of this world, a dict with the keys of `summary.json`: among them log_error, rate_error, false_rate_hz,
    /// rate_auc, coverage, map_quality. None: not defined yet.
    fn score<'py>(&self, py: Python<'py>, mapper: &Mapper) -> PyResult<Bound<'py, PyAny>> {
        let (truth, map) = (self.world.truth(), &mapper.mapper);
        if map.frame() != truth.frame() {
            return Err(value_error("the map has other cells than the world: make it by `world.mapper()`"));
        }
        let scores = py.detach(|| Scores { rates: rate_scores(map, truth), map: map_scores(map, truth) });
        from_json(py, &scores)
    }

    /// Returns to the start, with another seed.
    #[pyo3(signature = (seed = 0))]
    fn reset(&mut self, py: Python<'_>, #[pyo3(from_py_with = whole)] seed: u64) {
        let world = &mut self.world;
        py.detach(|| world.reset(seed));
    }

    fn __repr__(&self) -> String {
        format!("<curious.World {:?} at {:.3} s>", self.world.spec().name, self.world.time_s())
    }
}
