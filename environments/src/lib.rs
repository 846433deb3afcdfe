//! A task for learners: driving to goals among moving things. It must not know the interfaces of Gymnasium or PettingZoo,
//! which the Python package adds.
//!
//! A [`Drive`] is one world with its rewards. A [`Batch`] steps many tasks with one call, on several threads; a task
//! that is over is reset in the same call. The same seeds and actions give the same bits, alone or in a batch, on any
//! number of threads.
//!
//! ```
//! use environments::{Batch, Drive, DrivePlace, DriveSettings};
//! use std::sync::Arc;
//!
//! let spec = environments::driving_hall();
//! let place = Arc::new(DrivePlace::new(&spec, DriveSettings::default())?);
//! let mut batch = Batch::new((0..4).map(|_| Drive::new(&place)));
//! batch.reset(&[1, 2, 3, 4])?;
//! let results = batch.step(&[1.0, 0.0].repeat(4), &[5, 6, 7, 8])?;
//! assert_eq!(results.observations.len(), 4 * batch.observation_len());
//! assert!(results.rewards.iter().all(|reward| reward.is_finite()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod batch;
mod distance;
mod drive;
mod memory;
mod place;
mod results;

pub use batch::Batch;
pub use drive::Drive;
pub use place::{DrivePlace, DriveSettings};
pub use results::{ACTIONS, Results, TaskError};

use sim::physics::FleetSpec;

/// The text of the world in which robots learn to drive by default.
pub const DRIVING_HALL: &str = include_str!("../worlds/driving_hall.toml");

/// The world in which robots learn to drive by default: four rooms with doorways, and things that move.
pub fn driving_hall() -> FleetSpec {
    worldfile::physics::parse_fleet("driving_hall.toml", DRIVING_HALL)
        .unwrap_or_else(|error| unreachable!("a test loads this world: {error}"))
}
