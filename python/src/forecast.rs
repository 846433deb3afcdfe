use crate::convert::{grid, value_error};
use mapper::Calendar;
use nalgebra::Point2;
use numpy::PyArray2;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use robot::state::{StateError, read_state};
use std::path::PathBuf;

/// A place as it will be, from a state file of `map_log --state`: the program `predict`.
///
/// Times are `datetime` objects with a time zone, or seconds since 1970 (since the first reading, where `zone` is None: such a
/// place has no hours).
#[pyclass(frozen, module = "curious")]
pub(crate) struct Forecast {
    forecast: survey::Forecast,
}

type Mask<'py> = Bound<'py, PyArray2<u8>>;

impl Forecast {
    /// A time as seconds: a number, or an object with the method `timestamp`, as a `datetime`. `ValueError`: it is NaN, or
    /// the place has no hours and knows no `datetime`.
    fn seconds(&self, time: &Bound<'_, PyAny>) -> PyResult<f64> {
        let time_s: f64 = match time.extract() {
            Ok(time_s) => time_s,
            Err(_) => {
                let time_s = time.call_method0("timestamp")?.extract()?;
                if let Some(why) = self.forecast.why_undated() {
                    return Err(value_error(format!(
                        "the state knows no hours ({why}): give a time in seconds, as `now`, which is {}",
                        self.now()
                    )));
                }
                time_s
            }
        };
        if time_s.is_nan() {
            Err(value_error("the time is NaN; it must be a number of seconds"))
        } else {
            Ok(time_s)
        }
    }
}

#[pymethods]
impl Forecast {
    /// Opens a state file. `OSError`: it cannot be read; `ValueError`: it is no state of this program.
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let name = path.display().to_string();
        let state = py.detach(|| read_state(&path)).map_err(|why| match why {
            StateError::Read(why) => PyOSError::new_err(format!("{name}: {why}")),
            why => value_error(format!("{name}: {why}")),
        })?;
        let forecast = py.detach(|| survey::Forecast::of_state(&state));
        forecast.map(|forecast| Self { forecast }).map_err(|why| value_error(format!("{name}: {why}")))
    }

    /// The time of the last reading, s.
    #[getter]
    fn now(&self) -> f64 {
        self.forecast.now_s()
    }

    /// The time zone of the place, by its IANA name; None if its times have no hours.
    #[getter]
    fn zone(&self) -> Option<String> {
        match self.forecast.mapper().calendar() {
            Calendar::Zone(zone) if self.forecast.why_undated().is_none() => {
                zone.iana_name().map(str::to_owned)
            }
            _ => None,
        }
    }

    /// The map, and what was learned about its cells.
    #[getter]
    fn mapper(&self) -> crate::mapper::Mapper {
        crate::mapper::Mapper { mapper: self.forecast.mapper().clone() }
    }

    /// The probability that each cell is blocked at a time, shape (rows, columns); NaN where nothing was ever seen. A time
    /// before the last reading counts as that of the last reading.
    fn probability<'py>(
        &self,
        py: Python<'py>,
        time: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let time_s = self.seconds(time)?;
        let map = py.detach(|| self.forecast.map(time_s));
        grid(py, map.frame(), map.cells().to_vec())
    }

    /// The probability that the cell at a point (m) is blocked at a time; None where nothing was ever seen.
    fn at(&self, x: f64, y: f64, time: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
        let cell = self.forecast.mapper().frame().cell_at(&Point2::new(x, y));
        Ok(self.forecast.outlook().blocked(cell, self.seconds(time)?))
    }

    /// The doors that were found, a dict for each, with the number `id`, the ends of the `closed` leaf (m), `is_open` when last seen,
    /// at `last_seen` (s); `open_probability` at a time (that of the last reading by default) and the interval
    /// `open_probability_90` that contains the true one with 90 % (None before it was seen on 14 days); `openings_per_hour` and
    /// `openings_per_hour_90`; and `usual_hours`, tuples of the hour of the week (0 to 168), the 90 % interval of it, and whether
    /// the door is usually open from then on.
    #[pyo3(signature = (time=None))]
    fn doors<'py>(
        &self,
        py: Python<'py>,
        time: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let time_s = time.map_or(Ok(self.forecast.now_s()), |time| self.seconds(time))?;
        let (calendar, epoch_s) = (self.forecast.calendar(), self.forecast.mapper().epoch_s());
        let dict = |door: &mapper::Door| {
            let dict = PyDict::new(py);
            let week = door.clock.week(calendar);
            let changes = week.map(|week| week.usual_changes()).unwrap_or_default();
            let usual =
                changes.iter().map(|to| (to.hour, (to.earliest_hour, to.latest_hour), to.becomes_blocked));
            dict.set_item("id", door.id)?;
            dict.set_item("closed", door.closed.ends.map(|end| (end.x, end.y)))?;
            dict.set_item("is_open", door.is_open())?;
            dict.set_item("last_seen", epoch_s + door.last_seen_s())?;
            dict.set_item("open_probability", door.clock.probability(time_s, calendar))?;
            let interval = door.clock.interval_90(time_s, calendar);
            dict.set_item("open_probability_90", interval.map(|[low, high]| (low, high)))?;
            let (per_hour, [low, high]) = door.openings_per_hour();
            dict.set_item("openings_per_hour", per_hour)?;
            dict.set_item("openings_per_hour_90", (low, high))?;
            dict.set_item("usual_hours", usual.collect::<Vec<_>>())?;
            Ok(dict)
        };
        self.forecast.mapper().doors().iter().map(dict).collect()
    }

    /// The speed mask and the keepout mask of Nav2 at a time, 0 to 100, shape (rows, columns).
    fn masks<'py>(&self, py: Python<'py>, time: &Bound<'py, PyAny>) -> PyResult<(Mask<'py>, Mask<'py>)> {
        let time_s = self.seconds(time)?;
        let [speed, keepout] = py.detach(|| self.forecast.masks(time_s));
        let [speed, keepout] = [speed, keepout].map(|mask| grid(py, mask.frame(), mask.cells().to_vec()));
        Ok((speed?, keepout?))
    }

    /// For how long a look at each cell says more than its usual hours, s, shape (rows, columns); NaN where nothing ever
    /// changed, and where this is longer than four weeks.
    fn expiry<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let expiry = py.detach(|| self.forecast.outlook().expiry(f64::NAN));
        grid(py, expiry.frame(), expiry.cells().to_vec())
    }

    fn __repr__(&self) -> String {
        let frame = self.forecast.mapper().frame();
        let zone = self.zone().unwrap_or_else(|| "no hours".to_owned());
        format!("<curious.Forecast: {} x {} cells, {zone}>", frame.height(), frame.width())
    }
}
