//! The drives: the properties of a robot that planning needs, and the conversion of a path into commands.

mod diff_drive;

pub use diff_drive::{DiffDrive, DiffDriveSettings};

use crate::driver::ControlInput;
use crate::dynamic_obstacles::DynamicObstacleFilter;
use crate::planner::{Costmap, InflationSettings, Moves, Path};
use interfaces::{Step, Values};

/// The properties of a robot that planning needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// The radius of the footprint, m; 0 where a robot is as large as its cell.
    pub radius_m: f64,
    /// The distance between paths and obstacles.
    pub inflation: InflationSettings,
    /// The moves from cell to cell.
    pub moves: Moves,
    /// The speed along a path, m/s.
    pub speed_mps: f64,
    /// The robot has arrived at a point if it is nearer than this, m.
    pub tolerance_m: f64,
    /// The length of a step of local exploration, m: the diameter of the robot, or a cell.
    pub step_m: f64,
    /// The number of directions of a random step.
    pub directions: u32,
    /// The minimum duration of a step of local exploration, s: to stay in place is a step, too.
    pub step_s: f64,
    /// The maximum duration of a step of local exploration, s.
    pub step_limit_s: f64,
    /// The maximum time for a goal, s; after that the goal is given up in any case.
    pub goal_timeout_s: f64,
}

/// The inputs of a drive when it chooses a command.
#[derive(Clone, Copy, Debug)]
pub struct DriveScene<'a> {
    /// The inputs of the controller.
    pub input: &'a ControlInput<'a>,
    /// The inflated map.
    pub costmap: &'a Costmap,
    /// The filter that states which obstacles may move.
    pub dynamic: &'a DynamicObstacleFilter,
}

/// Converts paths into the commands of one kind of robot: the known transition model of the robot (paper, section
/// 2).
pub trait Drive {
    /// A command of this kind of robot.
    type Command;

    /// The properties of the robot that planning needs.
    fn body(&self) -> Body;

    /// The next command along `path`; the robot has not reached the end of the path yet. If the way is blocked by a
    /// sensed obstacle, the robot stops.
    fn follow(&mut self, scene: &DriveScene, path: &Path) -> Self::Command;

    /// The command to stay at the present position.
    fn rest(&mut self, scene: &DriveScene) -> Self::Command;

    /// The command to look around: at the present position first, then from elsewhere.
    fn look_around(&mut self, scene: &DriveScene) -> Self::Command {
        self.rest(scene)
    }

    /// The next command of a recovery that may free a stuck robot, `elapsed_s` after the recovery began;
    /// `None` when the recovery is over.
    fn recover(&mut self, scene: &DriveScene, elapsed_s: f64) -> Option<Self::Command>;

    /// Everything that a command changes and a later command needs: what a state file holds of the drive. Empty for a
    /// drive that remembers nothing.
    fn values(&mut self) -> Values<'_> {
        Vec::new()
    }
}

/// The drive of a grid world: the robot is as large as its cell, and at each step it stays or moves to one of the
/// four cells that share a side. Cells are 1 m wide, and a step lasts 1 s.
#[derive(Clone, Copy, Debug, Default)]
pub struct CellDrive;

impl Drive for CellDrive {
    type Command = Step;

    fn body(&self) -> Body {
        Body {
            radius_m: 0.0,
            inflation: InflationSettings { footprint_padding_m: 0.0, inflation_m: 0.0, inflation_cost: 1 },
            moves: Moves::Four,
            speed_mps: 1.0,
            tolerance_m: 0.4,
            step_m: 1.0,
            directions: 4,
            step_s: 1.0,
            step_limit_s: 1.0,
            goal_timeout_s: 1e5, // no path needs it
        }
    }

    fn follow(&mut self, scene: &DriveScene, path: &Path) -> Step {
        let frame = scene.costmap.frame();
        let here = frame.cell_at(&scene.input.position());
        let next = path.ahead().first().map(|next| frame.cell_at(next));
        // The robot waits for a cell that became blocked, until there is another path.
        let free = next.filter(|next| scene.costmap.is_traversable(*next));
        free.and_then(|next| Step::between(here, next)).unwrap_or(Step::Stay)
    }

    fn rest(&mut self, _: &DriveScene) -> Step {
        Step::Stay
    }

    fn recover(&mut self, _: &DriveScene, _: f64) -> Option<Step> {
        None
    }
}
