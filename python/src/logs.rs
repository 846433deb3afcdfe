use crate::convert::{log_error, value_error};
use crate::reading::Reading;
use ::logs::{LogSummary, TopicChoice};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// A log of a robot: a CARMEN log (also with gzip), a bag of ROS 2 (MCAP or SQLite, a file or a folder).
///
/// Iterate over it for its readings. Their times are since the first one, their poses are those of the odometry.
#[pyclass(frozen, module = "curious")]
pub(crate) struct Log {
    log: ::logs::Log,
    /// Whether the poses are those of another SLAM.
    #[pyo3(get, name = "corrected")]
    is_corrected: bool,
    /// The time from the first to the last reading, s.
    #[pyo3(get)]
    duration: f64,
    /// The time of the first reading in seconds since 1970; None if the log does not say it.
    #[pyo3(get)]
    begin: Option<f64>,
    /// What was repaired or left out, each a sentence.
    #[pyo3(get)]
    notes: Vec<String>,
    /// Whether the laser stands: no pose of the log moves.
    #[pyo3(get)]
    stands: bool,
}

/// The readings of a log.
#[pyclass(module = "curious")]
pub(crate) struct Readings {
    readings: Mutex<::logs::Readings>,
}

#[pymethods]
impl Log {
    /// Opens a log. `scan_topics`, `odom_topic`, `base_frame`: for bags; by default all of them are found. `corrected`: the poses of
    /// the readings are those of another SLAM, in a bag those of tf from `map_frame` ("map") to the robot, in a CARMEN log those of
    /// the FLASER lines. `OSError`: it cannot be read; `ValueError`: it is damaged, or has no usable scan or no corrected poses.
    #[new]
    #[pyo3(signature = (path, *, scan_topics = Vec::new(), odom_topic = None, base_frame = None, corrected = false, map_frame = None))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        scan_topics: Vec<String>,
        odom_topic: Option<String>,
        base_frame: Option<String>,
        corrected: bool,
        map_frame: Option<String>,
    ) -> PyResult<Self> {
        if map_frame.is_some() && !corrected {
            return Err(value_error("`map_frame` names the map of another SLAM: it needs `corrected`"));
        }
        let choice = TopicChoice { scan_topics, odom_topic, base_frame, is_corrected: corrected, map_frame };
        let log = py.detach(|| ::logs::Log::open(&path, &choice)).map_err(|error| log_error(&path, error))?;
        let LogSummary { duration_s, begin_s, notes, odometry_poses, .. } = log.summary().clone();
        let stands = !corrected && odometry_poses == 0;
        Ok(Self { log, is_corrected: corrected, duration: duration_s, begin: begin_s, notes, stands })
    }

    fn __len__(&self) -> usize {
        self.log.summary().scans
    }

    fn __iter__(&self) -> PyResult<Readings> {
        Ok(Readings { readings: Mutex::new(self.log.readings().map_err(value_error)?) })
    }

    fn __repr__(&self) -> String {
        format!("<curious.Log: {} readings in {:.1} s>", self.__len__(), self.duration)
    }
}

#[pymethods]
impl Readings {
    fn __iter__(this: PyRef<'_, Self>) -> PyRef<'_, Self> {
        this
    }

    fn __next__(&mut self, py: Python<'_>) -> PyResult<Option<Reading>> {
        let readings = self.readings.get_mut().unwrap_or_else(PoisonError::into_inner);
        let next = py.detach(|| readings.next()).transpose().map_err(value_error)?;
        Ok(next.map(Reading::of))
    }
}
