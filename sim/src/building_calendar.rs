//! The calendar of a generated building: the hours in which it is active, and the schedules of its things.

use calendar::{Changes, Habit, Hours, Kind, PHASES, Schedule, Stays, ThingKind, Timeline, WEEK_S};
use interfaces::{Purpose, RandomStream};
use rand::RngExt;

/// Weeks after which the state of a thing does not depend on that before them.
const WEEKS_BEFORE: f64 = 8.0;

/// Draws the schedules of a building.
pub(crate) struct BuildingCalendar {
    kind: Kind,
    hours: Hours,
    /// Random numbers for what belongs to the calendar.
    pub(crate) rng: RandomStream,
}

impl BuildingCalendar {
    /// The calendar of a building of a kind. Its random numbers are none of those of the building: the same walls as without a
    /// calendar.
    pub(crate) fn new(kind: Kind, seed: u64) -> Self {
        let mut rng = RandomStream::new(seed, Purpose::DayGenerator);
        Self { hours: kind.draw_hours(&mut rng), kind, rng }
    }

    /// A schedule whose state at the start, Monday 0:00, is that of a thing that has done so for weeks.
    pub(crate) fn draw(&mut self, kind: ThingKind) -> Schedule {
        let mut habit = self.kind.draw_habit(kind, &self.hours, &mut self.rng);
        // A world file has short numbers.
        for stays in habit.active.iter_mut().chain(&mut habit.quiet) {
            let Stays { short_s, long_s, long_share } = *stays;
            let [short_s, long_s] = [short_s, long_s].map(|mean_s| (mean_s * 10.0).round() / 10.0);
            *stays = Stays { short_s, long_s, long_share: (long_share * 1000.0).round() / 1000.0 };
        }
        let starts_blocked = self.is_blocked_at_start(&habit);
        Schedule { changes: Changes::Habit(habit), starts_blocked }
    }

    fn is_blocked_at_start(&mut self, habit: &Habit) -> bool {
        let phases = [1.0 / PHASES as f64; PHASES];
        let mut before = Timeline::of_habit(habit, &phases, -WEEKS_BEFORE * WEEK_S, self.rng.clone());
        before.advance(0.0, |_, _| ());
        // The next thing has other numbers.
        self.rng.random::<u64>();
        before.is_blocked()
    }
}
