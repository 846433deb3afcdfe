//! The specification of a physics world: plain values in SI units.
//!
//! The documentation of every field has its unit and its valid range. [`super::Fleet`] and [`super::PhysicsWorld`]
//! do not check the ranges of a spec. The crate `worldfile` makes specs from texts, and checks them.

mod behavior;
mod obstacle;
mod robot;
mod senses;

pub use behavior::{BehaviorSpec, CircleSpec, PatrolSpec, Repeat, WanderSpec, WaypointsSpec};
pub use obstacle::{DoorSpec, Leaf, Motion, ObstacleSpec, Opening, PathSpec, PushedSpec, ThingPart};
pub use robot::{
    DisplacementSpec, DriveKind, DriveLimits, LaserSpec, OdometryError, PatrolDaySpec, RobotSpec,
};
pub use senses::{BumperSpec, SonarSpec};

use super::shape::{Rectangle, TOUCH_M, Transform, grid_corners};
use interfaces::{GridFrame, rotation};
use nalgebra::{Point2, Vector2};

/// The specification of a world with any number of robots.
#[derive(Clone, Debug, PartialEq)]
pub struct FleetSpec {
    /// The name of the world.
    pub name: String,
    /// What the world is for, in one or two sentences; can be empty.
    pub description: String,
    /// The grid of the ground truth. It covers the whole world.
    pub frame: GridFrame,
    /// The physics step, s; 0.001 to 0.1.
    pub step_s: f64,
    /// How contacts change the motion of robots.
    pub contacts: ContactModel,
    /// The walls.
    pub walls: Vec<Rectangle>,
    /// The walls of glass, or of another material that swallows beams of lasers; each is also in `walls`.
    pub glass: Vec<Glass>,
    /// The obstacles: boxes, moving blocks and doors.
    pub obstacles: Vec<ObstacleSpec>,
    /// The robots. At the start no robot overlaps another robot, a wall or an obstacle.
    pub robots: Vec<RobotSpec>,
    /// The time of the week at the start, s since Monday 0:00 in local civil time; `None` if the world has no calendar.
    /// Things with a schedule need one. Where nothing moves, time in a world with a calendar passes in large steps.
    pub starts_s: Option<f64>,
}

/// A wall that returns a beam of a laser only if the beam comes nearly along the normal of its surface: glass, or
/// something black. Another beam has no return.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass {
    /// The wall.
    pub shape: Rectangle,
    /// The largest angle between a beam that is returned and the normal, rad; 0: no beam is returned.
    pub returns_within_rad: f64,
}

impl Glass {
    /// Whether a beam along the unit vector `along` that ends at `end` (m) is swallowed.
    pub(crate) fn swallows(&self, end: &Point2<f64>, along: &Vector2<f64>) -> bool {
        let local = self.shape.pose.inverse_transform_point(end).coords.abs() - self.shape.half_m;
        if local.max().abs() > TOUCH_M {
            return false;
        }
        let along = self.shape.pose.inverse_transform_vector(along);
        let cosine = along[local.imax()].abs();
        self.returns_within_rad <= 0.0 || cosine < libm::cos(self.returns_within_rad)
    }
}

impl FleetSpec {
    /// Rotates everything except the frame by `turn_rad` (counter-clockwise) about `center` (m).
    pub fn turn(&mut self, turn_rad: f64, center: &Point2<f64>) {
        if turn_rad == 0.0 {
            return;
        }
        self.transform(&Transform { turn: rotation(turn_rad), from: *center, to: *center });
    }

    /// Moves everything except the frame.
    fn transform(&mut self, by: &Transform) {
        for wall in self.walls.iter_mut().chain(self.glass.iter_mut().map(|glass| &mut glass.shape)) {
            *wall = wall.transformed(by);
        }
        for obstacle in &mut self.obstacles {
            obstacle.transform(by);
        }
        for robot in &mut self.robots {
            robot.pose = by.pose(&robot.pose);
            robot.behavior.transform(by);
            if let Some(dock) = robot.patrol.as_mut().and_then(|patrol| patrol.dock.as_mut()) {
                *dock = by.point(dock);
            }
        }
    }

    /// The robots that execute commands, each with the position of its dock, m: where it starts unless it has another one.
    pub(crate) fn docks(&self) -> impl Iterator<Item = (usize, Point2<f64>)> {
        self.driven_robots().map(|index| {
            let robot = &self.robots[index];
            let dock = robot.patrol.as_ref().and_then(|patrol| patrol.dock);
            (index, dock.unwrap_or_else(|| robot.pose.translation.vector.into()))
        })
    }

    /// The indices of the robots that execute commands.
    pub fn driven_robots(&self) -> impl Iterator<Item = usize> {
        let is_driven = |(_, robot): &(usize, &RobotSpec)| robot.behavior == BehaviorSpec::Driven;
        self.robots.iter().enumerate().filter(is_driven).map(|(index, _)| index)
    }
}

/// How contacts change the motion of robots.
///
/// In both models no body passes another one, nothing has friction with walls or robots, and a robot slides along what
/// stops it. They differ in the last bits, and where several bodies meet by fractions of a millimeter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactModel {
    /// A solver of rigid bodies (rapier) simulates all bodies in every step.
    #[default]
    RigidBodies,
    /// A round robot that can only meet what no contact moves (walls, blocks, doors) moves as near to its wanted motion
    /// as these bodies allow; a step in which robots meet each other, or a box that can be pushed, is one of rigid
    /// bodies. Several times as fast where robots are far apart.
    Sliding,
}

/// The specification of a world in which exactly one robot is driven: the robot that explores.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldSpec {
    fleet: FleetSpec,
    driven: usize,
}

/// The error for a fleet that does not have exactly one driven robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DrivenError {
    /// No robot is driven.
    #[error("no robot is driven")]
    None,
    /// At least two robots are driven.
    #[error("more than one robot is driven")]
    Several {
        /// The index of the first driven robot.
        first: usize,
        /// The index of the second driven robot.
        second: usize,
    },
}

impl WorldSpec {
    /// The world of a fleet in which exactly one robot is driven.
    ///
    /// # Errors
    ///
    /// When no robot is driven, or more than one.
    pub fn new(fleet: FleetSpec) -> Result<Self, DrivenError> {
        match fleet.driven_robots().collect::<Vec<_>>()[..] {
            [driven] => Ok(Self { fleet, driven }),
            [] => Err(DrivenError::None),
            [first, second, ..] => Err(DrivenError::Several { first, second }),
        }
    }

    /// The world of `fleet` in which the robot with the index `driven` is driven, whatever its behavior was; other
    /// driven robots stand still. `None` if there is no such robot.
    pub fn driving(mut fleet: FleetSpec, driven: usize) -> Option<Self> {
        for robot in fleet.robots.iter_mut().filter(|robot| robot.behavior == BehaviorSpec::Driven) {
            robot.behavior = BehaviorSpec::Standing;
        }
        fleet.robots.get_mut(driven)?.behavior = BehaviorSpec::Driven;
        Some(Self { fleet, driven })
    }

    /// The same world, whose driven robot has this day; a world without a calendar starts on Monday, 0:00.
    #[must_use]
    pub fn with_patrol(mut self, patrol: PatrolDaySpec) -> Self {
        self.fleet.robots[self.driven].patrol = Some(patrol);
        self.fleet.starts_s.get_or_insert(0.0);
        self
    }

    /// The same world in another frame, in which the driven robot starts at the origin with the heading `heading_rad`;
    /// and the motion from the frame of this world. The frame covers that of this world, in whole cells from the origin.
    /// `None` if such a frame has too many cells.
    pub fn around_robot(&self, heading_rad: f64) -> Option<(Self, Transform)> {
        let (start, frame) = (&self.driven().pose, &self.frame);
        let turn = rotation(heading_rad) * start.rotation.inverse();
        let by = Transform { turn, from: start.translation.vector.into(), to: Point2::origin() };
        let (low, high) = grid_corners(frame);
        let place = Rectangle::between(low, high).transformed(&by);
        let ((low, high), cell_m) = (place.bounds(), frame.resolution_m());
        let origin = Point2::from((low.coords / cell_m).map(f64::floor) * cell_m);
        let mut moved = self.clone();
        moved.fleet.frame = GridFrame::covering(origin, high.x - origin.x, high.y - origin.y, cell_m)?;
        moved.fleet.transform(&by);
        Some((moved, by))
    }

    /// The same world as a fleet.
    pub fn fleet(&self) -> &FleetSpec {
        &self.fleet
    }

    /// The index of the driven robot.
    pub fn driven_index(&self) -> usize {
        self.driven
    }

    /// The driven robot.
    pub fn driven(&self) -> &RobotSpec {
        &self.fleet.robots[self.driven]
    }
}

impl std::ops::Deref for WorldSpec {
    type Target = FleetSpec;

    fn deref(&self) -> &FleetSpec {
        &self.fleet
    }
}
