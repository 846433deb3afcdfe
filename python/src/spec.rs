use crate::convert::{described, load_error, no_robot, warn, whole, world_error};
use numpy::{IntoPyArray, PyArray1, PyArray3, PyArrayMethods};
use pyo3::exceptions::{PyFileNotFoundError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use sim::physics::{FleetSpec, WorldSpec};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use worldfile::{Disk, Files, Severity};

/// The specification of a world: walls, obstacles, robots. It never changes; fleets, worlds and tasks are made from
/// it.
#[pyclass(frozen, module = "curious")]
pub(crate) struct Spec {
    pub(crate) fleet: Arc<FleetSpec>,
    source: Source,
}

/// Where a spec comes from: what makes the same one in another process.
#[derive(Clone)]
pub(crate) enum Source {
    /// The name of a shipped world.
    Shipped(String),
    /// The text of a world file, and its name.
    Text { name: String, text: String },
}

impl Spec {
    fn new(fleet: FleetSpec, source: Source) -> Self {
        Self { fleet: Arc::new(fleet), source }
    }

    fn of_text(name: &str, text: String) -> PyResult<Self> {
        let fleet = worldfile::physics::parse_fleet_with(name, &text, &Disk).map_err(world_error)?;
        Ok(Self::new(fleet, Source::Text { name: name.to_owned(), text }))
    }
}

/// The same world with exactly one driven robot: the only one, or the one with an index.
pub(crate) fn driving(fleet: &Arc<FleetSpec>, robot: Option<usize>) -> PyResult<WorldSpec> {
    let (name, robots) = (&fleet.name, fleet.robots.len());
    match robot {
        None => WorldSpec::new((**fleet).clone())
            .map_err(|error| world_error(format!("the world `{name}`: {error}; `robot` chooses one"))),
        Some(robot) => WorldSpec::driving((**fleet).clone(), robot).ok_or_else(|| no_robot(robot, robots)),
    }
}

/// A spec, or the name or the path of a world.
pub(crate) fn spec_of(py: Python<'_>, world: &Bound<'_, PyAny>) -> PyResult<Arc<FleetSpec>> {
    if let Ok(spec) = world.cast::<Spec>() {
        return Ok(Arc::clone(&spec.get().fleet));
    }
    Ok(Spec::load(py, world_name(world)?)?.fleet)
}

/// The name or the path of a world.
pub(crate) fn world_name(world: &Bound<'_, PyAny>) -> PyResult<PathBuf> {
    world.extract().map_err(|_| {
        let kind = described(world);
        PyTypeError::new_err(format!(
            "a world is a spec, the name of a shipped world, or a path, and not {kind}"
        ))
    })
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
        if shipped.is_some() || !name.exists() {
            let name = name.to_string_lossy().into_owned();
            let world = worldfile::shipped::load(&name).map_err(load_error)?;
            return Ok(Self::new(world.fleet().clone(), Source::Shipped(name)));
        }
        let text = Disk.read(&name, worldfile::MAX_TEXT_BYTES).and_then(|bytes| {
            String::from_utf8(bytes).map_err(|_| std::io::Error::other("it is not a text in UTF-8"))
        });
        let text = text.map_err(|error| {
            world_error(format!("cannot read the world file `{}`: {error}", name.display()))
        })?;
        Self::of_text(&name.to_string_lossy(), text)
    }

    /// The world of a text in TOML. `name` is the name of the file in messages; floor plans are read from its folder.
    #[staticmethod]
    #[pyo3(signature = (text, name = "world.toml"))]
    fn from_toml(text: String, name: &str) -> PyResult<Self> {
        Self::of_text(name, text)
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
            warn(py, &message)?;
        }
        let text = stage::read(&path, &Disk).0.map(|world| world.to_toml()).unwrap_or_default();
        Ok(Self::new(fleet, Source::Text { name: path.with_extension("toml").display().to_string(), text }))
    }

    /// The generated house of a seed: rooms at a corridor, doors, furniture, people. The same seed gives the same
    /// house.
    #[staticmethod]
    fn house(#[pyo3(from_py_with = whole)] seed: u64) -> PyResult<Self> {
        let house = WorldSpec::generate_house(seed);
        let text = worldfile::physics::to_toml(house.fleet());
        let text = text.ok_or_else(|| world_error("the house cannot be written as a world file"))?;
        Ok(Self::new(house.fleet().clone(), Source::Text { name: format!("house-{seed}.toml"), text }))
    }

    /// The world of the driving task.
    #[staticmethod]
    fn driving_hall() -> Self {
        let (name, text) = ("driving_hall.toml".to_owned(), environments::DRIVING_HALL.to_owned());
        Self::new(environments::driving_hall(), Source::Text { name, text })
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

    /// The world as the text of a world file. Pictures that the file names are not in it.
    fn to_toml(&self) -> String {
        match &self.source {
            Source::Text { text, .. } => text.clone(),
            Source::Shipped(name) => worldfile::shipped::text(name).unwrap_or_default().to_owned(),
        }
    }

    /// For pickle and copies: the name or the text of the world.
    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let (py, class) = (this.py(), this.get_type());
        Ok(match &this.get().source {
            Source::Shipped(name) => (class.getattr("load")?, (name,).into_pyobject(py)?),
            Source::Text { name, text } => (class.getattr("from_toml")?, (text, name).into_pyobject(py)?),
        })
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.fleet == other.fleet
    }

    fn __repr__(&self) -> String {
        let robots = self.fleet.robots.len();
        format!("<curious.Spec {:?}: {} walls, {robots} robots>", self.fleet.name, self.fleet.walls.len())
    }
}
