//! A curious robot: it keeps a map of a place that changes, learns for every cell how often that
//! cell changes, and spends its time where looking is worth most.
//!
//! ```text
//! world ──observation──▶ mapper ──maps, changes──▶ agent ──goal──▶ controller ──command──▶ world
//! ```
//!
//! [`explore`] is that line. It is the same in every world and for every [`Pilot`]: the mapper,
//! the agent and the controller never learn which world they run in, and none of them knows that
//! a recording or a screen exists. Whoever watches does it from outside.

pub mod cell_statistics;
#[cfg(test)]
mod fake;
pub mod inspection;
pub mod layer;
pub mod metrics;
pub mod observer;
pub mod oracle;
pub mod output;
pub mod pictures;
pub mod pilot;
pub mod recording;
pub mod report;
pub mod ros_map;
pub mod summary;
pub mod trials;
pub mod view;
pub mod worlds;

use agent::Features;
use interfaces::{Reading, World};
use mapper::{Mapper, ReadingError};
use pilot::{Now, Pilot};
use std::ops::ControlFlow;

/// Lets the robot live in `world` until `watch` says that it is enough.
///
/// `watch` is called once per reading, after the map has taken it in and the pilot has decided,
/// and before the world obeys.
///
/// # Errors
///
/// When the world gives a reading that makes no sense, or when watching fails.
pub fn explore<W, P, E>(
    world: &mut W,
    mapper: &mut Mapper,
    pilot: &mut P,
    mut watch: impl FnMut(&W, &W::Reading, &Now, &mut P) -> Result<ControlFlow<()>, E>,
) -> Result<(), E>
where
    W: World<Reading: Reading>,
    P: Pilot<Command = W::Command>,
    E: From<ReadingError>,
{
    loop {
        let reading = world.sense();
        mapper.update(&reading)?;
        let now = Now { pose: reading.pose(), features: Features::of(mapper), mapper };
        let command = pilot.command(&now);
        if watch(world, &reading, &now, pilot)?.is_break() {
            return Ok(());
        }
        world.act(&command);
    }
}
