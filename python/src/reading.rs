use crate::convert::{Numbers, Ranges, pose, pose_array, pose_values, rows_array};
use interfaces::{LaserReading, Scan, Twist};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

/// A laser scan, and the pose of the robot at the same time.
///
/// `ranges` has one value per beam, m: +inf no return, -inf too close, NaN invalid (REP-117). The direction of beam
/// `i` in the frame of the laser is `angle_min + i * angle_increment` (rad).
#[pyclass(frozen, module = "curious")]
pub(crate) struct Reading {
    pub(crate) reading: LaserReading,
}

impl Reading {
    pub(crate) fn of(reading: LaserReading) -> Self {
        Self { reading }
    }
}

#[pymethods]
impl Reading {
    /// A reading of your own: see `Mapper.update` for the arguments.
    #[new]
    #[pyo3(signature = (time, ranges, pose, *, angle_min = -std::f64::consts::PI, angle_increment = None,
        range_min = 0.0, range_max = 10.0, mount = None, sweep = 0.0, velocity = [0.0, 0.0]))]
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn new(
        time: f64,
        ranges: Ranges,
        pose: Numbers,
        angle_min: f64,
        angle_increment: Option<f64>,
        range_min: f64,
        range_max: f64,
        mount: Option<Numbers>,
        sweep: f64,
        velocity: [f64; 2],
    ) -> PyResult<Self> {
        let ranges_m = ranges.0;
        // By default the beams cover a full turn.
        let full_turn = || std::f64::consts::TAU / ranges_m.len().max(1) as f64;
        let [linear_mps, angular_radps] = velocity;
        Ok(Self::of(LaserReading {
            time_s: time,
            pose: self::pose(&pose)?,
            twist: Twist { linear_mps, angular_radps },
            velocities: Vec::new(),
            mount: mount.as_ref().map(self::pose).transpose()?.unwrap_or_default(),
            scan: Scan {
                angle_min_rad: angle_min,
                angle_increment_rad: angle_increment.unwrap_or_else(full_turn),
                range_min_m: range_min,
                range_max_m: range_max,
                sweep_s: sweep,
                ranges_m,
            },
        }))
    }

    /// The time, s.
    #[getter]
    fn time(&self) -> f64 {
        self.reading.time_s
    }

    /// The ranges, m, shape (beams,), float32.
    #[getter]
    fn ranges<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, &self.reading.scan.ranges_m)
    }

    /// The pose of the robot by odometry: x (m), y (m), heading (rad).
    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        pose_array(py, &self.reading.pose)
    }

    /// Linear (m/s) and angular (rad/s) velocity by odometry.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &[self.reading.twist.linear_mps, self.reading.twist.angular_radps])
    }

    /// The pose of the laser in the frame of the robot: x (m), y (m), heading (rad).
    #[getter]
    fn mount<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        pose_array(py, &self.reading.mount)
    }

    /// The direction of the first beam, rad.
    #[getter]
    fn angle_min(&self) -> f64 {
        self.reading.scan.angle_min_rad
    }

    /// The angle between two beams, rad.
    #[getter]
    fn angle_increment(&self) -> f64 {
        self.reading.scan.angle_increment_rad
    }

    /// The minimum range, m.
    #[getter]
    fn range_min(&self) -> f64 {
        self.reading.scan.range_min_m
    }

    /// The maximum range, m.
    #[getter]
    fn range_max(&self) -> f64 {
        self.reading.scan.range_max_m
    }

    /// The time from the first to the last beam, s.
    #[getter]
    fn sweep(&self) -> f64 {
        self.reading.scan.sweep_s
    }

    /// The end points of the beams that hit something, in the frame of the pose, shape (points, 2), m.
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = self.reading.hits().map(|hit| self.reading.pose * hit);
        rows_array(py, points.map(|point| [point.x, point.y]))
    }

    fn __repr__(&self) -> String {
        let [x, y, heading] = pose_values(&self.reading.pose);
        let (time, beams) = (self.reading.time_s, self.reading.scan.ranges_m.len());
        format!("<curious.Reading at {time:.3} s: {beams} beams from [{x:.3}, {y:.3}, {heading:.3}]>")
    }
}
