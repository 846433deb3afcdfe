//! The loop of the robot, the pilots that decide in it, and the files of what it has learned. It must not
//! know any world, log, metric, screen or recording: users see the loop from outside, through a callback.
//!
//! ```text
//! source ──reading──▶ localizer ──posed reading──▶ mapper ──maps, changes──▶ agent ──goal──▶ controller ──command──▶ source
//! ```
//!
//! [`explore`] is this loop. It is the same for every [`World`] and for every [`Pilot`]. [`state`] saves what was learned
//! and where a run stopped, so that another run goes on from there.

mod autonomous;
mod build;
mod localization;
mod messages;
mod pilot;
mod session;
pub mod state;
mod tapped;
mod tour;

pub use autonomous::{Autonomous, Destination, GoalSelector};
pub use build::{BUILD, other_build};
pub use localization::{ExactPoses, Localization, Permission, Posed};
pub use messages::{Level, Message};
pub use pilot::{Belief, GoalCount, Pilot, StrategyState};
pub use session::Session;
pub use tapped::Tapped;
pub use tour::Tour;

use agent::Features;
use interfaces::{Reading, World};
use localizer::PoseState;
use mapper::{Mapper, ReadingError};
use std::ops::ControlFlow;

/// Runs the robot in `world` until `observe` breaks the loop. Returns the last command, which the world has not executed:
/// to go on, let the world execute it first.
///
/// A reading whose pose is not certain does not enter the map. `observe` is called once per reading, with the pose that
/// the robot uses: after the mapper has integrated the reading and the pilot has decided, and before the world executes
/// the command.
///
/// # Errors
///
/// When the mapper refuses a reading, or when `observe` fails.
pub fn explore<W, L, P, E>(
    world: &mut W,
    localization: &mut L,
    mapper: &mut Mapper,
    pilot: &mut P,
    mut observe: impl FnMut(&W, &W::Reading, &Belief, &mut P) -> Result<ControlFlow<()>, E>,
) -> Result<W::Command, E>
where
    W: World<Reading: Reading>,
    L: Localization<W::Reading> + ?Sized,
    P: Pilot<Command = W::Command>,
    E: From<ReadingError>,
{
    loop {
        let Posed { reading, estimate, permission, correction } =
            localization.localize(world.sense(), mapper);
        match estimate.as_ref().is_none_or(|estimate| estimate.state == PoseState::Tracking) {
            true => mapper.update(&reading)?,
            false => mapper.skip(&reading),
        }
        let (pose, estimate, features) = (reading.pose(), estimate.as_ref(), Features::of(mapper));
        let belief = Belief { pose, estimate, permission, correction, features, mapper };
        let command = pilot.command(&belief);
        if observe(world, &reading, &belief, pilot)?.is_break() {
            return Ok(command);
        }
        world.act(&command);
    }
}
