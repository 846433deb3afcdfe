use crate::convert::{Numbers, SnapshotError, pose_array, value_error};
use crate::mapper::Mapper;
use crate::reading::Reading;
use crate::snapshots::Kind;
use localizer::{LocalizerSettings, PoseState, Start};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// Odometry, scans and a map that changes: the pose of the robot, with its uncertainty.
///
/// >>> localizer = curious.Localizer(mapper, pose=[2.0, 2.0, 0.0])
/// >>> estimate = localizer.localize(reading, mapper)
/// >>> if estimate.is_certain:
/// ...     mapper.update_reading(estimate.reading)
/// ... else:
/// ...     mapper.skip(estimate.reading)
#[pyclass(module = "curious")]
pub(crate) struct Localizer {
    localizer: localizer::Localizer,
}

/// A pose with its uncertainty.
#[pyclass(frozen, module = "curious")]
pub(crate) struct Estimate {
    localized: localizer::Localized,
}

const SNAPSHOT: Kind = Kind("localizer");

#[pymethods]
impl Localizer {
    /// A localizer for a map (`Mapper`). With `pose`: the first reading is there, and the place need not be known.
    /// Without: anywhere in the known map. `range_noise`: the standard deviation of a range, m.
    #[new]
    #[pyo3(signature = (mapper, pose = None, *, range_noise = 0.01))]
    fn new(py: Python<'_>, mapper: &Mapper, pose: Option<Numbers<'_>>, range_noise: f64) -> PyResult<Self> {
        let settings = LocalizerSettings { range_noise_std_m: range_noise, ..LocalizerSettings::default() };
        let (map, start) = (mapper.mapper.states(), pose.as_ref().map(crate::convert::pose).transpose()?);
        let is_empty = mapper.mapper.readings() == 0;
        let localizer = py.detach(|| match start {
            Some(start) if is_empty => localizer::Localizer::from_nothing(&settings, map.frame(), start),
            Some(start) => localizer::Localizer::in_map(&settings, map, Start::At(start)),
            None => localizer::Localizer::in_map(&settings, map, Start::Unknown),
        });
        Ok(Self { localizer: localizer.map_err(value_error)? })
    }

    /// The pose of a reading, whose own pose is that of the odometry. `mapper` has learned the readings so far whose
    /// pose was certain. An invalid reading is no error: its estimate is the prediction, and not certain.
    fn localize(&mut self, py: Python<'_>, reading: &Reading, mapper: &Mapper) -> Estimate {
        let (localizer, map) = (&mut self.localizer, &mapper.mapper);
        Estimate { localized: py.detach(|| localizer.localize(&reading.reading, map)) }
    }

    /// Begins another session in the same place, at a pose that is not known.
    fn begin_session(&mut self) {
        self.localizer.begin_session();
    }

    /// Everything that readings have changed, as bytes.
    fn snapshot<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyBytes> {
        SNAPSHOT.seal(py, &self.localizer.snapshot())
    }

    /// Returns to the snapshot of a localizer with the same settings. `SnapshotError`: the bytes are not one; nothing
    /// changes then.
    fn restore(&mut self, snapshot: &[u8]) -> PyResult<()> {
        let (state, before) = (SNAPSHOT.open(snapshot)?, self.localizer.snapshot());
        self.localizer.restore(state).map_err(|_| {
            let was_restored = self.localizer.restore(&before);
            debug_assert!(was_restored.is_ok(), "a localizer takes its own snapshot");
            SnapshotError::new_err("the snapshot was taken of a localizer with another map or other settings")
        })
    }
}

#[pymethods]
impl Estimate {
    /// The pose: x (m), y (m), heading (rad).
    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        pose_array(py, &self.localized.estimate.pose)
    }

    /// The covariance of x, y (m²) and heading (rad²), shape (3, 3).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let values: Vec<f64> = self.localized.estimate.covariance.transpose().iter().copied().collect();
        values.into_pyarray(py).reshape([3, 3])
    }

    /// "tracking", "uncertain" or "lost".
    #[getter]
    fn state(&self) -> &'static str {
        match self.localized.estimate.state {
            PoseState::Tracking => "tracking",
            PoseState::Uncertain => "uncertain",
            PoseState::Lost => "lost",
        }
    }

    /// Whether the reading may enter a map.
    #[getter]
    fn is_certain(&self) -> bool {
        self.localized.estimate.state == PoseState::Tracking
    }

    /// The share of the seen surface that lies on known surfaces, from 0 to 1.
    #[getter]
    fn support(&self) -> f64 {
        self.localized.estimate.support
    }

    /// The reading at this pose; all of its beams belong to the pose.
    #[getter]
    fn reading(&self) -> Reading {
        Reading::of(self.localized.reading.clone())
    }

    fn __repr__(&self) -> String {
        let [x, y, heading] = crate::convert::pose_values(&self.localized.estimate.pose);
        format!("<curious.Estimate [{x:.3}, {y:.3}, {heading:.3}] {}>", self.state())
    }
}
