//! The managed lifecycle of ROS 2 (design.ros2.org/articles/node_lifecycle.html), in one table.

use crate::service::wire::{Labelled, Transition};

/// What a managed node does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum State {
    /// Nothing: it has no map, and most parameters can be set.
    Unconfigured,
    /// It has a map, takes no scans, and publishes nothing of the robot.
    Inactive,
    /// All that it is for.
    Active,
    /// Nothing, until the program ends.
    Finalized,
}

use State::{Active, Finalized, Inactive, Unconfigured};

/// A transition that a manager can ask for: its number, its name, the states before and after it.
type Row = (u8, &'static str, State, State);

#[rustfmt::skip]
const TRANSITIONS: [Row; 7] = [
    (1, "configure",  Unconfigured, Inactive),
    (2, "cleanup",    Inactive,     Unconfigured),
    (3, "activate",   Inactive,     Active),
    (4, "deactivate", Active,       Inactive),
    (5, "shutdown",   Unconfigured, Finalized),
    (6, "shutdown",   Inactive,     Finalized),
    (7, "shutdown",   Active,       Finalized),
];

impl State {
    const ALL: [Self; 4] = [Unconfigured, Inactive, Active, Finalized];

    /// Its number and name.
    pub(crate) fn labelled(self) -> Labelled {
        match self {
            Unconfigured => labelled(1, "unconfigured"),
            Inactive => labelled(2, "inactive"),
            Active => labelled(3, "active"),
            Finalized => labelled(4, "finalized"),
        }
    }

    /// All states.
    pub(crate) fn all() -> Vec<Labelled> {
        Self::ALL.into_iter().map(Self::labelled).collect()
    }

    /// The state after a transition, and the transition; `None` if it does not begin in this state. A name goes before a number, as in
    /// `rcl_lifecycle`.
    pub(crate) fn after(self, asked: &Labelled) -> Option<(Self, Transition)> {
        let is_asked = |(id, label, from, _): &&Row| {
            let is_named = if asked.label.is_empty() { *id == asked.id } else { *label == asked.label };
            *from == self && is_named
        };
        TRANSITIONS.iter().find(is_asked).map(|row| (row.3, transition(row)))
    }

    /// The transitions that begin in this state.
    pub(crate) fn transitions(self) -> Vec<Transition> {
        TRANSITIONS.iter().filter(|(_, _, from, _)| *from == self).map(transition).collect()
    }

    /// All transitions.
    pub(crate) fn graph() -> Vec<Transition> {
        TRANSITIONS.iter().map(transition).collect()
    }
}

fn transition((id, label, from, to): &Row) -> Transition {
    let (start_state, goal_state) = (from.labelled(), to.labelled());
    Transition { transition: labelled(*id, label), start_state, goal_state }
}

/// A number and a name on the wire.
fn labelled(id: u8, label: &str) -> Labelled {
    Labelled { id, label: label.to_owned() }
}
