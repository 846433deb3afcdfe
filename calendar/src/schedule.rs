use crate::{Habit, Timeline};
use interfaces::RandomStream;

/// When a thing in a world changes its state.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// Its stays, hour by hour of the week.
    pub habit: Habit,
    /// Whether it is blocked (closed, present) at the start of the world.
    pub starts_blocked: bool,
}

impl Schedule {
    /// What a thing does in a world that starts at a time of the week, s. All randomness is that of `rng`.
    pub fn timeline(&self, starts_s: f64, rng: RandomStream) -> Timeline {
        let state = usize::from(self.starts_blocked);
        let long = self.habit.stays(self.habit.hours.is_active(starts_s))[state].long_share;
        let mut phases = [0.0; 4];
        (phases[2 * state], phases[2 * state + 1]) = (1.0 - long, long);
        Timeline::of_habit(&self.habit, &phases, starts_s, rng)
    }
}
