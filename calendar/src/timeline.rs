use crate::{Habit, PHASES};
use interfaces::{RandomStream, Values, value};

/// What a thing really does, from event to event. It is the same however large the steps are in which time passes.
#[derive(Clone, Debug)]
pub struct Timeline {
    habit: Habit,
    phase: usize,
    rng: RandomStream,
    is_blocked: bool,
    next_s: f64,
}

impl Timeline {
    /// A thing that follows a habit from `start_s` on, s, in a phase drawn from `phases`.
    pub fn of_habit(habit: &Habit, phases: &[f64; PHASES], start_s: f64, mut rng: RandomStream) -> Self {
        let mut left = rng.uniform(0.0..1.0);
        let drawn = phases.iter().position(|share| {
            left -= share;
            left < 0.0
        });
        let phase = drawn.unwrap_or(PHASES - 1);
        let (habit, is_blocked) = (habit.clone(), phase >= PHASES / 2);
        let mut timeline = Self { habit, phase, rng, is_blocked, next_s: start_s };
        timeline.next_s = timeline.end_of_stay_s(start_s);
        timeline
    }

    /// The values that change, for a snapshot: they are read into a timeline of the same thing.
    pub fn values(&mut self) -> Values<'_> {
        let Self { habit: _, phase, rng, is_blocked, next_s } = self;
        vec![value(is_blocked), value(next_s), value(phase), value(rng)]
    }

    /// The state.
    pub fn is_blocked(&self) -> bool {
        self.is_blocked
    }

    /// When the state changes next, s; infinite if it never does.
    pub fn next_event_s(&self) -> f64 {
        self.next_s
    }

    /// Lets time pass to `time_s`: the changes at this time have happened. Calls `on_change` with the time and the new state of
    /// each change.
    pub fn advance(&mut self, time_s: f64, mut on_change: impl FnMut(f64, bool)) {
        while self.next_s <= time_s {
            let at_s = self.next_s;
            self.change(at_s);
            self.next_s = self.end_of_stay_s(at_s);
            on_change(at_s, self.is_blocked);
        }
    }

    /// Ends a stay, and draws whether the next one is short or long.
    fn change(&mut self, time_s: f64) {
        let other = 1 - self.phase / 2;
        let stays = &self.habit.stays(self.habit.hours.is_active(time_s))[other];
        self.phase = 2 * other + usize::from(self.rng.bernoulli(stays.long_share));
        self.is_blocked = other == 1;
    }

    /// The end of the stay that begins at `start_s`, s: a habit uses up a unit exponential at the rate of each time.
    fn end_of_stay_s(&mut self, start_s: f64) -> f64 {
        let (habit, mut time_s) = (&self.habit, start_s);
        let mut left = self.rng.exponential(1.0);
        loop {
            let is_active = habit.hours.is_active(time_s);
            let rate_hz = habit.end_rate_hz(self.phase, is_active);
            let end_s = time_s + left / rate_hz;
            let switch_s = habit.hours.next_switch_s(time_s);
            if end_s < switch_s {
                return end_s;
            }
            left -= (switch_s - time_s) * rate_hz;
            time_s = switch_s;
        }
    }
}
