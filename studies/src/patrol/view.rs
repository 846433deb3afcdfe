use super::duty::Duty;
use crate::belief::{Belief, Model};
use crate::building::Building;
use interfaces::RandomStream;

/// A door that was closed is tried again after this time, steps: ten minutes.
const RETRY_STEPS: usize = 60;

/// What a robot does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// It goes to a viewpoint and looks; at the same viewpoint it looks again.
    Go(usize),
    /// It goes to the dock, if it is not there, and rests for this number of steps, at least one.
    Rest(usize),
}

/// What a strategy knows when it chooses.
pub struct View<'a> {
    /// The number of steps since Monday, 0:00.
    pub step: usize,
    /// The viewpoint of the robot.
    pub at: usize,
    /// Whether the robot is at rest in the dock.
    pub is_docked: bool,
    /// What is left in the battery, in steps of driving and looking.
    pub charge_steps: f64,
    /// How much the robot can patrol.
    pub duty: Duty,
    /// The building.
    pub building: &'a Building,
    /// The models of the habits of the things.
    pub models: &'a [Model],
    /// Whether the models change, as the robot learns.
    pub is_learning: bool,
    /// What the robot believes about the things.
    pub beliefs: &'a [Belief],
    /// The state of each thing at the last look at it; free before the first one.
    pub last_states: &'a [bool],
    /// The step of the last look at each thing; `None` before the first one.
    pub seen: &'a [Option<usize>],
}

impl View<'_> {
    /// Whether the battery is enough for a visit to a viewpoint and the return to the dock.
    pub fn is_allowed(&self, viewpoint: usize) -> bool {
        let Building { steps, dock, rooms, viewpoints, .. } = self.building;
        let charge = |by: usize| (steps[self.at][by] + steps[by][*dock]) as f64;
        let threshold = viewpoints[viewpoint].room.map_or(viewpoint, |room| rooms[room].threshold);
        charge(viewpoint).max(charge(threshold)) <= self.charge_steps
    }

    /// Whether a visit is allowed and no closed door is known to be on the way: none was seen closed in the last ten minutes.
    pub fn is_open(&self, viewpoint: usize) -> bool {
        let door = self.building.door_between(self.at, viewpoint);
        let is_closed = door.is_some_and(|door| self.last_states[door] && self.age(door) < RETRY_STEPS);
        self.is_allowed(viewpoint) && !is_closed
    }

    /// The time since a thing was last seen, steps; since the beginning where it was not.
    pub fn age(&self, thing: usize) -> usize {
        self.step - self.seen[thing].unwrap_or(0)
    }

    /// The probability that a viewpoint is reached: that its door is open.
    pub fn reach(&self, from: usize, to: usize) -> f64 {
        self.building.door_between(from, to).map_or(1.0, |door| 1.0 - self.beliefs[door].probability())
    }
}

/// What a robot saw from the viewpoint that it reached.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// The number of steps since Monday, 0:00.
    pub step: usize,
    /// The viewpoint that the robot went for.
    pub goal: usize,
    /// The viewpoint that it reached.
    pub reached: usize,
    /// The number of steps of the way and the look.
    pub steps: usize,
    /// The things that were seen, each with the step of the look before, if any.
    pub things: &'a [(usize, Option<usize>)],
    /// How many of them were not as last seen.
    pub changes: usize,
}

/// Chooses where a robot looks next, and when it rests.
pub trait Strategy {
    /// What to do. A visit that the battery [does not allow](View::is_allowed) becomes a rest.
    fn choose(&mut self, view: &View<'_>, rng: &mut RandomStream) -> Choice;

    /// Learns from what was seen.
    fn learn(&mut self, _seen: &Seen<'_>) {}
}
