//! The robot: from a reading of its sensors to the next command, and the files of what it has learned. It must not know any
//! world, log, metric, screen or recording.
//!
//! ```text
//! reading ─▶ session ─▶ scan filter ─▶ localization ─▶ mapper ─▶ pilot ─▶ command
//! ```
//!
//! [`Robot::step`] is this line: simulators, grid worlds, logs, live robots, Gymnasium and Python give readings and take
//! commands. [`turn`] is one turn of the loop around it for a [`World`]. [`state`] saves what was learned and
//! where a run stopped, so that another run goes on from there.

mod autonomous;
mod build;
mod day;
mod pilot;
mod robot;
mod session;
mod settings;
pub mod state;
#[cfg(test)]
mod tests;
mod tour;

pub use agent::{GoalSelector, StrategyState};
pub use autonomous::Autonomous;
pub use build::BUILD;
pub use day::{Battery, DaySettings, DayTotals, PatrolDay};
pub use pilot::{Belief, GoalCount, Level, Message, NoPilot, Permission, Pilot, PilotView};
pub use robot::{ExactPoses, Localization, Robot, Turn};
pub use session::{Session, max_step_s};
pub use settings::{LOCAL_STEPS, Settings, Source, default_mapper};
pub use tour::Tour;

use interfaces::{Reading, World};
use mapper::ReadingError;

/// One turn of the loop: the world executes the last command, and the robot processes the next reading. The next command waits in
/// `command`, so that a run can be saved between two turns.
///
/// # Errors
///
/// When the mapper refuses the reading.
pub fn turn<W, P>(
    world: &mut W,
    robot: &mut Robot<W::Reading, P>,
    command: &mut Option<W::Command>,
) -> Result<Turn<W::Reading, W::Command>, ReadingError>
where
    W: World<Reading: Reading, Command: Clone>,
    P: Pilot<Command = W::Command>,
{
    if let Some(command) = command.take() {
        world.act(&command);
    }
    let turn = robot.step(world.sense())?;
    *command = Some(turn.command.clone());
    Ok(turn)
}
