use crate::convert::{
    SnapshotError, grid, optional_index, rows_array, state_number, value_error, world_error,
};
use crate::reading::Reading;
use crate::settings::mapper_settings;
use crate::snapshots::Kind;
use crate::spec::{driving, spec_of};
use evaluation::physics_trial;
use interfaces::{GridFrame, Transition};
use mapper::{CellStatistics, MapperSettings};
use nalgebra::Point2;
use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use sim::physics::WorldSpec;

/// A map of a place that changes: its cells, and how often each of them changes.
///
/// Arrays of cells have the shape (rows, columns); row 0 has the lowest y. The center of cell [row, column] is
/// `origin + ([column, row] + 0.5) * cell` (m).
#[pyclass(module = "curious")]
pub(crate) struct Mapper {
    pub(crate) mapper: mapper::Mapper,
}

impl Mapper {
    fn array<'py, T: numpy::Element>(
        &self,
        py: Python<'py>,
        value: impl Fn(&mapper::Mapper, usize) -> T + Sync,
    ) -> PyResult<Bound<'py, PyArray2<T>>> {
        let mapper = &self.mapper;
        let values: Vec<T> =
            py.detach(|| (0..mapper.frame().len()).map(|index| value(mapper, index)).collect());
        grid(py, mapper.frame(), values)
    }
}

/// What was observed of a cell: its name, and its value.
type Figure<T> = (&'static str, fn(&CellStatistics) -> T);

impl Mapper {
    /// An empty map for a world, with the settings that the programs use.
    pub(crate) fn for_world(
        spec: &WorldSpec,
        estimator: Option<&str>,
        occupancy: Option<&str>,
        max_gap: Option<f64>,
    ) -> PyResult<Self> {
        let settings = physics_trial::settings(spec).map_err(world_error)?.mapper;
        let settings = mapper_settings(settings, estimator, occupancy, max_gap, None)?;
        Ok(Self { mapper: mapper::Mapper::new(&settings, spec.frame).map_err(value_error)? })
    }

    /// The number of rows and columns.
    pub(crate) fn size(&self) -> (usize, usize) {
        (self.mapper.frame().height(), self.mapper.frame().width())
    }
}

const SNAPSHOT: Kind = Kind("mapper");

#[pymethods]
impl Mapper {
    /// An empty map of `width` x `height` m with cells of `cell` m, whose lower left corner is `origin` (m).
    ///
    /// `estimator`: `Mapper.estimators()`. `occupancy`: "steady" or "naive". `max_gap`: a cell that is hidden for at
    /// most this time stays in view, s. `range_noise`: the standard deviation of a range, m.
    #[new]
    #[pyo3(signature = (width, height, *, origin = (0.0, 0.0), cell = 0.05, estimator = None, occupancy = None,
        max_gap = Some(8.0), range_noise = None))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        width: f64,
        height: f64,
        origin: (f64, f64),
        cell: f64,
        estimator: Option<&str>,
        occupancy: Option<&str>,
        max_gap: Option<f64>,
        range_noise: Option<f64>,
    ) -> PyResult<Self> {
        let frame =
            GridFrame::covering(Point2::new(origin.0, origin.1), width, height, cell).ok_or_else(|| {
                value_error(format!(
                    "a map of {width:?} m x {height:?} m with cells of {cell:?} m: it must have 1 to 2^30 cells"
                ))
            })?;
        let settings =
            mapper_settings(MapperSettings::default(), estimator, occupancy, max_gap, range_noise)?;
        Ok(Self { mapper: mapper::Mapper::new(&settings, frame).map_err(value_error)? })
    }

    /// An empty map for a world (`Spec`, name or path), with its cells and the settings that the programs use. Of a
    /// `World`: `World.mapper`.
    #[staticmethod]
    #[pyo3(signature = (world, *, robot = None, estimator = None, occupancy = None, max_gap = None))]
    fn of(
        py: Python<'_>,
        world: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = optional_index)] robot: Option<usize>,
        estimator: Option<&str>,
        occupancy: Option<&str>,
        max_gap: Option<f64>,
    ) -> PyResult<Self> {
        Self::for_world(&driving(&spec_of(py, world)?, robot)?, estimator, occupancy, max_gap)
    }

    /// The names of the estimators of rates.
    #[staticmethod]
    fn estimators() -> Vec<&'static str> {
        mapper::EstimatorChoice::all().iter().map(mapper::EstimatorChoice::name).collect()
    }

    /// Updates the map with a scan from a known pose.
    ///
    /// `time`: s, never earlier than the last one. `ranges`: m, shape (beams,): inf no return, -inf too close, NaN
    /// invalid. `pose`: of the robot in the frame of the map, x (m), y (m), heading (rad). `angle_min`,
    /// `angle_increment`: rad; by default the beams cover a full turn from straight behind. `range_min`, `range_max`:
    /// m. `mount`: the pose of the laser on the robot. `ValueError`: the scan is invalid; the map then stays as it
    /// was.
    #[pyo3(signature = (*scan, **keywords), text_signature = "($self, time, ranges, pose, *, angle_min=..., angle_increment=None, \
        range_min=0.0, range_max=10.0, mount=None, sweep=0.0, velocity=...)")]
    fn update(
        &mut self,
        py: Python<'_>,
        scan: &Bound<'_, PyTuple>,
        keywords: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let reading = py.get_type::<Reading>().call(scan, keywords)?;
        self.update_reading(py, reading.cast::<Reading>()?.get())
    }

    /// Updates the map with a reading, whose pose is taken as exact.
    fn update_reading(&mut self, py: Python<'_>, reading: &Reading) -> PyResult<()> {
        let mapper = &mut self.mapper;
        py.detach(|| mapper.update(&reading.reading)).map_err(value_error)
    }

    /// Leaves a reading out of the map, because its pose is not certain: the time since the last one counts as not
    /// observed.
    fn skip(&mut self, reading: &Reading) {
        self.mapper.skip(&reading.reading);
    }

    /// Begins another session at a time (s): the time since the last reading counts as not observed. `ValueError`: the time is
    /// not finite.
    fn pause(&mut self, time: f64) -> PyResult<()> {
        if !time.is_finite() {
            return Err(value_error(format!("the time of a session is finite, and not {time}")));
        }
        self.mapper.pause(time);
        Ok(())
    }

    /// The time of the last reading, s.
    #[getter]
    fn time(&self) -> f64 {
        self.mapper.time()
    }

    /// The number of readings.
    #[getter]
    fn readings(&self) -> usize {
        self.mapper.readings()
    }

    /// The number of rows and columns.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        self.size()
    }

    /// The side of a cell, m.
    #[getter]
    fn cell(&self) -> f64 {
        self.mapper.frame().resolution_m()
    }

    /// The lower left corner, m.
    #[getter]
    fn origin<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let origin = self.mapper.frame().origin();
        vec![origin.x, origin.y].into_pyarray(py)
    }

    /// The map, int8: -1 unknown, 0 free, 1 blocked.
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i8>>> {
        self.array(py, |mapper, index| state_number(mapper.states().cells()[index]))
    }

    /// The rate of every cell, cycles per second. A cell that never changed has 0, with the estimator `shared-prior` a small rate.
    fn rates<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.array(py, mapper::Mapper::rate)
    }

    /// The mean duration of a cycle, s: 1 divided by the rate, inf where it is 0.
    fn intervals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.array(py, mapper::Mapper::interval)
    }

    /// The intervals that contain the rates with a probability: two arrays, low and high, cycles per second.
    #[pyo3(signature = (mass = 0.9))]
    #[allow(clippy::type_complexity)]
    fn credible_intervals<'py>(
        &self,
        py: Python<'py>,
        mass: f64,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
        if !(mass > 0.0 && mass < 1.0) {
            return Err(value_error(format!("the probability must be above 0 and below 1, not {mass}")));
        }
        let mapper = &self.mapper;
        let (low, high): (Vec<f64>, Vec<f64>) = py
            .detach(|| (0..mapper.frame().len()).map(|index| mapper.credible_interval(index, mass)).unzip());
        Ok((grid(py, mapper.frame(), low)?, grid(py, mapper.frame(), high)?))
    }

    /// The probability that each cell is blocked now; 0.5 where unknown.
    fn blocked_probability<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.array(py, mapper::Mapper::blocked_probability)
    }

    /// The probability that each cell changed since it was last seen.
    fn change_probability<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.array(py, mapper::Mapper::change_probability)
    }

    /// The time since each cell was last seen, s; a cell that was never seen counts as seen at time 0.
    fn recency<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.array(py, mapper::Mapper::recency)
    }

    /// Whether each cell was ever seen.
    fn seen<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        self.array(py, mapper::Mapper::was_ever_seen)
    }

    /// Whether each cell can be a goal of an explorer: it is free, or beside a free cell.
    fn candidates<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        self.array(py, mapper::Mapper::is_candidate)
    }

    /// What was observed of every cell, by name: watched_free and watched_blocked (s in view), block_events and
    /// free_events (changes in view), block_events_after_gap and free_events_after_gap.
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let statistics = PyDict::new(py);
        let times: [Figure<f64>; 2] =
            [("watched_free", |of| of.watched_free), ("watched_blocked", |of| of.watched_blocked)];
        for (name, time) in times {
            statistics.set_item(name, self.array(py, |map, cell| time(&map.statistics(cell)))?)?;
        }
        let counts: [Figure<u32>; 4] = [
            ("block_events", |of| of.block_events),
            ("free_events", |of| of.free_events),
            ("block_events_after_gap", |of| of.block_events_after_gap),
            ("free_events_after_gap", |of| of.free_events_after_gap),
        ];
        for (name, count) in counts {
            statistics.set_item(name, self.array(py, |map, cell| count(&map.statistics(cell)))?)?;
        }
        Ok(statistics)
    }

    /// The changes of cells in the last update, shape (changes, 4), int32: row, column, state before, state after.
    fn changes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i32>>> {
        let row = |change: &Transition| {
            let [before, after] = [change.before, change.after].map(|state| state_number(state).into());
            [change.cell.y, change.cell.x, before, after]
        };
        rows_array(py, self.mapper.transitions().iter().map(row))
    }

    /// The end points of the last scan, shape (points, 2), m.
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows_array(py, self.mapper.points().iter().map(|point| [point.x, point.y]))
    }

    /// Everything that was learned, as bytes.
    fn snapshot<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let mapper = &mut self.mapper;
        SNAPSHOT.seal(py, &py.detach(|| mapper.snapshot()))
    }

    /// Returns to the snapshot of a map with the same cells and settings. `SnapshotError`: the bytes are not one;
    /// nothing changes then.
    fn restore(&mut self, py: Python<'_>, snapshot: &[u8]) -> PyResult<()> {
        let mut restored = self.mapper.clone();
        let state = SNAPSHOT.open(snapshot, true)?;
        py.detach(|| restored.restore(state)).map_err(|_| {
            SnapshotError::new_err("the snapshot was taken of a map with other cells or another estimator")
        })?;
        self.mapper = restored;
        Ok(())
    }

    fn __repr__(&self) -> String {
        let (rows, columns) = self.size();
        let (cell, readings) = (self.cell(), self.mapper.readings());
        format!("<curious.Mapper: {rows} x {columns} cells of {cell} m, {readings} readings>")
    }
}
