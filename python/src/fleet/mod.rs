mod arrays;

use crate::convert::{
    Numbers, Table, index, no_robot, pose, pose_values, rows_array, snapshot_error, value_error, whole,
    writable,
};
use crate::reading::Reading;
use crate::snapshots::Kind;
use crate::spec::spec_of;
use crate::threads::on_threads;
use arrays::look_all;
use interfaces::{LaserReading, Purpose, RandomStream};
use numpy::{PyArray2, PyArrayDyn};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use sim::physics::{Body, Contact, FreePoses, Velocity};

/// A world with any number of robots. The same spec, seed and commands give the same bits as in Rust, on any number
/// of threads.
#[derive(Clone)]
#[pyclass(module = "curious")]
pub(crate) struct Fleet {
    fleet: sim::physics::Fleet,
    driven: Vec<usize>,
    /// The number of threads on which lasers measure; 0 for one per core.
    threads: usize,
    /// The number of beams of each robot, if it is the same.
    beams: Option<usize>,
    /// The contacts that began in the last `step` or `run`.
    contacts: Vec<Contact>,
}

/// A contact: time, robot, what it touched, x, y, whether the robot moved.
type ContactRow = (f64, usize, (&'static str, usize), f64, f64, bool);

/// The true poses of all robots.
pub(crate) fn poses_of(fleet: &sim::physics::Fleet) -> PyResult<Vec<[f64; 3]>> {
    let mut poses = vec![[0.0; 3]; fleet.spec().robots.len()];
    fleet.copy_poses(&mut poses).map_err(value_error)?;
    Ok(poses)
}

impl Fleet {
    fn check_robot(&self, robot: usize) -> PyResult<()> {
        let robots = self.fleet.spec().robots.len();
        if robot < robots { Ok(()) } else { Err(no_robot(robot, robots)) }
    }
}

const SNAPSHOT: Kind = Kind("fleet");

/// The greatest number of poses of one draw.
const MAX_POSES: usize = 10_000_000;

#[pymethods]
impl Fleet {
    /// The fleet of a world (`Spec`, name or path) at its start. `threads`: lasers measure on all threads.
    #[new]
    #[pyo3(signature = (world, seed = 0, *, threads = false))]
    fn new(
        py: Python<'_>,
        world: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = whole)] seed: u64,
        threads: bool,
    ) -> PyResult<Self> {
        let spec = spec_of(py, world)?;
        let driven = spec.driven_robots().collect();
        let first = spec.robots.first().map_or(0, |robot| robot.laser.beams);
        let beams = Some(first).filter(|beams| spec.robots.iter().all(|robot| robot.laser.beams == *beams));
        let mut fleet = py.detach(|| sim::physics::Fleet::new(&spec, seed));
        fleet.set_parallel_lasers(threads);
        Ok(Self { fleet, driven, threads: usize::from(!threads), beams, contacts: Vec::new() })
    }

    /// The time since the start, s.
    #[getter]
    fn time(&self) -> f64 {
        self.fleet.time_s()
    }

    /// The indices of the robots that execute commands.
    #[getter]
    fn driven(&self) -> Vec<usize> {
        self.driven.clone()
    }

    /// The names of all robots.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.fleet.robots().map(|robot| robot.name.to_owned()).collect()
    }

    fn __len__(&self) -> usize {
        self.fleet.spec().robots.len()
    }

    /// Sets the velocity of a robot until its next command: forward (m/s), angular (rad/s), and left (m/s) for an
    /// omni drive. Returns whether the robot executes commands.
    #[pyo3(signature = (robot, linear, angular, left = 0.0))]
    fn command(
        &mut self,
        #[pyo3(from_py_with = index)] robot: usize,
        linear: f64,
        angular: f64,
        left: f64,
    ) -> PyResult<bool> {
        self.check_robot(robot)?;
        if !(linear.is_finite() && angular.is_finite() && left.is_finite()) {
            return Err(value_error(format!("a command is finite, and not [{linear}, {angular}, {left}]")));
        }
        Ok(self.fleet.command(robot, Velocity { forward_mps: linear, left_mps: left, turn_radps: angular }))
    }

    /// Simulates some physics steps. `commands`: one row per driven robot, shape (driven, 2), linear (m/s) and
    /// angular (rad/s) velocity; with 3 columns linear, left, angular. At the end, `scans` (float32, as in `scans(out)`)
    /// and `poses` (float64, as in `poses(out)`) are filled, if they are given: one call has everything of an instant.
    #[pyo3(signature = (commands = None, *, steps = 1, scans = None, poses = None))]
    fn step(
        &mut self,
        py: Python<'_>,
        commands: Option<Table<'_>>,
        #[pyo3(from_py_with = whole)] steps: i64,
        scans: Option<Bound<'_, PyAny>>,
        poses: Option<Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        if steps < 0 {
            return Err(value_error(format!("`steps` is 0 or more, and not {steps}")));
        }
        let mut scans = scans.map(|out| writable(&out, "scans")).transpose()?;
        let mut poses = poses.map(|out| writable(&out, "poses")).transpose()?;
        let ranges_m = scans.as_mut().map(|out| self.scans_of(out)).transpose()?;
        let poses = poses.as_mut().map(|out| self.poses_of(out)).transpose()?;
        commands.as_ref().map_or(Ok(()), |commands| self.set_commands(commands))?;
        let end_s = self.fleet.time_s() + steps as f64 * self.fleet.spec().step_s;
        self.run_until(py, end_s, ranges_m)?;
        poses.map_or(Ok(()), |poses| self.fleet.copy_poses(poses)).map_err(value_error)
    }

    /// Simulates for some time, s.
    fn run(&mut self, py: Python<'_>, seconds: f64) -> PyResult<()> {
        if !(seconds.is_finite() && seconds >= 0.0) {
            return Err(value_error(format!("a duration is 0 s or more, and not {seconds}")));
        }
        self.run_until(py, self.fleet.time_s() + seconds, None)
    }

    /// Measures with the main laser of a robot now: scan and pose are of the same instant.
    fn look(&mut self, #[pyo3(from_py_with = index)] robot: usize) -> PyResult<Reading> {
        let robots = self.fleet.spec().robots.len();
        let seen = self.fleet.look(robot).ok_or_else(|| no_robot(robot, robots))?;
        let reading: Option<&LaserReading> = seen.reading();
        let reading = reading.ok_or_else(|| PyRuntimeError::new_err("the laser has not measured"))?;
        Ok(Reading::of(reading.clone()))
    }

    /// Measures with the main lasers of all robots now: ranges (m) of shape (robots, beams), float32. If robots have
    /// different numbers of beams, one after the other, shape (all beams,). With `out`, an array of this shape, nothing is
    /// allocated.
    #[pyo3(signature = (out = None))]
    fn scans<'py>(&mut self, py: Python<'py>, out: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        let array = out.unwrap_or_else(|| PyArrayDyn::<f32>::zeros(py, self.scans_shape(), false).into_any());
        let mut out = writable(&array, "out")?;
        let (ranges_m, fleet) = (self.scans_of(&mut out)?, &mut self.fleet);
        on_threads(py, self.threads, || look_all(fleet, ranges_m))??;
        Ok(array)
    }

    /// The true poses of all robots, shape (robots, 3), float64: x (m), y (m), heading (rad). With `out`, an array of this
    /// shape, nothing is allocated.
    #[pyo3(signature = (out = None))]
    fn poses<'py>(&self, py: Python<'py>, out: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        let Some(array) = out else { return Ok(rows_array(py, poses_of(&self.fleet)?)?.into_any()) };
        self.fleet.copy_poses(self.poses_of(&mut writable(&array, "out")?)?).map_err(value_error)?;
        Ok(array)
    }

    /// The true velocities of all robots, shape (robots, 3): forward (m/s), left (m/s), angular (rad/s).
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let robots = self.fleet.robots();
        rows_array(
            py,
            robots.map(|robot| [robot.twist.linear_mps, robot.left_mps, robot.twist.angular_radps]),
        )
    }

    /// The contacts that began in the last `step` or `run`: (time (s), robot, with, x (m), y (m), moving). `with` is
    /// "wall", "obstacle" or "robot", and its index.
    fn contacts(&self) -> Vec<ContactRow> {
        let contacts = self.contacts.iter().map(|contact| {
            let with = match contact.with {
                Body::Wall(index) => ("wall", index),
                Body::Obstacle(index) => ("obstacle", index),
                Body::Robot(index) => ("robot", index),
            };
            (contact.time_s, contact.robot, with, contact.at.x, contact.at.y, contact.moving)
        });
        contacts.collect()
    }

    /// Returns to the start, with another seed. This takes a small part of the time of a new fleet.
    #[pyo3(signature = (seed = 0))]
    fn reset(&mut self, py: Python<'_>, #[pyo3(from_py_with = whole)] seed: u64) {
        let fleet = &mut self.fleet;
        py.detach(|| fleet.reset(seed));
    }

    /// Puts a robot at a pose (x, y, heading), at rest. `ValueError`: something else is there.
    fn teleport(&mut self, #[pyo3(from_py_with = index)] robot: usize, pose: Numbers) -> PyResult<()> {
        self.check_robot(robot)?;
        self.fleet.teleport(robot, &self::pose(&pose)?).map_err(value_error)
    }

    /// `count` random poses that a robot can reach from its start, and at which it fits now, shape (count, 3). The
    /// same seed gives the same poses.
    #[pyo3(signature = (robot, seed, count = 1))]
    fn free_poses<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = index)] robot: usize,
        #[pyo3(from_py_with = whole)] seed: u64,
        #[pyo3(from_py_with = whole)] count: usize,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.check_robot(robot)?;
        if count > MAX_POSES {
            return Err(value_error(format!("at most {MAX_POSES} poses are drawn at once, and not {count}")));
        }
        let fleet = &self.fleet;
        let drawn = py.detach(|| {
            let poses = FreePoses::reachable(fleet.spec(), robot)?;
            let mut random = RandomStream::new(seed, Purpose::Task);
            (0..count).map(|_| fleet.draw_pose(&poses, robot, &mut random)).collect::<Option<Vec<_>>>()
        });
        let drawn = drawn.ok_or_else(|| value_error(format!("there is no free pose for robot {robot}")))?;
        rows_array(py, drawn.iter().map(pose_values))
    }

    /// The state as bytes.
    fn snapshot<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let fleet = &self.fleet;
        SNAPSHOT.seal(py, &py.detach(|| fleet.snapshot()))
    }

    /// Returns to a snapshot of a fleet of the same world. `SnapshotError`: the bytes are not one, or were written by
    /// another build of the package; nothing changes then.
    #[pyo3(signature = (snapshot, *, allow_other_build = false))]
    fn restore(&mut self, py: Python<'_>, snapshot: &[u8], allow_other_build: bool) -> PyResult<()> {
        let fleet = &mut self.fleet;
        let state = SNAPSHOT.open(snapshot, allow_other_build)?;
        py.detach(|| fleet.restore(state)).map_err(snapshot_error)
    }

    /// An independent copy.
    fn copy(&self) -> Self {
        self.clone()
    }

    fn __repr__(&self) -> String {
        let (spec, time_s) = (self.fleet.spec(), self.fleet.time_s());
        format!("<curious.Fleet {:?}: {} robots at {time_s:.3} s>", spec.name, spec.robots.len())
    }
}
