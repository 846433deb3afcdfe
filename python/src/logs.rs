use crate::convert::{from_json, log_error, pose_values, rows_array, state_number, value_error};
use crate::mapper::Mapper;
use crate::reading::Reading;
use crate::settings::mapper_settings;
use crate::threads::on_threads;
use ::logs::{LogSummary, TopicChoice};
use interfaces::PoseMode;
use localizer::{PoseState, TrajectoryPose};
use numpy::PyArray2;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use survey::{LogEntry, Quality, SurveySettings, Verdict};

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

/// What `map_log` has learned.
#[pyclass(frozen, module = "curious")]
pub(crate) struct Survey {
    mapper: mapper::Mapper,
    places: Vec<survey::Place>,
    poses: Vec<TrajectoryPose>,
    permanent: interfaces::Grid<interfaces::CellState>,
    quality: Quality,
}

/// Maps a log, and learns where the place changes: the program `map_log` for one log. The log is read twice: the
/// first pass finds the trajectory, the second one learns the changes.
///
/// `pose`: "localized" (the trajectory is found from scans and odometry), "odometry", "exact", "corrected" (of a log that was opened
/// with `corrected = True`); by default "corrected" for such a log, "exact" where the laser stands, otherwise "localized".
/// `cell`: m. `max_range`: a longer range shows free space up to this one, m.
#[pyfunction]
#[pyo3(signature = (log, *, pose = None, cell = 0.05, max_range = 20.0, estimator = None, range_noise = None))]
pub(crate) fn map_log(
    py: Python<'_>,
    log: &Log,
    pose: Option<&str>,
    cell: f64,
    max_range: f64,
    estimator: Option<&str>,
    range_noise: Option<f64>,
) -> PyResult<Survey> {
    let other =
        |name| value_error(format!("`pose` is localized, odometry, exact or corrected, and not {name:?}"));
    let mode = match pose {
        Some(name) => PoseMode::named(name).ok_or_else(|| other(name))?,
        None if log.is_corrected => PoseMode::Corrected,
        None if log.stands => PoseMode::Exact,
        None => PoseMode::Localized,
    };
    if log.is_corrected && matches!(mode, PoseMode::Exact | PoseMode::Odometry) {
        return Err(value_error(format!(
            "the log has corrected poses: `pose` = {:?} needs those of the odometry",
            mode.name()
        )));
    }
    if mode == PoseMode::Corrected && !log.is_corrected {
        return Err(value_error(
            "`pose` = \"corrected\" needs a log that was opened with `corrected = True`",
        ));
    }
    let mut settings = SurveySettings { resolution_m: cell, ..SurveySettings::of(mode) };
    settings.filter.max_range_m = max_range;
    settings.mapper = mapper_settings(settings.mapper, estimator, None, None, range_noise)?;
    on_threads(py, 0, || learn(&log.log, settings, range_noise.is_none()))?
}

/// A signal of the user, which is looked for once in many readings.
#[derive(Default)]
struct Signal(Option<PyErr>);

impl Signal {
    fn check(&mut self, readings: usize) -> ControlFlow<()> {
        if readings.is_multiple_of(256) {
            self.0 = Python::attach(|py| py.check_signals()).err();
        }
        if self.0.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// The result of a pass that the signal may have ended.
    fn or<T>(&mut self, result: Result<T, survey::SurveyError>) -> PyResult<T> {
        match self.0.take() {
            Some(signal) => Err(signal),
            None => result.map_err(value_error),
        }
    }
}

fn learn(log: &::logs::Log, settings: SurveySettings, learns_noise: bool) -> PyResult<Survey> {
    let mut signal = Signal::default();
    let entry = LogEntry::of(String::new(), log, &TopicChoice::default()).map_err(value_error)?;
    let mut survey = survey::Survey::new(settings, learns_noise);
    let found = survey.first_pass(log, entry, false, |(_, readings)| signal.check(readings));
    signal.or(found)?;
    let replay = survey.replay(0, log).map_err(value_error)?;
    let changed = || value_error("the log has changed since the first pass");
    let mut replay = replay.ok_or_else(changed)?;
    while survey.turn(&mut replay).map_err(value_error)?.is_some()
        && signal.check(survey.logs()[0].used).is_continue()
    {}
    signal.or(Ok(()))?;
    let mapper = survey.mapper().ok_or_else(changed)?.clone();
    let (mut places, permanent) = (survey.places(), survey::permanent(&mapper));
    let quality = survey.logs()[0].quality.clone();
    if !log.summary().has_times || quality.verdict() == Verdict::NotUsable {
        places.iter_mut().for_each(|place| place.rates = None);
    }
    Ok(Survey { mapper, places, poses: survey.logs()[0].poses().collect(), permanent, quality })
}

#[pymethods]
impl Survey {
    /// The map, and what was learned about its cells.
    #[getter]
    fn mapper(&self) -> Mapper {
        Mapper { mapper: self.mapper.clone() }
    }

    /// The trajectory, shape (readings, 4): time (s), x (m), y (m), heading (rad).
    #[getter]
    fn trajectory<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let row = |found: &TrajectoryPose| {
            let [x, y, heading] = pose_values(&found.pose);
            [found.time_s, x, y, heading]
        };
        rows_array(py, self.poses.iter().map(row))
    }

    /// What the map is good for, judged by its own scans: "good", "usable with care" or "not usable". The places of a map that is
    /// not usable have no rates.
    #[getter]
    fn verdict(&self) -> &'static str {
        self.quality.verdict().name()
    }

    /// Why the map is not good, in sentences; empty if it is.
    #[getter]
    fn reasons(&self) -> Vec<String> {
        self.quality.reasons()
    }

    /// Whether each pose of the trajectory is certain.
    #[getter]
    fn certain(&self) -> Vec<bool> {
        self.poses.iter().map(|found| found.state == PoseState::Tracking).collect()
    }

    /// The map of what is permanent, int8: -1 unknown, 0 free, 1 blocked.
    #[getter]
    fn permanent<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i8>>> {
        let states = self.permanent.cells().iter().map(|state| state_number(*state)).collect();
        crate::convert::grid(py, self.permanent.frame(), states)
    }

    /// The places where something changes, the liveliest first, each a dict with the keys of `places.json`. Where the times of the
    /// log, or the map, are unusable, it has no rates: no key from cycles_per_hour to last_change_s.
    #[getter]
    fn places<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        from_json(py, &self.places)
    }

    fn __repr__(&self) -> String {
        format!("<curious.Survey: {} places that change>", self.places.len())
    }
}
