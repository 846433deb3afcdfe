//! Things with two states that change by the time of the week: their hours, their habits, and what they really do. It must
//! not know what the things are, or where.
//!
//! A time is in s since a Monday, 0:00, in local civil time.
//!
//! ```
//! use calendar::{Habit, Hours, Schedule, Stays, WEEK_S, time_of_week_s};
//! use interfaces::{Purpose, RandomStream};
//!
//! let mut hours = Hours::never();
//! hours.add("Mon-Fri 8:00-18:00")?;
//! let habit = Habit {
//!     hours,
//!     active: [Stays::of_mean(1200.0), Stays::of_mean(600.0)],
//!     quiet: [Stays::of_mean(300.0), Stays::of_mean(1e6)],
//! };
//! let door = Schedule { habit, starts_blocked: true };
//! let starts_s = time_of_week_s("Mon 7:00")?;
//! let mut timeline = door.timeline(starts_s, RandomStream::new(7, Purpose::Thing(0)));
//! let mut openings = 0;
//! timeline.advance(starts_s + WEEK_S, |_, is_closed| openings += u32::from(!is_closed));
//! assert!(openings > 50);
//! # Ok::<(), String>(())
//! ```

mod drawn;
mod habit;
mod hours;
mod schedule;
mod text;
mod timeline;

pub use drawn::{Kind, Range, ThingKind, log_uniform};
pub use habit::{Habit, PHASES, Stays};
pub use hours::{DAY_S, HOUR_S, Hours, SLOT_S, WEEK_S};
pub use schedule::Schedule;
pub use text::{moment, time_of_week_s};
pub use timeline::Timeline;
