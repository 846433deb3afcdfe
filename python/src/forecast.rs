use crate::convert::{grid, value_error};
use mapper::Calendar;
use nalgebra::Point2;
use numpy::PyArray2;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use robot::state::{LoadError, read_state};
use std::path::PathBuf;

/// A place as it will be, from a state file of `map_log --state`: the program `predict`.
///
/// Times are `datetime` objects with a time zone, or seconds since 1970 (since the first reading, where `zone` is None: such a
/// place has no hours).
#[pyclass(frozen, module = "curious")]
pub(crate) struct Forecast {
    forecast: survey::Forecast,
}

/// A time as seconds: a number, or an object with the method `timestamp`, as a `datetime`.
fn seconds(time: &Bound<'_, PyAny>) -> PyResult<f64> {
    match time.extract() {
        Ok(seconds) => Ok(seconds),
        Err(_) => time.call_method0("timestamp")?.extract(),
    }
}

#[pymethods]
impl Forecast {
    /// Opens a state file. `OSError`: it cannot be read; `ValueError`: it is no state of this program.
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let name = path.display().to_string();
        let state = py.detach(|| read_state(&path)).map_err(|why| match why {
            LoadError::Read(why) => PyOSError::new_err(format!("{name}: {why}")),
            LoadError::State(why) => value_error(format!("{name}: {why}")),
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
        let time_s = seconds(time)?;
        let map = py.detach(|| self.forecast.map(time_s));
        grid(py, map.frame(), map.cells().to_vec())
    }

    /// The probability that the cell at a point (m) is blocked at a time; None where nothing was ever seen.
    fn at(&self, x: f64, y: f64, time: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
        let cell = self.forecast.mapper().frame().cell_at(&Point2::new(x, y));
        Ok(self.forecast.blocked(cell, seconds(time)?))
    }

    /// For how long a look at each cell says more than its usual hours, s, shape (rows, columns); NaN where nothing ever
    /// changed, and where this is longer than four weeks.
    fn expiry<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let expiry = py.detach(|| self.forecast.expiry());
        grid(py, expiry.frame(), expiry.cells().to_vec())
    }

    fn __repr__(&self) -> String {
        let frame = self.forecast.mapper().frame();
        let zone = self.zone().unwrap_or_else(|| "no hours".to_owned());
        format!("<curious.Forecast: {} x {} cells, {zone}>", frame.height(), frame.width())
    }
}
