//! The loop of the robot, and the pilots that decide in it.
//!
//! ```text
//! source ──reading──▶ mapper ──maps, changes──▶ agent ──goal──▶ controller ──command──▶ source
//! ```
//!
//! [`explore`] is this loop. It is the same for every [`World`] and for every [`Pilot`]. This crate does not
//! know any world, metric, file, screen or recording: users see the loop from outside, through a callback.

mod autonomous;
mod messages;
mod pilot;
mod tour;

pub use autonomous::{Autonomous, Destination, GoalSelector};
pub use messages::{Level, Message};
pub use pilot::{Belief, GoalCount, Pilot, StrategyState};
pub use tour::Tour;

use agent::Features;
use interfaces::{Reading, World};
use mapper::{Mapper, ReadingError};
use std::ops::ControlFlow;

/// Runs the robot in `world` until `observe` breaks the loop.
///
/// `observe` is called once per reading: after the mapper has integrated the reading and the pilot has
/// decided, and before the world executes the command.
///
/// # Errors
///
/// When the mapper refuses a reading, or when `observe` fails.
pub fn explore<W, P, E>(
    world: &mut W,
    mapper: &mut Mapper,
    pilot: &mut P,
    mut observe: impl FnMut(&W, &W::Reading, &Belief, &mut P) -> Result<ControlFlow<()>, E>,
) -> Result<(), E>
where
    W: World<Reading: Reading>,
    P: Pilot<Command = W::Command>,
    E: From<ReadingError>,
{
    loop {
        let reading = world.sense();
        mapper.update(&reading)?;
        let belief = Belief { pose: reading.pose(), features: Features::of(mapper), mapper };
        let command = pilot.command(&belief);
        if observe(world, &reading, &belief, pilot)?.is_break() {
            return Ok(());
        }
        world.act(&command);
    }
}
