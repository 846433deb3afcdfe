use crate::convert::{load_error, world_error};
use numpy::{IntoPyArray, PyArray1, PyArray3, PyArrayMethods};
use pyo3::exceptions::{PyFileNotFoundError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use sim::physics::{FleetSpec, WorldSpec};
use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use worldfile::{Disk, Severity};

/// The specification of a world: walls, obstacles, robots. It never changes; fleets, worlds and tasks are made from it.
#[pyclass(frozen, module = "curious")]
pub(crate) struct Spec {
    pub(crate) fleet: Arc<FleetSpec>,
}

impl Spec {
    fn new(fleet: FleetSpec) -> Self {
        Self { fleet: Arc::new(fleet) }
    }

    /// The same world with exactly one driven robot: the only one, or the one with an index.
    pub(crate) fn driving(&self, robot: Option<usize>) -> PyResult<WorldSpec> {
        let fleet = (*self.fleet).clone();
        let robots = fleet.robots.len();
        match robot {
            None => WorldSpec::new(fleet).map_err(|error| {
                world_error(format!("the world `{}`: {error}; `robot` chooses one", self.fleet.name))
            }),
            Some(robot) => WorldSpec::driving(fleet, robot).ok_or_else(|| crate::convert::no_robot(robot, robots)),
        }
    }
}

/// A spec, or the name or the path of a world.
pub(crate) fn spec_of(py: Python<'_>, world: &Bound<'_, PyAny>) -> PyResult<Arc<FleetSpec>> {
    if let Ok(spec) = world.cast::<Spec>() {
        return Ok(Arc::clone(&spec.get().fleet));
    }
    let name: PathBuf = world.extract()?;
    Ok(Spec::load(py, name)?.fleet)
}

#[pymethods]
impl Spec {
    /// The shipped world with this name, or the world file (TOML) or Stage file (.world) with this path.
    #[staticmethod]
    pub(crate) fn load(py: Python<'_>, name: PathBuf) -> PyResult<Self> {
        if name.extension().is_some_and(|ending| ending == "world" || ending == "inc") {
            return Self::from_stage(py, name);
        }
        let shipped = name.to_str().filter(|name| worldfile::shipped::text(name).is_some());
        let is_driven_by_one = shipped.is_some() || !name.exists();
        if is_driven_by_one {
            let name = name.to_string_lossy();
            return Ok(Self::new(worldfile::shipped::load(&name).map_err(load_error)?.fleet().clone()));
        }
        let text = std::fs::read_to_string(&name)
            .map_err(|error| PyValueError::new_err(format!("cannot read the world file `{}`: {error}", name.display())))?;
        let fleet = worldfile::physics::parse_fleet_with(&name.to_string_lossy(), &text, &Disk);
        Ok(Self::new(fleet.map_err(world_error)?))
    }

    /// The world of a text in TOML. `name` is the name of the file in messages; floor plans are read from its folder.
    #[staticmethod]
    #[pyo3(signature = (text, name = "world.toml"))]
    fn from_toml(text: &str, name: &str) -> PyResult<Self> {
        Ok(Self::new(worldfile::physics::parse_fleet_with(name, text, &Disk).map_err(world_error)?))
    }

    /// The world of a file of the simulator Stage. Differences between the two are Python warnings.
    #[staticmethod]
    fn from_stage(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        if !path.exists() {
            return Err(PyFileNotFoundError::new_err(format!("there is no Stage file `{}`", path.display())));
        }
        let (fleet, findings) = stage::load(Path::new(&path), &Disk);
        let fleet = fleet.ok_or_else(|| world_error(findings.error_text()))?;
        for message in findings.messages(Severity::Warning) {
            let message = CString::new(message.replace('\0', " "))?;
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, 2)?;
        }
        Ok(Self::new(fleet))
    }

    /// The generated house of a seed: rooms at a corridor, doors, furniture, people. The same seed gives the same house.
    #[staticmethod]
    fn house(seed: u64) -> Self {
        Self::new(WorldSpec::generate_house(seed).fleet().clone())
    }

    /// The world of the driving task.
    #[staticmethod]
    fn driving_hall() -> Self {
        Self::new(environments::driving_hall())
    }

    /// The names of the worlds that are part of the package.
    #[staticmethod]
    fn shipped() -> Vec<&'static str> {
        worldfile::shipped::PHYSICS.iter().map(|(name, _)| *name).collect()
    }

    /// The name of the world.
    #[getter]
    fn name(&self) -> &str {
        &self.fleet.name
    }

    /// What the world is for.
    #[getter]
    fn description(&self) -> &str {
        &self.fleet.description
    }

    /// The names of all robots.
    #[getter]
    fn robots(&self) -> Vec<&str> {
        self.fleet.robots.iter().map(|robot| robot.name.as_str()).collect()
    }

    /// The indices of the robots that execute commands.
    #[getter]
    fn driven(&self) -> Vec<usize> {
        self.fleet.driven_robots().collect()
    }

    /// The physics step, s.
    #[getter]
    fn step_s(&self) -> f64 {
        self.fleet.step_s
    }

    /// The side of a cell of the ground truth, m.
    #[getter]
    fn cell_m(&self) -> f64 {
        self.fleet.frame.resolution_m()
    }

    /// The lower left corner, m: [x, y].
    #[getter]
    fn origin<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let origin = self.fleet.frame.origin();
        vec![origin.x, origin.y].into_pyarray(py)
    }

    /// The number of rows and columns of cells.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.fleet.frame.height(), self.fleet.frame.width())
    }

    /// The corners of all walls, shape (walls, 4, 2), m.
    #[getter]
    fn walls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let corners = self.fleet.walls.iter().flat_map(|wall| wall.corners());
        let values: Vec<f64> = corners.flat_map(|corner| [corner.x, corner.y]).collect();
        values.into_pyarray(py).reshape([self.fleet.walls.len(), 4, 2])
    }

    /// The world as the text of a world file.
    fn to_toml(&self) -> PyResult<String> {
        let text = worldfile::physics::to_toml(&self.fleet);
        text.ok_or_else(|| world_error(format!("the world `{}` cannot be written as a world file", self.fleet.name)))
    }

    /// A spec never changes: a copy is the same object.
    fn __copy__(this: Bound<'_, Self>) -> Bound<'_, Self> {
        this
    }

    fn __deepcopy__<'py>(this: Bound<'py, Self>, _memo: &Bound<'py, PyAny>) -> Bound<'py, Self> {
        this
    }

    /// For pickle: the text of the world.
    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let text = this.get().to_toml()?;
        let same = worldfile::physics::parse_fleet_with("world.toml", &text, &Disk).map_err(world_error)?;
        if same != *this.get().fleet {
            let name = &this.get().fleet.name;
            return Err(PyValueError::new_err(format!("the world `{name}` changes when it is written as text")));
        }
        Ok((this.get_type().getattr("from_toml")?, (text,)))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.fleet == other.fleet
    }

    fn __repr__(&self) -> String {
        let robots = self.fleet.robots.len();
        format!("<curious.Spec {:?}: {} walls, {robots} robots>", self.fleet.name, self.fleet.walls.len())
    }
}
