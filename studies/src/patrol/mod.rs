//! A robot on its rounds: a battery, a dock, looks, and what it believes.

mod coverage;
mod curious;
mod demand;
mod duty;
mod fixed_length;
mod gain;
mod knowledge;
mod plan;
mod robot;
mod round;
mod view;

pub use duty::Duty;
pub use knowledge::Habits;
pub use plan::Plan;
pub use robot::{Patrol, Totals};
pub use view::{Choice, Seen, Strategy, View};
