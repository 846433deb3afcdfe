use crate::{Habit, PHASES};
use interfaces::{RandomStream, Values, converted, value};

/// What a thing really does, from event to event. It is the same however large the steps are in which time passes.
#[derive(Clone, Debug)]
pub struct Timeline {
    source: Source,
    is_blocked: bool,
    next_s: f64,
}

#[derive(Clone, Debug)]
enum Source {
    Habit {
        habit: Box<Habit>,
        phase: usize,
        rng: Box<RandomStream>,
    },
    /// The changes that are still to come, the next one last.
    Recorded(Vec<(f64, bool)>),
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
        let mut source = Source::Habit { habit: Box::new(habit.clone()), phase, rng: Box::new(rng) };
        let next_s = source.end_of_stay_s(start_s);
        Self { is_blocked: phase >= PHASES / 2, source, next_s }
    }

    /// A thing that repeats recorded changes (time, s, and the new state) in the order of time; free before the first one.
    pub fn recorded(changes: &[(f64, bool)]) -> Self {
        let source = Source::Recorded(changes.iter().rev().copied().collect());
        let next_s = source.recorded_s();
        Self { source, is_blocked: false, next_s }
    }

    /// The values that change, for a snapshot: they are read into a timeline of the same thing.
    pub fn values(&mut self) -> Values<'_> {
        let mut values = vec![value(&mut self.is_blocked), value(&mut self.next_s)];
        match &mut self.source {
            Source::Habit { phase, rng, .. } => values.extend([value(phase), value(rng.as_mut())]),
            Source::Recorded(changes) => values.push(converted(changes, Vec::len, |changes, left| {
                changes.truncate(left);
                Ok(())
            })),
        }
        values
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
            self.is_blocked = self.source.change(at_s, self.is_blocked);
            self.next_s = self.source.end_of_stay_s(at_s);
            on_change(at_s, self.is_blocked);
        }
    }
}

impl Source {
    fn recorded_s(&self) -> f64 {
        match self {
            Self::Recorded(changes) => changes.last().map_or(f64::INFINITY, |change| change.0),
            Self::Habit { .. } => f64::INFINITY,
        }
    }

    /// Ends a stay, and draws whether the next one is short or long. Returns the new state.
    fn change(&mut self, time_s: f64, is_blocked: bool) -> bool {
        match self {
            Self::Recorded(changes) => changes.pop().map_or(is_blocked, |(_, is_blocked)| is_blocked),
            Self::Habit { habit, phase, rng } => {
                let other = 1 - *phase / 2;
                let stays = &habit.stays(habit.hours.is_active(time_s))[other];
                *phase = 2 * other + usize::from(rng.bernoulli(stays.long_share));
                other == 1
            }
        }
    }

    /// The end of the stay that begins at `start_s`, s: a habit uses up a unit exponential at the rate of each time.
    fn end_of_stay_s(&mut self, start_s: f64) -> f64 {
        let Self::Habit { habit, phase, rng } = self else { return self.recorded_s() };
        let mut time_s = start_s;
        let mut left = rng.exponential(1.0);
        loop {
            let is_active = habit.hours.is_active(time_s);
            let rate_hz = habit.end_rate_hz(*phase, is_active);
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
