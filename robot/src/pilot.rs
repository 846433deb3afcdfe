use agent::{Features, StrategyState};
use interfaces::Values;
use localizer::{Correction, PoseEstimate, PoseState};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};
use serde::{Deserialize, Serialize};

/// The importance of a [`Message`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub enum Level {
    /// A decision of the robot.
    Decision,
    /// A change in the world, or the detection of a change.
    Event,
    /// A failure: a goal that was given up, a collision.
    Trouble,
}

/// A message of the log.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub struct Message {
    /// The importance of the message.
    pub level: Level,
    /// One sentence.
    pub text: String,
}

/// Decides the next command of the robot.
pub trait Pilot {
    /// The type of the commands that the world executes.
    type Command;

    /// The command until the next reading. The map contains the latest reading, if its pose was certain.
    fn command(&mut self, belief: &Belief, features: Features, mapper: &Mapper) -> Self::Command;

    /// Plans anew: the map is another one, with other cells than its transitions say.
    fn forget_map(&mut self) {}

    /// What others may know of the pilot.
    fn view(&self) -> PilotView<'_> {
        PilotView::default()
    }

    /// The strategies of the agent; empty without an agent.
    fn strategies(&self, _features: Features) -> Vec<StrategyState> {
        Vec::new()
    }

    /// The messages since the last call.
    fn take_messages(&mut self) -> Vec<Message> {
        Vec::new()
    }

    /// Everything that a reading changes and a later reading needs: what a state file holds of the pilot. `mapper` is that
    /// of the same state; what follows from it is not in the list. Empty for a pilot that remembers nothing.
    fn values(&mut self, _mapper: &Mapper) -> Values<'_> {
        Vec::new()
    }
}

/// What others may know of a pilot.
#[derive(Clone, Copy, Debug, Default)]
pub struct PilotView<'a> {
    /// The planned path, m; empty without a path.
    pub path: &'a [Point2<f64>],
    /// The position of the goal, m; `None` without a goal.
    pub goal: Option<Point2<f64>>,
    /// The number of goals so far, by outcome.
    pub goals: GoalCount,
    /// Whether the pilot has ended the run: a tour ends after its last waypoint, a user can end the run at any time.
    pub is_done: bool,
}

/// A pilot that gives no command: of a log, or of a robot that someone else drives.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoPilot;

impl Pilot for NoPilot {
    type Command = ();

    fn command(&mut self, _: &Belief, _: Features, _: &Mapper) {}
}

/// The number of goals by outcome.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
pub struct GoalCount {
    /// Goals that were reached.
    pub reached: u32,
    /// Goals that are blocked or hidden: the robot reached the nearest point that can be reached.
    pub approached: u32,
    /// Goals that were given up, because the robot made no progress.
    pub given_up: u32,
}

/// What the robot believes about its pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Belief {
    /// The pose that the robot uses, in the frame of the map, m and rad.
    pub pose: Isometry2<f64>,
    /// The estimate with its uncertainty; `None` if the source says that its poses are exact.
    pub estimate: Option<PoseEstimate>,
    /// What the robot may do with this pose.
    pub permission: Permission,
    /// If a loop was closed with this reading: the map was learned again with better poses, and has other cells than its
    /// [transitions](mapper::Mapper::transitions) say.
    pub correction: Option<Correction>,
}

impl Belief {
    /// The belief of a robot whose source says that its poses are exact.
    pub fn exact(pose: Isometry2<f64>) -> Self {
        Self { pose, estimate: None, permission: Permission::Drive, correction: None }
    }

    /// How far the pose can be trusted.
    pub fn state(&self) -> PoseState {
        self.estimate.as_ref().map_or(PoseState::Tracking, |estimate| estimate.state)
    }

    /// Whether the reading may enter the map.
    pub fn is_certain(&self) -> bool {
        self.state() == PoseState::Tracking
    }
}

/// What a robot may do, as far as its pose is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Permission {
    /// Drive to goals.
    #[default]
    Drive,
    /// Stand: the first scans at a start without a map should all be made from one pose.
    Rest,
    /// Look around, first in place, then from elsewhere: the robot is lost.
    LookAround,
}
