//! Things with two states that change by the time of the week: their hours, their habits, and what they really do.
//!
//! A time is in s since a Monday, 0:00, in local civil time.

mod habit;
mod hours;
mod matrix;
mod recorded;
mod timeline;

pub use habit::{Habit, Phases, Stays, blocked_probability};
pub use hours::{DAY_S, HOUR_S, Hours, SLOT_S, WEEK_S};
pub(crate) use matrix::product;
pub use matrix::{Matrix, PHASES, advanced};
pub use recorded::{Change, RecordedError, Recording};
pub use timeline::Timeline;

/// The number of steps of a slot.
pub(crate) const SLOT_STEPS: usize = (SLOT_S / crate::STEP_S) as usize;
