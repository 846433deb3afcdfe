use crate::convert::{Numbers, pose_array, rows_array, value_error};
use crate::mapper::Mapper;
use crate::reading::Reading;
use localizer::{Localized, LocalizerSettings, PoseEstimate, PoseState, Start};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

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
#[pyclass(frozen, get_all, module = "curious")]
pub(crate) struct Estimate {
    /// The pose: x (m), y (m), heading (rad).
    pose: Py<PyArray1<f64>>,
    /// The covariance of x, y (m²) and heading (rad²), shape (3, 3).
    covariance: Py<PyArray2<f64>>,
    /// "tracking", "uncertain" or "lost".
    state: &'static str,
    /// Whether the reading may enter a map.
    is_certain: bool,
    /// The share of the seen surface that lies on known surfaces, from 0 to 1.
    support: f64,
    /// The reading at this pose; all of its beams belong to the pose.
    reading: Py<Reading>,
}

#[pymethods]
impl Localizer {
    /// A localizer for a map (`Mapper`). With `pose`: the first reading is there, and the place need not be known.
    /// Without: anywhere in the known map. `range_noise`: the standard deviation of a range, m.
    #[new]
    #[pyo3(signature = (mapper, pose = None, *, range_noise = 0.01))]
    fn new(py: Python<'_>, mapper: &Mapper, pose: Option<Numbers>, range_noise: f64) -> PyResult<Self> {
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
    fn localize(&mut self, py: Python<'_>, reading: &Reading, mapper: &Mapper) -> PyResult<Estimate> {
        let (localizer, map) = (&mut self.localizer, &mapper.mapper);
        let Localized { estimate, reading } = py.detach(|| localizer.localize(&reading.reading, map));
        let PoseEstimate { pose, covariance, support, state } = estimate;
        let rows: [[f64; 3]; 3] = covariance.transpose().into();
        Ok(Estimate {
            pose: pose_array(py, &pose).unbind(),
            covariance: rows_array(py, rows)?.unbind(),
            state: match state {
                PoseState::Tracking => "tracking",
                PoseState::Uncertain => "uncertain",
                PoseState::Lost => "lost",
            },
            is_certain: state == PoseState::Tracking,
            support,
            reading: Py::new(py, Reading::of(reading))?,
        })
    }

    /// Begins another session in the same place, at a pose that is not known.
    fn begin_session(&mut self) {
        self.localizer.begin_session();
    }
}

#[pymethods]
impl Estimate {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let [x, y, heading]: [f64; 3] = self.pose.extract(py)?;
        Ok(format!("<curious.Estimate [{x:.3}, {y:.3}, {heading:.3}] {}>", self.state))
    }
}
