//! The clock against things whose law is known.

mod calibration;

use super::*;
use proptest::prelude::*;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::Distribution;

const MINUTE_S: f64 = 60.0;
/// Monday, 2024-01-01, 0:00 UTC.
const MONDAY_S: f64 = 1_704_067_200.0;

/// A two-state Markov chain in steps of a minute: the probabilities per step of becoming blocked and free.
struct Chain {
    leave: [f64; 2],
    is_blocked: bool,
    rng: ChaCha8Rng,
}

impl Chain {
    fn new(leave: [f64; 2], seed: u64) -> Self {
        Self { leave, is_blocked: false, rng: ChaCha8Rng::seed_from_u64(seed) }
    }

    fn step(&mut self) -> bool {
        let leave = self.leave[usize::from(self.is_blocked)];
        self.is_blocked ^= self.rng.random_bool(leave);
        self.is_blocked
    }

    fn probability(&self, steps: i32) -> f64 {
        let sum = self.leave[0] + self.leave[1];
        let share = self.leave[0] / sum;
        share + (f64::from(u8::from(self.is_blocked)) - share) * (1.0 - sum).powi(steps)
    }
}

/// The root mean square difference between the clock and the true probability, over the last tenth of `days`.
fn error_of_chain(calendar: &Calendar, days: u32, ahead: i32, look_every: u32) -> f64 {
    let (mut clock, mut chain) = (Clock::default(), Chain::new([0.005, 0.015], 3));
    let (mut sum, mut n) = (0.0, 0.0);
    let steps = days * 1440;
    for step in 0..steps {
        let is_blocked = chain.step();
        let time_s = MONDAY_S + MINUTE_S * f64::from(step);
        if step % look_every == 0 {
            clock.observe(Look { time_s, is_blocked }, calendar);
            if step > steps / 10 * 9 {
                let truth = chain.probability(ahead);
                let found = clock.probability(time_s + MINUTE_S * f64::from(ahead), calendar);
                sum += (found - truth) * (found - truth);
                n += 1.0;
            }
        }
    }
    libm::sqrt(sum / n)
}

#[test]
fn a_markov_chain_is_predicted_as_one() {
    for calendar in [Calendar::Relative, Calendar::UTC] {
        // The limits are the errors that were measured, and a half more; far ahead the mean of 40 days is uncertain.
        for (ahead, look_every, limit) in
            [(1, 1, 0.008), (30, 1, 0.04), (600, 1, 0.06), (30, 20, 0.04), (600, 20, 0.06)]
        {
            let error = error_of_chain(&calendar, 40, ahead, look_every);
            assert!(error < limit, "{calendar:?}, {ahead} min ahead, a look every {look_every} min: {error}");
        }
    }
}

/// A door that is open from 9 to 17 on working days, in a zone.
fn is_open(civil_s: f64) -> bool {
    let (day, hour) = ((civil_s / DAY_S).floor() as i64, civil_s.rem_euclid(DAY_S) / 3600.0);
    day.rem_euclid(7) < 5 && (9.0..17.0).contains(&hour)
}

#[test]
fn opening_hours_are_learned_and_move_with_summer_time() {
    let berlin = Calendar::of_zone("Europe/Berlin").unwrap();
    let mut clock = Clock::default();
    // Six weeks until Friday, 2024-03-29; a look every two hours.
    let start_s = MONDAY_S + 45.0 * DAY_S;
    for look in 0..43 * 12 {
        let time_s = start_s + 7200.0 * f64::from(look);
        clock.observe(Look { time_s, is_blocked: is_open(berlin.civil(time_s).time_s) }, &berlin);
    }
    // Tuesday after the change to summer time on Sunday, 2024-03-31: 12:30 and 20:00 in Berlin are 10:30 and 18:00 UTC.
    let tuesday_s = MONDAY_S + 92.0 * DAY_S;
    let at = |day: f64, utc_h: f64| clock.probability(tuesday_s + day * DAY_S + 3600.0 * utc_h, &berlin);
    assert!(at(0.0, 10.5) > 0.85, "noon: {}", at(0.0, 10.5));
    assert!(at(0.0, 18.0) < 0.15, "evening: {}", at(0.0, 18.0));
    assert!(at(4.0, 10.5) < 0.2, "Saturday noon: {}", at(4.0, 10.5));
    // 7:30 UTC is 9:30 in summer.
    let [early, late] = [at(0.0, 6.5), at(0.0, 7.5)];
    assert!(early < late, "{early} before opening, {late} after");
    let error = Calendar::of_zone("Mars/Olympus").unwrap_err().to_string();
    assert!(error.starts_with("no time zone is called `Mars/Olympus`"), "{error}");
}

/// A door that opens and closes on working days at these hours, each day a third of an hour earlier or later.
fn door_with_hours(hours: [f64; 2], days: u32, looks_per_day: u32, rng: &mut ChaCha8Rng) -> Clock {
    let mut clock = Clock::default();
    for day in 0..days {
        let [open, close] = hours.map(|hour| hour + rand_distr::Normal::new(0.0, 0.33).unwrap().sample(rng));
        for minute in 0..1440 {
            if rng.random_ratio(looks_per_day, 1440) {
                let hour = f64::from(minute) / 60.0;
                let is_blocked = day % 7 < 5 && (open..close).contains(&hour);
                let time_s = MONDAY_S + DAY_S * f64::from(day) + 3600.0 * hour;
                clock.observe(Look { time_s, is_blocked }, &Calendar::UTC);
            }
        }
    }
    clock
}

#[test]
fn the_hours_of_doors_are_inside_their_intervals() {
    let (mut rng, mut rows) = (ChaCha8Rng::seed_from_u64(11), Vec::new());
    for (days, looks_per_day, max_length_h) in [(15, 200, 2.0), (29, 200, 1.1), (29, 20, 1.7), (57, 20, 1.2)]
    {
        let (mut inside, mut all, mut length_h) = (0.0, 0.0, 0.0);
        for _ in 0..40 {
            let hours = [rng.random_range(7.0..10.0), rng.random_range(15.0..20.0)];
            let week = door_with_hours(hours, days, looks_per_day, &mut rng).week(&Calendar::UTC).unwrap();
            let changes = week.usual_changes();
            for day in 0..5 {
                for (hour, becomes_blocked) in hours.into_iter().zip([true, false]) {
                    let true_hour = 24.0 * f64::from(day) + hour;
                    let same = changes.iter().filter(|change| change.becomes_blocked == becomes_blocked);
                    let apart_h = |change: &UsualChange| (change.hour - true_hour).abs();
                    let found = same.min_by(|a, b| apart_h(a).total_cmp(&apart_h(b))).unwrap();
                    inside +=
                        f64::from(u8::from((found.earliest_hour..=found.latest_hour).contains(&true_hour)));
                    length_h += found.latest_hour - found.earliest_hour;
                    all += 1.0;
                }
            }
        }
        let (inside, length_h) = (inside / all, length_h / all);
        assert!(
            (0.86..=0.98).contains(&inside),
            "{days} days, {looks_per_day} looks: {inside} inside, {length_h} h"
        );
        assert!(length_h < max_length_h, "{days} days, {looks_per_day} looks: {length_h} h");
        rows.push(format!(
            "hours,\"door, open on working days ± 20 min\",{days},{looks_per_day},{inside:.4},{length_h:.4}"
        ));
    }
    calibration::check_rows("hours", &rows);
}

/// A thing that was seen from 9 to 10 o'clock only, and then at 21 o'clock.
#[test]
fn at_an_hour_that_was_never_seen_the_last_look_counts_and_nothing_is_usual() {
    let (mut clock, mut chain) = (Clock::default(), Chain::new([0.03, 0.01], 9));
    for minute in 0..16 * 1440 {
        let (is_blocked, time_s) = (chain.step(), MONDAY_S + MINUTE_S * f64::from(minute));
        if (540..600).contains(&(minute % 1440)) {
            clock.observe(Look { time_s, is_blocked }, &Calendar::UTC);
        }
    }
    let look_s = MONDAY_S + 15.0 * DAY_S + 21.0 * 3600.0;
    clock.observe(Look { time_s: look_s, is_blocked: false }, &Calendar::UTC);
    let length = |ahead_s: f64| {
        let [low, high] = clock.interval_90(look_s + ahead_s, &Calendar::UTC).unwrap();
        let found = clock.probability(look_s + ahead_s, &Calendar::UTC);
        assert!(0.0 <= low && low <= found && found <= high && high <= 1.0, "{low} to {high}, {found}");
        high - low
    };
    assert!(length(5.0) < 0.1, "{}", length(5.0));
    assert!(length(5.0) < length(600.0) && length(600.0) < length(7200.0), "{}", length(600.0));
    assert_eq!(length(7200.0), 1.0, "two hours later, nothing is known");
    // At night, nothing is usual, though the mean of the morning is far from one half.
    let week = clock.week(&Calendar::UTC).unwrap();
    assert!(week.at(3.0).probability > 0.6 && week.at(3.0).interval_90 == [0.0, 1.0], "{:?}", week.at(3.0));
    assert!(week.usual_changes().is_empty(), "{:?}", week.usual_changes());
}

/// For a Markov chain the last look is worth as much as the mean when half of the memory is left, whatever the mean.
#[test]
fn a_look_at_a_chain_expires_after_its_half_life() {
    let (mut clock, mut chain) = (Clock::default(), Chain::new([0.005, 0.015], 3));
    assert_eq!(clock.expiry_s(&Calendar::UTC), None);
    for step in 0..40 * 1440 {
        let look = Look { time_s: MONDAY_S + MINUTE_S * f64::from(step), is_blocked: chain.step() };
        clock.observe(look, &Calendar::UTC);
    }
    let half_life_s = MINUTE_S * std::f64::consts::LN_2 / 0.02;
    let ratio = clock.expiry_s(&Calendar::Relative).unwrap() / half_life_s;
    assert!((0.6..1.6).contains(&ratio), "{ratio}");
}

#[test]
fn a_stuck_sensor_is_expected_to_stay_stuck() {
    let (mut clock, mut chain) = (Clock::default(), Chain::new([0.02, 0.02], 5));
    for step in 0..30 * 1440 {
        let is_blocked = if step < 20 * 1440 { chain.step() } else { true };
        clock.observe(Look { time_s: MONDAY_S + MINUTE_S * f64::from(step), is_blocked }, &Calendar::UTC);
    }
    let ahead = clock.probability(MONDAY_S + 31.0 * DAY_S, &Calendar::UTC);
    assert!(ahead > 0.85, "after ten days in one state: {ahead}");
}

#[test]
fn a_clock_takes_at_most_5_kb() {
    let mut clock = Clock::default();
    let mut chain = Chain::new([0.01, 0.02], 7);
    for step in 0..20 * 1440 {
        clock.observe(Look { time_s: MINUTE_S * f64::from(step), is_blocked: chain.step() }, &Calendar::UTC);
    }
    let bytes = size_of::<Clock>() + clock.models.schedule.heap_bytes() + clock.models.memory.heap_bytes();
    assert!(bytes <= 5000, "{bytes} bytes");
}

proptest! {
    /// Whatever the looks: predictions are probabilities, and a clock that was saved goes on bit for bit.
    #[test]
    fn any_looks_give_probabilities(
        looks in prop::collection::vec((prop_oneof![-1e3..1e7f64, Just(f64::NAN), Just(f64::INFINITY), Just(1e300)], any::<bool>()), 1..200),
        ahead_s in prop_oneof![0.0..1e7f64, Just(1e30), Just(f64::NAN)],
        sorted in any::<bool>(),
    ) {
        let mut looks = looks;
        if sorted {
            looks.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        let mut clock = Clock::default();
        for (time_s, is_blocked) in looks {
            clock.observe(Look { time_s, is_blocked }, &Calendar::UTC);
            for calendar in [Calendar::UTC, Calendar::Relative] {
                let found = clock.probability(time_s + ahead_s, &calendar);
                prop_assert!((0.001..=0.999).contains(&found), "{found}");
            }
        }
    }

    /// The statistics of both states are alike: a thing whose states are exchanged has the complementary prediction.
    #[test]
    fn states_are_symmetric(stays_s in prop::collection::vec(10.0..100_000.0f64, 1..60), ahead_s in 0.0..1e6f64) {
        let found = [false, true].map(|inverted| {
            let (mut clock, mut time_s) = (Clock::default(), MONDAY_S);
            for (stay, stay_s) in stays_s.iter().enumerate() {
                for part in 0..3 {
                    let look = Look { time_s: time_s + 0.3 * f64::from(part) * stay_s, is_blocked: (stay % 2 == 0) ^ inverted };
                    clock.observe(look, &Calendar::UTC);
                }
                time_s += stay_s;
            }
            clock.probability(time_s + ahead_s, &Calendar::UTC)
        });
        prop_assert!((found[0] + found[1] - 1.0).abs() < 0.02, "{found:?}");
    }
}
