//! The calendar of a generated building: the hours in which it is active, and the schedules of its things.

use calendar::{
    HOUR_S, Habit, Hours, Kind, PHASES, Range, Schedule, Stays, ThingKind, Timeline, WEEK_S, log_uniform,
};
use interfaces::{Purpose, RandomStream};
use rand::RngExt;

/// Weeks after which the state of a thing does not depend on that before them.
const WEEKS_BEFORE: f64 = 8.0;
/// What things that are two-state Markov chains draw their rates from. Frozen before anything was tuned on such worlds.
pub(crate) struct Chains {
    /// Mean stays, s; all orders of magnitude are equally likely.
    pub(crate) stays_s: Range,
    /// When all mean stays of a building change, if they do, hours after the start.
    change_h: Range,
}

/// For runs of two hours.
pub(crate) const ROOMS: Chains = Chains { stays_s: [10.0, 0.5 * HOUR_S], change_h: [0.5, 1.5] };
/// For runs of a day.
pub(crate) const ROOMS_DAY: Chains = Chains { stays_s: [10.0, 12.0 * HOUR_S], change_h: [8.0, 16.0] };
/// The probability that the mean stays of such a building change once.
const CHANGE_PROBABILITY: f64 = 0.25;

/// Draws the schedules of a building.
pub(crate) struct BuildingCalendar {
    habits: Habits,
    hours: Hours,
    /// Random numbers for what belongs to the calendar.
    pub(crate) rng: RandomStream,
}

/// What habits are drawn from.
enum Habits {
    Building(Kind),
    Chains(&'static Chains),
}

impl BuildingCalendar {
    /// The calendar of a building of a kind. Its random numbers are none of those of the building: the same walls as without a
    /// calendar.
    pub(crate) fn new(kind: Kind, seed: u64) -> Self {
        let mut rng = RandomStream::new(seed, Purpose::DayGenerator);
        Self { hours: kind.draw_hours(&mut rng), habits: Habits::Building(kind), rng }
    }

    /// A building whose things are two-state Markov chains.
    pub(crate) fn of_chains(chains: &'static Chains, seed: u64) -> Self {
        let mut rng = RandomStream::new(seed, Purpose::DayGenerator);
        let change_h = rng.uniform(chains.change_h[0]..chains.change_h[1]);
        let hours = match rng.bernoulli(CHANGE_PROBABILITY) {
            true => Hours::daily(&[0], 0.0, change_h), // rounded to half hours
            false => Hours::always(),
        };
        Self { hours, habits: Habits::Chains(chains), rng }
    }

    /// When all mean stays change, s after the start; infinite: never.
    pub(crate) fn change_s(&self) -> f64 {
        self.hours.next_switch_s(0.0)
    }

    /// A Markov chain, with this mean stay away, s, if one is given. Its state at the start is stationary.
    pub(crate) fn draw_chain(&mut self, chains: &Chains, away_s: Option<f64>) -> Schedule {
        let mut stays = || {
            let [free_s, blocked_s] =
                [(); 2].map(|()| (log_uniform(chains.stays_s, &mut self.rng) * 10.0).round() / 10.0);
            [away_s.unwrap_or(free_s), blocked_s].map(Stays::of_mean)
        };
        let active = stays();
        let later = stays();
        let quiet = if self.change_s().is_finite() { later } else { active };
        let [free_s, blocked_s] = active.map(|stays| stays.mean_s());
        let starts_blocked = self.rng.bernoulli(blocked_s / (free_s + blocked_s));
        Schedule { habit: Habit { hours: self.hours.clone(), active, quiet }, starts_blocked }
    }

    /// A schedule whose state at the start, Monday 0:00, is that of a thing that has done so for weeks.
    pub(crate) fn draw(&mut self, kind: ThingKind) -> Schedule {
        let mut habit = match self.habits {
            Habits::Building(building) => building.draw_habit(kind, &self.hours, &mut self.rng),
            Habits::Chains(chains) => return self.draw_chain(chains, None),
        };
        // A world file has short numbers.
        for stays in habit.active.iter_mut().chain(&mut habit.quiet) {
            let Stays { short_s, long_s, long_share } = *stays;
            let [short_s, long_s] = [short_s, long_s].map(|mean_s| (mean_s * 10.0).round() / 10.0);
            *stays = Stays { short_s, long_s, long_share: (long_share * 1000.0).round() / 1000.0 };
        }
        let starts_blocked = self.is_blocked_at_start(&habit);
        Schedule { habit, starts_blocked }
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
