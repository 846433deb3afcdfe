//! World files of the simulator Stage, as fleets of the crate `sim` and as world files of this project. It
//! must not know how a world is simulated, or how robots learn.
//!
//! [`read`] reads a `.world` file with all included files, expands its definitions, and returns a [`StageWorld`]:
//! the walls, the floor plans and the robots, in meters and radians, in the coordinates of the Stage file. [`load`]
//! makes a fleet from it; [`StageWorld::to_toml`] writes a world file of this project.
//!
//! Nothing is ignored without a message. An invalid part is an error. A part that Stage supports and this simulator
//! does not support, or simulates differently, is a warning. Both have the file and the line. Parts that only
//! affect how Stage draws or runs a world are listed in one note per file.
//!
//! # What is read
//!
//! | Stage | here |
//! |---|---|
//! | `include`, `define`, models in models | written out, as in Stage; a file that includes itself is an error |
//! | `unit_length`, `unit_angle` | m, cm, mm; degrees, radians |
//! | `name`, `interval_sim` | the name, the longest physics step |
//! | `model`, or a `define` of it | walls |
//! | `bitmap` | a floor plan; its dark pixels (the first color below 128) are scaled to fill `size` |
//! | `block` with `points`, `point[…]` | polygons, scaled to fill `size` together |
//! | `pose`, `origin`, `size`, `boundary` | as in Stage, without heights: beams and robots meet all that they cross in the plan |
//! | `obstacle_return`, `ranger_return`, `laser_return` | a model that neither collides nor is seen is left out |
//! | `position` | a robot |
//! | `drive`, `wheelbase`, `velocity_bounds`, `acceleration_bounds` | [`StageRobot`] |
//! | `localization`, `localization_origin`, `odom_error` | [`OdometryError`] |
//! | the body of a robot | its convex outline, or a disc if the body is one or does not hold the point that the robot turns about |
//! | `ranger` with `sensor`s, and the older `laser` | a laser; a `sensor` of one sample is a sonar: a cone as wide as its `fov` |
//! | `samples`, `fov`, `range`, `range_min`, `range_max`, `noise`, `update_interval` | of a laser or a sonar |
//! | `mass`, `ctrl` | kept in [`StageRobot`] |
//!
//! Everything else (windows, cameras, blob and fiducial finders, bumpers, grippers, energy, …) is listed in a warning. Bumpers
//! are left out since those of Stage are short beams at any place, and those of this simulator are parts of a ring
//! around the robot that detect contacts.

mod body;
mod left_out;
mod lexer;
mod load;
mod models;
mod outline;
mod polygon;
mod robots;
mod senses;
mod sources;
#[cfg(test)]
mod tests;
mod to_toml;
mod tree;
mod world;

use lexer::Span;
use sources::Sources;

use nalgebra::{Isometry2, Point2};
use sim::physics::{FleetSpec, Form, OdometryError, Rectangle};
use std::collections::BTreeMap;
use std::path::Path;
use worldfile::{Files, Findings};

/// A world as described by a Stage file.
#[derive(Clone, Debug, PartialEq)]
pub struct StageWorld {
    /// The value of `name`, or the name of the file.
    pub name: String,
    /// The file and all included files, in the order in which they were read.
    pub files: Vec<String>,
    /// A physics step that is short enough for every robot and sensor, s.
    pub step_s: f64,
    /// The models that do not move.
    pub walls: Vec<StageWall>,
    /// The models that drive.
    pub robots: Vec<StageRobot>,
}

/// A model that does not move.
#[derive(Clone, Debug, PartialEq)]
pub struct StageWall {
    /// The name of the model. If the file has no name, it is generated as in Stage.
    pub name: String,
    /// The place in the file, for example `cave.world:12`.
    pub place: String,
    /// The pieces of the model, including those of the plan.
    pub rectangles: Vec<Rectangle>,
    at: Span,
}

/// A model that drives.
#[derive(Clone, Debug, PartialEq)]
pub struct StageRobot {
    /// The name of the robot. If the file has no name, it is generated as in Stage.
    pub name: String,
    /// The place in the file, for example `cave.world:12`.
    pub place: String,
    /// The pose at the start, m and rad: the pose of the point that the robot turns about.
    pub pose: Isometry2<f64>,
    /// The polygons of the body, in the frame of the robot, m.
    pub footprint: Vec<Vec<Point2<f64>>>,
    /// The corners of the convex outline that the robot has in this simulator, counter-clockwise, in the frame of
    /// the robot, m. Empty if the robot is a disc.
    pub outline: Vec<Point2<f64>>,
    /// The kind of the drive.
    pub drive: Drive,
    /// The bounds of the velocity, m/s and rad/s.
    pub velocity: Bounds,
    /// The bounds of the acceleration, m/s² and rad/s²; `None` if the robot reaches every velocity at once.
    pub acceleration: Option<Bounds>,
    /// The errors of the odometry.
    pub odometry: OdometryError,
    /// The lasers of the robot.
    pub lasers: Vec<StageSensor>,
    /// The sonars of the robot. In Stage a sonar is a single ray.
    pub sonars: Vec<StageSensor>,
    /// The mass, kg.
    pub mass_kg: Option<f64>,
    /// Whether its controller is Stage's `wander`.
    pub wanders: bool,
    at: Span,
    /// The places of the keys of the robot in the file.
    keys: BTreeMap<String, Span>,
}

/// The kind of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// Two driven wheels.
    Differential,
    /// Drives in every direction and turns at the same time.
    Omni,
    /// Steered front wheels.
    Car {
        /// The distance between the axles, m.
        wheelbase_m: f64,
    },
}

/// Bounds per axis, each from the minimum to the maximum; m/s and rad/s, or m/s² and rad/s².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Forward.
    pub x: [f64; 2],
    /// To the left.
    pub y: [f64; 2],
    /// Counter-clockwise rotation.
    pub turn: [f64; 2],
}

/// The larger magnitude of two bounds, the least and the most.
fn fastest([least, most]: [f64; 2]) -> f64 {
    most.max(-least)
}

/// A laser or a sonar.
#[derive(Clone, Debug, PartialEq)]
pub struct StageSensor {
    /// The place in the file, for example `sick.inc:3`.
    pub place: String,
    /// The pose of the sensor in the frame of the robot, m and rad.
    pub mount: Isometry2<f64>,
    /// The number of beams of a laser; 1 for a sonar.
    pub beams: usize,
    /// The angle of the field of view, rad; for a sonar, the angle of the cone.
    pub fov_rad: f64,
    /// The minimum and the maximum range, m; nearer or farther surfaces are not measured.
    pub range_m: [f64; 2],
    /// The time between two measurements, ms.
    pub interval_ms: u32,
    /// The standard deviation of a range, m.
    pub noise_std_m: f64,
    at: Span,
}

impl StageRobot {
    /// The radius of the circle about its turning point that holds its body, m.
    pub fn radius_m(&self) -> f64 {
        let corners = self.footprint.iter().flatten();
        corners.map(|corner| corner.coords.norm()).fold(0.0, f64::max)
    }

    /// The place of this key in the file, or else that of this robot.
    fn key(&self, key: &str) -> Span {
        self.keys.get(key).copied().unwrap_or(self.at)
    }

    /// All sensors, each with what it is.
    fn sensors(&self) -> impl Iterator<Item = (&'static str, &StageSensor)> {
        let lasers = self.lasers.iter().map(|sensor| ("laser", sensor));
        lasers.chain(self.sonars.iter().map(|sensor| ("sonar", sensor)))
    }

    /// The area that the robot covers in this simulator at its start.
    fn form(&self) -> Form {
        Form::new(&self.outline, self.radius_m(), &self.pose)
    }

    /// The radius of the circle about its turning point that lies within what it covers here, m.
    fn inner_m(&self) -> f64 {
        if self.outline.is_empty() { self.radius_m() } else { outline::inner_m(&self.outline) }
    }

    /// Whether its body is a disc about its turning point, as good as a polygon can be one.
    fn is_round(&self) -> bool {
        let radius_m = self.radius_m();
        let is_far = |corner: &Point2<f64>| corner.coords.norm() > 0.99 * radius_m;
        matches!(self.footprint.as_slice(), [body] if body.len() >= 12 && body.iter().all(is_far))
    }
}

/// Reads a `.world` file. If no world is returned, there are errors among the findings.
pub fn read(path: &Path, files: &dyn Files) -> (Option<StageWorld>, Findings) {
    let (world, sources) = open(path, files);
    (world, sources.findings)
}

/// Reads a `.world` file and makes a fleet from it. Its robots execute commands, except those that wander. If no
/// fleet is returned, there are errors among the findings.
///
/// The fleet has its own coordinates: the world is moved, but not rotated, so that its lower left corner is [0, 0].
/// The point p of the file is at p − [`StageWorld::map_origin`] in the fleet; a note among the findings has this
/// offset.
pub fn load(path: &Path, files: &dyn Files) -> (Option<FleetSpec>, Findings) {
    let (world, mut sources) = open(path, files);
    let spec = world.and_then(|world| load::load(&mut sources, path, &world));
    (spec, sources.findings)
}

fn open<'a>(path: &Path, files: &'a dyn Files) -> (Option<StageWorld>, Sources<'a>) {
    let mut sources = Sources::new(files);
    let tokens = sources.read(path);
    let tree = tokens.and_then(|tokens| tree::read(&mut sources, &tokens));
    let world = tree.and_then(|tree| world::convert(&mut sources, &tree));
    sources.note_no_effect();
    (world.filter(|_| sources.findings.errors() == 0), sources)
}
