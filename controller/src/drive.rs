use crate::{Costmap, Moves, Path, Restless, Situation};

/// What planning must know of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// The radius of its outline, m; 0 where a robot is as large as its cell.
    pub radius_m: f64,
    /// How it gets from cell to cell.
    pub moves: Moves,
    /// How fast it gets on, m/s.
    pub speed_mps: f64,
    /// It has arrived at a point when it is this near, m.
    pub tolerance_m: f64,
    /// The length of a step of local exploration, m: a robot's diameter, or a cell.
    pub stride_m: f64,
    /// The number of directions of a random step.
    pub directions: u32,
    /// A step of local exploration takes at least this long, s: to stay is a step, too.
    pub step_s: f64,
    /// A step that takes longer than this is over, wherever the robot has come, s.
    pub step_limit_s: f64,
}

/// All that a drive can look at when it chooses a command.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// What the controller was told.
    pub situation: &'a Situation<'a>,
    /// The map as the robot's centre meets it.
    pub costmap: &'a Costmap,
    /// What may move.
    pub restless: &'a Restless,
}

/// Turns paths into the commands of one world: the robot's known transition model (paper,
/// section 2).
pub trait Drive {
    /// What this world's robot can be told.
    type Command;

    /// What planning must know of the robot.
    fn body(&self) -> Body;

    /// The next command on the way along `path`, which has not yet come to its end. Never drives
    /// into what is sensed; stands still rather.
    fn follow(&mut self, scene: &Scene, path: &Path) -> Self::Command;

    /// The command to stay where the robot is.
    fn rest(&mut self, scene: &Scene) -> Self::Command;

    /// The next command of a manoeuvre that may free a robot which has got nowhere, `elapsed_s`
    /// after it began; `None` when the manoeuvre is over.
    fn recover(&mut self, scene: &Scene, elapsed_s: f64) -> Option<Self::Command>;
}
