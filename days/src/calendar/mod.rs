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
pub use matrix::{Matrix, PHASES, advanced};
pub use recorded::{Change, RecordedError, Recording};
pub use timeline::Timeline;
