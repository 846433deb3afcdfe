//! The drives: what planning must know of a robot, and how a path becomes the commands of its world.

mod cell_drive;
mod diff_drive;

pub use cell_drive::CellDrive;
pub use diff_drive::{DiffDrive, DiffDriveSettings};

use crate::dynamic_obstacles::DynamicObstacleFilter;
use crate::planner::{Costmap, Moves, Path};
use crate::situation::Situation;

/// What planning must know of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// The radius of the footprint, m; 0 where a robot is as large as its cell.
    pub radius_m: f64,
    /// The moves from cell to cell.
    pub moves: Moves,
    /// The speed along a path, m/s.
    pub speed_mps: f64,
    /// The distance to a point at which the robot has arrived there, m.
    pub tolerance_m: f64,
    /// The length of a step of local exploration, m: the diameter of the robot, or a cell.
    pub step_m: f64,
    /// The number of directions of a random step.
    pub directions: u32,
    /// The shortest time of a step of local exploration, s: to stay is a step, too.
    pub step_s: f64,
    /// The longest time of a step of local exploration, s.
    pub step_limit_s: f64,
}

/// The inputs of a drive when it chooses a command.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// The inputs of the controller.
    pub situation: &'a Situation<'a>,
    /// The inflated map.
    pub costmap: &'a Costmap,
    /// Which obstacles may move.
    pub dynamic: &'a DynamicObstacleFilter,
}

/// Turns paths into the commands of one kind of robot: its known transition model (paper, section 2).
pub trait Drive {
    /// A command of this kind of robot.
    type Command;

    /// What planning must know of the robot.
    fn body(&self) -> Body;

    /// The next command along `path`, whose end is not reached yet. The robot stands still rather than
    /// drive into a sensed obstacle.
    fn follow(&mut self, scene: &Scene, path: &Path) -> Self::Command;

    /// The command to stay at the present position.
    fn rest(&mut self, scene: &Scene) -> Self::Command;

    /// The next command of a recovery that may free a stuck robot, `elapsed_s` after the recovery began;
    /// `None` when the recovery is over.
    fn recover(&mut self, scene: &Scene, elapsed_s: f64) -> Option<Self::Command>;
}
