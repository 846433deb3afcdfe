//! Hours and habits of things in four kinds of buildings, drawn from ranges. The ranges were set before any strategy was
//! tuned, and stay: every generated building with a calendar depends on them.

use crate::{DAY_S, HOUR_S, Habit, Hours, Stays};
use interfaces::RandomStream;

/// An interval; lengths and times are drawn uniformly in their logarithm.
pub type Range = [f64; 2];

const MIN_S: f64 = 60.0;
const ALL_DAYS: &[usize] = &[0, 1, 2, 3, 4, 5, 6];
const WEEKDAYS: &[usize] = &[0, 1, 2, 3, 4];
/// The share of stays that are long.
const LONG_SHARE: Range = [0.05, 0.5];
/// How long a thing that rests in quiet hours still waits before it does, s, and how long it then stays so.
const BEFORE_REST_S: Range = [5.0 * MIN_S, HOUR_S];
const REST_S: Range = [DAY_S, 10.0 * DAY_S];

/// The kind of a building.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// People are there in the morning, in the evening and on the weekend.
    Home,
    /// People are there in the hours of work; closed at night and on the weekend.
    Office,
    /// Large halls without doors between them, in two shifts from Monday to Saturday.
    Warehouse,
    /// Many rooms, busy during the day on all days, never quite still.
    Clinic,
}

/// What a thing is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThingKind {
    /// The door of a room; blocked: closed.
    Door,
    /// A place where a box or a cart often stands.
    Box,
    /// A place where a person often is.
    Person,
    /// A place where another robot parks.
    ParkedRobot,
}

/// What is drawn for a kind of building.
struct Ranges {
    /// Days, begin and end of active hours, which are jittered by an hour in each building.
    active: &'static [(&'static [usize], f64, f64)],
    /// How many times longer stays take in quiet hours than in active ones.
    quiet_factor: Range,
    /// The probability that a thing is put to rest in quiet hours: doors are closed, people and boxes go.
    rest_share: f64,
}

impl Kind {
    /// All kinds, with their names.
    pub const ALL: [(&'static str, Self); 4] = [
        ("home", Self::Home),
        ("office", Self::Office),
        ("warehouse", Self::Warehouse),
        ("clinic", Self::Clinic),
    ];

    /// The name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, kind)| *kind == self).map_or("", |(name, _)| *name)
    }

    fn ranges(self) -> Ranges {
        match self {
            Self::Home => Ranges {
                active: &[(WEEKDAYS, 6.5, 8.5), (WEEKDAYS, 16.0, 23.0), (&[5, 6], 8.5, 23.5)],
                quiet_factor: [5.0, 50.0],
                rest_share: 0.3,
            },
            Self::Office => {
                Ranges { active: &[(WEEKDAYS, 8.0, 18.0)], quiet_factor: [20.0, 200.0], rest_share: 0.8 }
            }
            Self::Warehouse => Ranges {
                active: &[(&[0, 1, 2, 3, 4, 5], 6.0, 22.0)],
                quiet_factor: [20.0, 200.0],
                rest_share: 0.2,
            },
            Self::Clinic => {
                Ranges { active: &[(ALL_DAYS, 7.0, 20.0)], quiet_factor: [2.0, 10.0], rest_share: 0.4 }
            }
        }
    }

    /// The hours in which a building of this kind is active.
    pub fn draw_hours(self, rng: &mut RandomStream) -> Hours {
        let mut hours = Hours::never();
        for (days, begin_h, end_h) in self.ranges().active {
            let [begin_h, end_h] = [begin_h, end_h].map(|hour| hour + rng.uniform(-1.0..1.0));
            days.iter().for_each(|day| hours.set(*day, begin_h, end_h.min(24.0), true));
        }
        hours
    }

    /// The habit of a thing in a building with these hours.
    pub fn draw_habit(self, thing: ThingKind, hours: &Hours, rng: &mut RandomStream) -> Habit {
        let ranges = self.ranges();
        let means = thing.stays().map(|range| log_uniform(range, rng));
        let mut stays = |first: usize| Stays {
            short_s: means[first],
            long_s: means[first + 1],
            long_share: rng.uniform(LONG_SHARE[0]..LONG_SHARE[1]),
        };
        let active = [stays(0), stays(2)];
        let factor = log_uniform(ranges.quiet_factor, rng);
        let slower =
            |stays: Stays| Stays { short_s: factor * stays.short_s, long_s: factor * stays.long_s, ..stays };
        let mut quiet = active.map(slower);
        if rng.bernoulli(ranges.rest_share) {
            // Doors rest closed, all else rests away.
            let at_rest = usize::from(thing == ThingKind::Door);
            quiet[at_rest] = Stays::of_mean(log_uniform(REST_S, rng));
            quiet[1 - at_rest] = Stays::of_mean(log_uniform(BEFORE_REST_S, rng));
        }
        Habit { hours: hours.clone(), active, quiet }
    }
}

impl ThingKind {
    /// Mean stays in active hours, s: free short, free long, blocked short, blocked long.
    fn stays(self) -> [Range; 4] {
        match self {
            Self::Door => [
                [MIN_S, 20.0 * MIN_S],
                [HOUR_S, 12.0 * HOUR_S],
                [MIN_S, 20.0 * MIN_S],
                [HOUR_S, 12.0 * HOUR_S],
            ],
            Self::Person => [
                [2.0 * MIN_S, 30.0 * MIN_S],
                [HOUR_S, 6.0 * HOUR_S],
                [MIN_S, 20.0 * MIN_S],
                [0.5 * HOUR_S, 4.0 * HOUR_S],
            ],
            Self::Box => [
                [0.5 * HOUR_S, 4.0 * HOUR_S],
                [6.0 * HOUR_S, 3.0 * DAY_S],
                [10.0 * MIN_S, 2.0 * HOUR_S],
                [3.0 * HOUR_S, 2.0 * DAY_S],
            ],
            Self::ParkedRobot => [
                [10.0 * MIN_S, HOUR_S],
                [HOUR_S, 5.0 * HOUR_S],
                [5.0 * MIN_S, HOUR_S],
                [HOUR_S, 8.0 * HOUR_S],
            ],
        }
    }
}

impl std::str::FromStr for Kind {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(name, _)| *name == word);
        let names = || Self::ALL.map(|(name, _)| name).join(", ");
        found.map(|(_, kind)| *kind).ok_or_else(|| format!("expected one of {}, found `{word}`", names()))
    }
}

/// A number whose logarithm is uniform in the range.
pub fn log_uniform([low, high]: Range, rng: &mut RandomStream) -> f64 {
    low * libm::exp(rng.uniform(0.0..1.0) * libm::log(high / low))
}
