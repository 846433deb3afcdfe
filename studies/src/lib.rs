//! Studies behind pages of the documentation. They are no part of the product: nothing depends on them, they are not built
//! by default, and `.ci/nightly` tests them.
//!
//! This library has places with a calendar, and robots that patrol them: buildings of rooms and viewpoints in which things
//! with two states (doors, boxes, seats, parked robots) change by hour and weekday; a robot with a battery; strategies that
//! choose where to look next; and a [bound](freshness_bound) of what any strategy can reach. The programs `patrols`,
//! `physics_patrols` and `real_series` print the rows of the pages `docs/strategies.md` and `docs/things.md`, and `trips` those of
//! `docs/predict.md`.
//!
//! There are no cells here: from a viewpoint a robot sees the state of a set of things, and a closed door keeps it from
//! the viewpoints of a room. So a week takes a fraction of a second, and strategies can be compared over hundreds of
//! buildings.
//!
//! ```
//! use studies::{Building, Duty, Kind, Patrol, Plan};
//!
//! let building = Building::generate(Kind::Office, 7);
//! let mut strategy = Plan::Gain.strategy(&building, Duty::share(0.05));
//! let mut errors = 0.0;
//! let mut patrol = Patrol::new(&building, Duty::share(0.05), 1);
//! patrol.run(strategy.as_mut(), 8640, |beliefs, is_blocked| {
//!     let error = |(p, x): (&f64, &bool)| (p - f64::from(u8::from(*x))).powi(2);
//!     errors += beliefs.iter().zip(is_blocked).map(error).sum::<f64>();
//! });
//! assert!(errors / (8640 * building.things.len()) as f64 <= 0.25);
//! ```

mod belief;
mod building;
pub mod freshness_bound;
mod law;
mod learner;
mod patrol;
pub mod pays;
pub mod rows;
mod user_regret;

/// Things with two states, and the laws of their habits.
pub mod calendar {
    pub use crate::law::*;
    pub use ::calendar::*;
}

pub use belief::{Belief, Model};
pub use building::{Building, Kind, Room, Thing, ThingKind, Viewpoint};
pub use patrol::{Choice, Duty, Habits, Patrol, Plan, Seen, Strategy, Totals, View};
pub use user_regret::{Routes, UserRegret, Way};

/// The step of beliefs, looks and scores, s. Things change at any time between.
pub const STEP_S: f64 = 10.0;

/// The number of steps of a slot of the calendar.
const SLOT_STEPS: usize = (calendar::SLOT_S / STEP_S) as usize;
