//! Navigation to a goal, in addition to planning: replanning, waiting, recovery, and local exploration at the goal.

mod local_exploration;
mod task;

pub(crate) use local_exploration::{LocalExploration, random_step};
pub(crate) use task::{NavigationTask, Progress, Surroundings, Tick};
