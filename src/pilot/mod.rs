//! Who drives: the agent, a list of waypoints, or a person at the keyboard.

mod autonomous;
mod keyboard;
mod tour;

pub use autonomous::{Autonomous, Guide, Visit};
pub use keyboard::{Keyboard, KeyboardError};
pub use tour::{Tour, TourError};

use crate::view::Message;
use agent::Features;
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};
use serde::Serialize;

/// What a pilot knows when it has to decide.
#[derive(Clone, Copy, Debug)]
pub struct Now<'a> {
    /// Where the robot believes it is.
    pub pose: &'a Isometry2<f64>,
    /// What the agent judges its situation by.
    pub features: Features,
    /// The map, with this reading in it.
    pub mapper: &'a Mapper,
}

/// Turns what is known into the robot's next command.
pub trait Pilot {
    /// What the world obeys.
    type Command;

    /// What to do until the next reading.
    fn command(&mut self, now: &Now) -> Self::Command;

    /// The path it follows, m; empty without one.
    fn path(&self) -> &[Point2<f64>] {
        &[]
    }

    /// Where it wants to be, m.
    fn goal(&self) -> Option<Point2<f64>> {
        None
    }

    /// Its strategies, for one that has some.
    fn strategies(&self, _features: Features) -> Vec<StrategyState> {
        Vec::new()
    }

    /// How its goals ended so far.
    fn goals(&self) -> GoalCount {
        GoalCount::default()
    }

    /// What it decided since the last call.
    fn take_messages(&mut self) -> Vec<Message> {
        Vec::new()
    }

    /// Whether it wants to stop: a tour that is over, a person who has seen enough.
    fn is_done(&self) -> bool {
        false
    }
}

/// How goals ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct GoalCount {
    /// The robot came to the goal, or as near to it as can be reached.
    pub reached: u32,
    /// Of these, how many were only reached as nearly as can be.
    pub nearest: u32,
    /// The robot got nowhere for too long.
    pub given_up: u32,
}

/// One strategy of the agent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrategyState {
    /// Its name on the command line.
    pub name: &'static str,
    /// What the agent expects of it here; `None` where nothing is learned.
    pub value: Option<f64>,
    /// Share of the goals so far that it chose.
    pub share: f64,
    /// Whether it chose the present goal.
    pub is_current: bool,
}
