//! Buildings of rooms along a hall, with things that change and viewpoints from which they are seen.

mod generate;
mod ranges;

use crate::STEP_S;
use crate::calendar::Habit;
pub use crate::calendar::{Kind, ThingKind};

/// A thing with two states.
#[derive(Clone, Debug, PartialEq)]
pub struct Thing {
    /// What it is.
    pub kind: ThingKind,
    /// When it changes.
    pub habit: Habit,
}

/// Where a robot can look from.
#[derive(Clone, Debug, PartialEq)]
pub struct Viewpoint {
    /// The room that it lies in; `None` in the hall.
    pub room: Option<usize>,
    /// The things whose state is seen from it.
    pub sees: Vec<usize>,
}

/// A room beside the hall.
#[derive(Clone, Debug, PartialEq)]
pub struct Room {
    /// The thing that is its door; `None` where the passage is always open.
    pub door: Option<usize>,
    /// The viewpoint in the hall that the door is seen from.
    pub threshold: usize,
}

/// A building with a calendar.
#[derive(Clone, Debug, PartialEq)]
pub struct Building {
    /// The things that change.
    pub things: Vec<Thing>,
    /// The rooms beside the hall.
    pub rooms: Vec<Room>,
    /// The viewpoints.
    pub viewpoints: Vec<Viewpoint>,
    /// The viewpoint, in the hall, at which the robot charges.
    pub dock: usize,
    /// The number of steps to go from one viewpoint (row) to another one (column) and look; 1 or more.
    pub steps: Vec<Vec<usize>>,
}

impl Building {
    /// The door that must be open to get from one viewpoint to another one. A robot in a room is let out by a person.
    pub fn door_between(&self, from: usize, to: usize) -> Option<usize> {
        let room = self.viewpoints[to].room?;
        if self.viewpoints[from].room == Some(room) { None } else { self.rooms[room].door }
    }

    /// The viewpoint that a robot reaches on its way to another one when doors are closed as in `is_blocked`: where the room
    /// is closed, the place in front of its door.
    pub fn reached(&self, from: usize, to: usize, is_blocked: &[bool]) -> usize {
        match (self.door_between(from, to), self.viewpoints[to].room) {
            (Some(door), Some(room)) if is_blocked[door] => self.rooms[room].threshold,
            _ => to,
        }
    }

    /// The number of steps of a travel time and the look after it, s.
    fn steps_of(time_s: f64) -> usize {
        ((time_s / STEP_S).ceil() as usize).max(1)
    }
}
