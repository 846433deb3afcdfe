use crate::convert::{grid, load_error, warn, whole, world_error};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use sim::grid::GenerateSettings;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use worldfile::{Disk, Files, MAX_TEXT_BYTES, shipped};

/// The specification of a grid world: walls, blocks that move from cell to cell, and a robot with a sensor, as in figure 3
/// of the paper. `trial` runs it. It never changes, and can be pickled.
#[pyclass(frozen, module = "curious")]
pub(crate) struct GridSpec {
    pub(crate) spec: Arc<sim::grid::GridSpec>,
}

impl GridSpec {
    /// What is odd about a world is a warning of Python.
    fn new(py: Python<'_>, spec: sim::grid::GridSpec) -> PyResult<Self> {
        for warning in spec.warnings() {
            warn(py, &format!("{}: {warning}", spec.name))?;
        }
        Ok(Self { spec: Arc::new(spec) })
    }

    /// Whether this is the name of a shipped grid world, or the path of the file of a grid world.
    pub(crate) fn is_named(name: &Path) -> bool {
        let is_text_of_grid =
            |bytes: Vec<u8>| String::from_utf8(bytes).is_ok_and(|text| worldfile::grid::is_grid_world(&text));
        shipped::GRID.iter().any(|(shipped, _)| name == Path::new(shipped))
            || Disk.read(name, MAX_TEXT_BYTES).is_ok_and(is_text_of_grid)
    }
}

#[pymethods]
impl GridSpec {
    /// The shipped grid world with this name, or the file of a grid world (TOML) with this path.
    #[staticmethod]
    pub(crate) fn load(py: Python<'_>, name: PathBuf) -> PyResult<Self> {
        Self::new(py, shipped::load_grid(&name.to_string_lossy()).map_err(load_error)?)
    }

    /// The grid world of a text in TOML. `name` is the name of the file in messages.
    #[staticmethod]
    #[pyo3(signature = (text, name = "world.toml"))]
    fn from_toml(py: Python<'_>, text: &str, name: &str) -> PyResult<Self> {
        Self::new(py, worldfile::grid::parse(name, text).map_err(world_error)?)
    }

    /// The generated grid world of a seed, as those of `grid_world --generate`. The same seed gives the same world.
    #[staticmethod]
    fn generate(py: Python<'_>, #[pyo3(from_py_with = whole)] seed: u64) -> PyResult<Self> {
        Self::new(py, sim::grid::GridSpec::generate(&GenerateSettings::default(), seed))
    }

    /// The names of the grid worlds that are part of the package.
    #[staticmethod]
    fn shipped() -> Vec<&'static str> {
        shipped::GRID.iter().map(|(name, _)| *name).collect()
    }

    /// The name of the world.
    #[getter]
    fn name(&self) -> &str {
        &self.spec.name
    }

    /// What the world is for.
    #[getter]
    fn description(&self) -> &str {
        &self.spec.description
    }

    /// The number of rows and columns.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.spec.frame().height(), self.spec.frame().width())
    }

    /// The range of the sensor, cells.
    #[getter]
    fn sensor_radius(&self) -> u32 {
        self.spec.sensor_radius
    }

    /// Which cells are walls, shape (rows, columns), bool.
    #[getter]
    fn walls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        grid(py, self.spec.frame(), self.spec.walls.cells().to_vec())
    }

    /// The world as the text of a world file.
    fn to_toml(&self) -> String {
        worldfile::grid::to_toml(&self.spec)
    }

    /// A spec never changes: a copy is the same object.
    fn __copy__(this: Bound<'_, Self>) -> Bound<'_, Self> {
        this
    }

    fn __deepcopy__<'py>(this: Bound<'py, Self>, _memo: &Bound<'py, PyAny>) -> Bound<'py, Self> {
        this
    }

    /// For pickle: the text of the world.
    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let text = this.get().to_toml();
        Ok((this.get_type().getattr("from_toml")?, (text,).into_pyobject(this.py())?))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.spec == other.spec
    }

    fn __repr__(&self) -> String {
        let ((rows, columns), blocks) = (self.shape(), self.spec.blocks.len());
        format!("<curious.GridSpec {:?}: {rows} rows, {columns} columns, {blocks} blocks>", self.spec.name)
    }
}
