use crate::{Habit, Timeline};
use interfaces::RandomStream;

/// When a thing in a world changes its state.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// When it changes.
    pub changes: Changes,
    /// Whether it is blocked (closed, present) at the start of the world.
    pub starts_blocked: bool,
}

/// Why a thing changes.
#[derive(Clone, Debug, PartialEq)]
pub enum Changes {
    /// It follows a habit.
    Habit(Habit),
    /// It repeats what was recorded: the times since the start of the world, s, in ascending order, and the new states.
    Recorded(Vec<(f64, bool)>),
}

impl Schedule {
    /// A thing that repeats recorded changes: times since the start of the world, s, and the new states. Before the first
    /// change it is free.
    pub fn recorded(changes: Vec<(f64, bool)>) -> Self {
        let before = changes.iter().take_while(|(time_s, _)| *time_s <= 0.0);
        let starts_blocked = before.last().is_some_and(|(_, is_blocked)| *is_blocked);
        Self { changes: Changes::Recorded(changes), starts_blocked }
    }

    /// What a thing does in a world that starts at a time of the week, s. All randomness is that of `rng`.
    pub fn timeline(&self, starts_s: f64, rng: RandomStream) -> Timeline {
        match &self.changes {
            Changes::Recorded(changes) => {
                let shifted: Vec<(f64, bool)> =
                    changes.iter().map(|(time_s, state)| (time_s + starts_s, *state)).collect();
                let mut timeline = Timeline::recorded(&shifted);
                timeline.advance(starts_s, |_, _| ());
                timeline
            }
            Changes::Habit(habit) => {
                let state = usize::from(self.starts_blocked);
                let long = habit.stays(habit.hours.is_active(starts_s))[state].long_share;
                let mut phases = [0.0; 4];
                (phases[2 * state], phases[2 * state + 1]) = (1.0 - long, long);
                Timeline::of_habit(habit, &phases, starts_s, rng)
            }
        }
    }
}
