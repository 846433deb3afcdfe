//! Errors and arrays.

use interfaces::{CellState, GridFrame, heading_rad, printable_lines};
use nalgebra::Isometry2;
use numpy::{
    AllowTypeChange, Element, IntoPyArray, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayLike1,
    PyArrayLikeDyn, PyArrayMethods, PyReadwriteArrayDyn, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{
    PyFileNotFoundError, PyIndexError, PyOverflowError, PyTypeError, PyUserWarning, PyValueError,
};
use pyo3::prelude::*;
use serde::Serialize;
use std::ffi::CString;
use std::fmt::Display;
use worldfile::shipped::LoadError;

pyo3::create_exception!(
    curious,
    WorldError,
    PyValueError,
    "The error for a world that is invalid, with the message of the command line: file, line, key, a valid value."
);
pyo3::create_exception!(
    curious,
    SnapshotError,
    PyValueError,
    "The error for bytes that are not a snapshot of the same world, or are damaged."
);

/// The index of a robot, an environment or an agent, for `from_py_with`.
pub(crate) fn index(object: &Bound<'_, PyAny>) -> PyResult<usize> {
    object.extract().map_err(|error: PyErr| {
        let is_no_index = error.is_instance_of::<PyOverflowError>(object.py());
        let of_index =
            || PyIndexError::new_err(format!("an index is counted from 0, and cannot be {object}"));
        if is_no_index { of_index() } else { error }
    })
}

/// An index that need not be given.
pub(crate) fn optional_index(object: &Bound<'_, PyAny>) -> PyResult<Option<usize>> {
    if object.is_none() { Ok(None) } else { index(object).map(Some) }
}

/// A seed or a number of things, for `from_py_with`.
pub(crate) fn whole<'py, T>(object: &Bound<'py, PyAny>) -> PyResult<T>
where
    T: for<'a> FromPyObject<'a, 'py, Error = PyErr>,
{
    object.extract().map_err(|error: PyErr| {
        // A number that an integer of Rust cannot hold is out of range, as for any other range.
        let of_range =
            || value_error(format!("a whole number from 0 to 2^64 - 1 is needed, and not {object}"));
        if error.is_instance_of::<PyOverflowError>(object.py()) { of_range() } else { error }
    })
}

/// Numbers with one dimension, as a list, a tuple or an array of any type.
pub(crate) struct Row<T>(pub(crate) Vec<T>);
pub(crate) type Numbers = Row<f64>;
/// Ranges of a scan.
pub(crate) type Ranges = Row<f32>;

impl<'a, 'py, T: Element + Copy> FromPyObject<'a, 'py> for Row<T>
where
    PyArrayLike1<'py, T, AllowTypeChange>: FromPyObject<'a, 'py, Error = PyErr>,
{
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        check_real(&object)?;
        let row: PyResult<PyArrayLike1<'py, T, AllowTypeChange>> = object.extract();
        let row = row.map_err(|error| {
            // The message about dimensions of the crate `numpy` is not a sentence.
            if error.is_instance_of::<PyTypeError>(object.py()) {
                PyTypeError::new_err(format!("one row of numbers is needed, and not {}", described(&object)))
            } else {
                error
            }
        });
        Ok(Self(row?.as_array().iter().copied().collect()))
    }
}

/// Numbers with any number of dimensions, as lists, tuples or an array of any type.
pub(crate) struct Table<'py>(pub(crate) PyArrayLikeDyn<'py, f64, AllowTypeChange>);

impl<'a, 'py> FromPyObject<'a, 'py> for Table<'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        check_real(&object)?;
        object.extract().map(Self)
    }
}

/// NumPy would drop the imaginary parts of an array, with a warning.
fn check_real(object: &Bound<'_, PyAny>) -> PyResult<()> {
    match object.cast::<PyUntypedArray>() {
        Ok(array) if array.dtype().kind() == b'c' => {
            Err(PyTypeError::new_err(format!("real numbers are needed, and not {}", described(object))))
        }
        _ => Ok(()),
    }
}

/// The type of an object; of an array also its shape and the type of its values.
pub(crate) fn described(object: &Bound<'_, PyAny>) -> String {
    let array = object.cast::<PyUntypedArray>();
    let kind = || object.get_type().name().map_or_else(|_| "that".to_owned(), |name| name.to_string());
    array.map_or_else(
        |_| kind(),
        |array| format!("an array of {} of shape {:?}", array.dtype(), array.shape()),
    )
}

/// An array that is written to.
pub(crate) fn writable<'py, T: Element>(
    object: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<PyReadwriteArrayDyn<'py, T>> {
    object.extract().map_err(|_| {
        let found = described(object);
        let own = T::get_dtype(object.py());
        PyTypeError::new_err(format!(
            "`{name}` must be a writable array of {own} that is no other argument, and not {found}"
        ))
    })
}

/// A message: it holds names and values from files.
fn message(error: impl Display) -> String {
    printable_lines(&error.to_string()).into_owned()
}

/// A `ValueError` with the message of an error.
pub(crate) fn value_error(error: impl Display) -> PyErr {
    PyValueError::new_err(message(error))
}

/// A `WorldError` with the message of an error.
pub(crate) fn world_error(error: impl Display) -> PyErr {
    WorldError::new_err(message(error))
}

/// The error for a world that cannot be loaded.
pub(crate) fn load_error(error: LoadError) -> PyErr {
    match error {
        LoadError::Unknown { .. } => PyFileNotFoundError::new_err(message(error)),
        LoadError::OtherKind { name, kind, .. } => {
            world_error(format!("`{name}` is a {kind} world: the program `grid_world` runs it"))
        }
        other => world_error(other),
    }
}

/// A `SnapshotError` with the message of an error.
pub(crate) fn snapshot_error(error: impl Display) -> PyErr {
    SnapshotError::new_err(message(error))
}

/// The error for a log: an `OSError` of the fitting kind if the file cannot be read.
pub(crate) fn log_error(path: &std::path::Path, error: logs::LogError) -> PyErr {
    match error {
        logs::LogError::Io { why, .. } if why.kind() == std::io::ErrorKind::NotFound => {
            PyFileNotFoundError::new_err(format!("there is no log `{}`", path.display()))
        }
        logs::LogError::Io { .. } => pyo3::exceptions::PyOSError::new_err(message(error)),
        other => value_error(other),
    }
}

/// The error for a robot that does not exist.
pub(crate) fn no_robot(robot: usize, robots: usize) -> PyErr {
    PyIndexError::new_err(format!("there is no robot {robot}: there are {robots}, counted from 0"))
}

/// Three numbers, finite: x and y (m), heading (rad).
pub(crate) fn pose(Row(values): &Numbers) -> PyResult<Isometry2<f64>> {
    match values[..] {
        [x, y, heading] if values.iter().all(|value| value.is_finite()) => {
            Ok(interfaces::pose(x, y, heading))
        }
        [_, _, _] => Err(value_error(format!("a pose is finite, and not {values:?}"))),
        _ => Err(value_error(format!(
            "a pose is [x, y, heading] (m, m, rad), and not {} numbers",
            values.len()
        ))),
    }
}

/// A pose as x and y (m), heading (rad).
pub(crate) fn pose_values(pose: &Isometry2<f64>) -> [f64; 3] {
    [pose.translation.x, pose.translation.y, heading_rad(pose)]
}

/// A pose as an array.
pub(crate) fn pose_array<'py>(py: Python<'py>, pose: &Isometry2<f64>) -> Bound<'py, PyArray1<f64>> {
    pose_values(pose).to_vec().into_pyarray(py)
}

/// Rows as an array.
pub(crate) fn rows_array<'py, T: Element, const COLUMNS: usize>(
    py: Python<'py>,
    rows: impl IntoIterator<Item = [T; COLUMNS]>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let values: Vec<T> = rows.into_iter().flatten().collect();
    let count = values.len() / COLUMNS;
    values.into_pyarray(py).reshape([count, COLUMNS])
}

/// A value by its JSON: dicts, lists, texts, numbers and None.
pub(crate) fn from_json<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(value_error)?;
    py.import("json")?.call_method1("loads", (text,))
}

/// A warning of Python.
pub(crate) fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    let message = CString::new(message(text))?; // without a zero byte, which no C string can have
    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, 2)
}

/// One value per cell as an array of rows; row 0 has the lowest y.
pub(crate) fn grid<'py, T: numpy::Element>(
    py: Python<'py>,
    frame: &GridFrame,
    values: Vec<T>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    values.into_pyarray(py).reshape([frame.height(), frame.width()])
}

/// The state of a cell as a number.
pub(crate) fn state_number(state: CellState) -> i8 {
    match state {
        CellState::Unknown => -1,
        CellState::Free => 0,
        CellState::Blocked => 1,
    }
}
