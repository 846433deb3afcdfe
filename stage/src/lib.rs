//! World files of the simulator Stage.
//!
//! [`read`] takes a `.world` file and all that it includes, writes out its definitions, and gives a
//! [`StageWorld`]: the walls, the floor plans and the robots, in meters and radians, in Stage's own
//! coordinates. [`load`] makes a fleet of it that runs, [`StageWorld::to_toml`] a world file of ours.
//!
//! Nothing is dropped in silence. What is not valid is an error; what Stage has and this simulator
//! has not, or does otherwise, is a warning; both name the file and the line. What changes nothing
//! but how Stage draws or runs a world is in one note per file.
//!
//! # What is read
//!
//! | Stage | here |
//! |---|---|
//! | `include`, `define`, models in models | written out, as in Stage; a file that includes itself is an error |
//! | `unit_length`, `unit_angle` | m, cm, mm; degrees, radians |
//! | `name`, `interval_sim`, `quit_time` | the name, the longest physics step, the length of a run |
//! | `model`, or a `define` of it | walls |
//! | `bitmap` | a [`FloorPlan`]; its dark pixels (the first color below 128) are scaled to fill `size` |
//! | `block` with `points`, `point[…]`, `z` | polygons, scaled to fill `size` together |
//! | `pose`, `origin`, `size`, `boundary`, `stack_children` | as in Stage |
//! | `obstacle_return`, `ranger_return`, `laser_return` | a model that neither collides nor is seen is left out |
//! | `position` | a robot |
//! | `drive`, `wheelbase`, `velocity_bounds`, `acceleration_bounds` | [`StageRobot`] |
//! | `localization`, `localization_origin`, `odom_error` | [`OdometryError`] |
//! | the body of a robot | its convex outline, or a disc if the body is one or does not hold the point that the robot turns about |
//! | `ranger` with `sensor`s, and the older `laser` | a laser; a `sensor` of one sample is a sonar: a cone as wide as its `fov` |
//! | `samples`, `fov`, `range`, `range_min`, `range_max`, `noise`, `update_interval` | of a laser or a sonar |
//! | `fiducial` | a fiducial finder, as far as it tells tags apart (`range_max_id`) |
//! | `fiducial_return` | the tag of a robot, or of a box that stands about its pose |
//! | `color`, `mass`, `ctrl` | kept in [`StageRobot`] |
//!
//! Everything else (windows, cameras, blob finders, bumpers, grippers, energy, …) is named in a
//! warning. So are bumpers: those of Stage are short beams that may lie anywhere, ours are the parts
//! of a ring around the robot, and feel touches.

mod body;
mod builder;
mod check;
mod drive;
mod heights;
mod left_out;
mod lexer;
mod load;
mod models;
mod outline;
mod pictures;
mod polygon;
mod robots;
mod senses;
mod sources;
#[cfg(test)]
mod tests;
mod to_toml;
mod tree;
mod world;

use lexer::Place;
use sources::Sources;

use nalgebra::{Isometry2, Point2};
use sim::physics::{FleetSpec, Form, OdometryError, Rectangle};
use std::collections::BTreeMap;
use std::path::Path;
use worldfile::Files;
use worldfile::Findings;
use worldfile::floor_plan::FloorPlan;

/// A world as a Stage file describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct StageWorld {
    /// `name`, or else the name of the file.
    pub name: String,
    /// The file and all that it includes, in the order in which they were read.
    pub files: Vec<String>,
    /// A physics step that is short enough for every robot and sensor, s.
    pub step_s: f64,
    /// After how long Stage would stop, s.
    pub quit_time_s: Option<f64>,
    /// Everything that stands still.
    pub walls: Vec<StageWall>,
    /// Everything that drives.
    pub robots: Vec<StageRobot>,
}

/// A model that stands still.
#[derive(Clone, Debug, PartialEq)]
pub struct StageWall {
    /// Its name, generated as in Stage where the file gives none.
    pub name: String,
    /// Its color in Stage.
    pub color: Option<String>,
    /// Its place in the file, as in `cave.world:12`.
    pub place: String,
    /// Its pixels, if it is a bitmap.
    pub plan: Option<FloorPlan>,
    /// Its pieces, those of the plan included.
    pub rectangles: Vec<Rectangle>,
    /// The tag that fiducial finders find; a wall with a tag is one rectangle.
    pub tag: Option<u32>,
    at: Place,
}

/// A model that drives.
#[derive(Clone, Debug, PartialEq)]
pub struct StageRobot {
    /// Its name, generated as in Stage where the file gives none.
    pub name: String,
    /// Its color in Stage.
    pub color: Option<String>,
    /// Its place in the file, as in `cave.world:12`.
    pub place: String,
    /// Its pose at the start: that of the point that it turns about.
    pub pose: Isometry2<f64>,
    /// The polygons of its body, in its own frame, m.
    pub footprint: Vec<Vec<Point2<f64>>>,
    /// The corners of the convex outline that it has here, counter-clockwise, in its own frame, m;
    /// none: it is a disc.
    pub outline: Vec<Point2<f64>>,
    /// How it drives.
    pub drive: Drive,
    /// The bounds of its velocity.
    pub velocity: Bounds,
    /// The bounds of its acceleration; `None`: it reaches every velocity at once.
    pub acceleration: Option<Bounds>,
    /// How its odometry errs.
    pub odometry: OdometryError,
    /// Its lasers.
    pub lasers: Vec<StageSensor>,
    /// Its sonars, which are single rays in Stage.
    pub sonars: Vec<StageSensor>,
    /// Its fiducial finder.
    pub fiducial: Option<StageSensor>,
    /// Its own tag.
    pub tag: Option<u32>,
    /// Its mass, kg.
    pub mass_kg: Option<f64>,
    /// The controllers that Stage would load.
    pub controllers: Vec<String>,
    at: Place,
    /// The places of its keys.
    keys: BTreeMap<String, Place>,
}

/// How a robot drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// Two wheels.
    Differential,
    /// In every direction at once.
    Omni,
    /// With steered front wheels.
    Car {
        /// From the rear axle to the front axle, m.
        wheelbase_m: f64,
    },
}

/// From the least to the most, per axis; m/s and rad/s, or m/s² and rad/s².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Forwards.
    pub x: [f64; 2],
    /// To the left.
    pub y: [f64; 2],
    /// Counter-clockwise.
    pub turn: [f64; 2],
}

/// The larger magnitude of two bounds, the least and the most.
fn fastest([least, most]: [f64; 2]) -> f64 {
    most.max(-least)
}

/// A laser, a sonar or a fiducial finder.
#[derive(Clone, Debug, PartialEq)]
pub struct StageSensor {
    /// Its place in the file, as in `sick.inc:3`.
    pub place: String,
    /// Its pose on the robot.
    pub mount: Isometry2<f64>,
    /// The number of beams of a laser; 1 for other sensors.
    pub beams: usize,
    /// The angle of the field of view, which is the cone of a sonar, rad.
    pub fov_rad: f64,
    /// The least and the greatest range, m; what is nearer or farther is not measured.
    pub range_m: [f64; 2],
    /// The time between two measurements, ms.
    pub interval_ms: u32,
    /// Standard deviation of a range, m.
    pub noise_std_m: f64,
    at: Place,
}

impl StageRobot {
    /// The radius of the circle about its turning point that holds its body, m.
    pub fn radius_m(&self) -> f64 {
        let corners = self.footprint.iter().flatten();
        corners.map(|corner| corner.coords.norm()).fold(0.0, f64::max)
    }

    /// The place of this key in the file, or else that of this robot.
    fn key(&self, key: &str) -> Place {
        self.keys.get(key).copied().unwrap_or(self.at)
    }

    /// All sensors, each with what it is.
    fn sensors(&self) -> impl Iterator<Item = (&'static str, &StageSensor)> {
        let lasers = self.lasers.iter().map(|sensor| ("laser", sensor));
        let sonars = self.sonars.iter().map(|sensor| ("sonar", sensor));
        lasers.chain(sonars).chain(self.fiducial.iter().map(|sensor| ("fiducial finder", sensor)))
    }

    /// What it covers here, where it starts.
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

/// Reads a `.world` file. Without a world there are errors among the findings.
pub fn read(path: &Path, files: &dyn Files) -> (Option<StageWorld>, Findings) {
    let (world, sources) = open(path, files);
    (world, sources.findings)
}

/// Reads a `.world` file and makes a fleet of it, whose robots obey commands, but for those that
/// wander. Without a fleet there are errors among the findings.
///
/// The fleet has coordinates of its own: the world is moved, not turned, so that the lower left corner of
/// all that is there is [0, 0]. What is at p in the file is at p − [`StageWorld::map_origin`] in the fleet;
/// a note among the findings says by how much.
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
