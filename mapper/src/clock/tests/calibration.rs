//! Whether intervals contain the truth as often as they say, on simulated things whose law is known. The rows of the page are held to
//! what the tests find.

use super::*;
use rand_distr::Normal;

const MINUTES: u32 = 1440;
/// The standard deviation of the hours of a door, h.
const PUNCTUALITY_H: f64 = 0.33;
const CHAINS: [Kind; 4] = [
    Kind::Chain { renewal: 0.1, amplitude: 0.0 },
    Kind::Chain { renewal: 0.006, amplitude: 0.0 },
    Kind::Chain { renewal: 0.1, amplitude: 0.6 },
    Kind::Chain { renewal: 0.006, amplitude: 0.6 },
];

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Open on working days.
    Door,
    /// A state that is drawn anew with this probability per minute; the probability of being blocked swings over the day by this.
    Chain { renewal: f64, amplitude: f64 },
}

impl Kind {
    /// The name on the page.
    fn name(self) -> String {
        let Self::Chain { renewal, amplitude } = self else {
            return "door, open on working days ± 20 min".to_owned();
        };
        let lasts = if renewal > 0.01 { "10 min" } else { "3 h" };
        let hours = if amplitude > 0.0 { ", with hours of the day" } else { "" };
        format!("state that lasts for {lasts}{hours}")
    }
}

/// A thing, minute by minute.
struct Thing {
    kind: Kind,
    hours: [f64; 2],
    hours_today: [f64; 2],
    is_blocked: bool,
    rng: ChaCha8Rng,
}

impl Thing {
    fn new(kind: Kind, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let hours = [rng.random_range(7.0..10.0), rng.random_range(15.0..20.0)];
        Self { kind, hours, hours_today: hours, is_blocked: false, rng }
    }

    fn step(&mut self, minute: u32) -> bool {
        match self.kind {
            Kind::Door => {
                if minute.is_multiple_of(MINUTES) {
                    let error_h = Normal::new(0.0, PUNCTUALITY_H).unwrap();
                    self.hours_today = self.hours.map(|hour| hour + error_h.sample(&mut self.rng));
                }
                let [open, close] = self.hours_today;
                self.is_blocked = minute / MINUTES % 7 < 5 && (open..close).contains(&hour(minute));
            }
            Kind::Chain { renewal, .. } if self.rng.random_bool(renewal) => {
                self.is_blocked = self.rng.random_bool(self.share(minute));
            }
            Kind::Chain { .. } => {}
        }
        self.is_blocked
    }

    /// The probability of being blocked of a state that is drawn in a minute; of a door, at that time of any week.
    fn share(&self, minute: u32) -> f64 {
        let later = |from: f64| 0.5 + 0.5 * libm::erf((hour(minute) - from) / (PUNCTUALITY_H * 2f64.sqrt()));
        match self.kind {
            Kind::Door if minute / MINUTES % 7 < 5 => later(self.hours[0]) - later(self.hours[1]),
            Kind::Door => 0.0,
            Kind::Chain { amplitude, .. } => {
                let phase = (hour(minute) - self.hours[0]) / 24.0;
                0.35 + 0.5 * amplitude * libm::sin(std::f64::consts::TAU * phase)
            }
        }
    }

    /// The probability of being blocked some minutes after a look.
    fn later(&self, minute: u32, ahead: u32, is_blocked: bool) -> f64 {
        match self.kind {
            Kind::Door => self.share(minute + ahead),
            Kind::Chain { renewal, .. } => (minute + 1..=minute + ahead)
                .fold(f64::from(u8::from(is_blocked)), |p, at| p + renewal * (self.share(at) - p)),
        }
    }

    /// Goes on for some days; about this number of looks per day is made.
    fn live(
        &mut self,
        clock: &mut Clock,
        days: std::ops::Range<u32>,
        looks: u32,
        mut see: impl FnMut(&Self, &Clock, u32),
    ) {
        for minute in days.start * MINUTES..days.end * MINUTES {
            let is_blocked = self.step(minute);
            if self.rng.random_ratio(looks, MINUTES) {
                clock.observe(Look { time_s: time_s(minute), is_blocked }, &Calendar::UTC);
                see(self, clock, minute);
            }
        }
    }
}

fn hour(minute: u32) -> f64 {
    f64::from(minute % MINUTES) / 60.0
}

fn time_s(minute: u32) -> f64 {
    MONDAY_S + 60.0 * f64::from(minute)
}

/// The share of true probabilities inside of intervals, and the mean length of these.
#[derive(Default)]
struct Inside([f64; 3]);

impl Inside {
    fn add(&mut self, truth: f64, [low, high]: [f64; 2]) {
        // No prediction is nearer to 0 or 1 than 0.001.
        let is_inside = (low - 0.002..=high + 0.002).contains(&truth);
        self.0 = [self.0[0] + f64::from(u8::from(is_inside)), self.0[1] + 1.0, self.0[2] + high - low];
    }

    fn add_all(&mut self, other: &Self) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, other)| *sum += other);
    }

    fn share_and_length(&self) -> [f64; 2] {
        [self.0[0] / self.0[1], self.0[2] / self.0[1]]
    }
}

/// (days, looks per day)
const HISTORIES: [(u32, u32); 4] = [(15, 288), (29, 288), (29, 30), (57, 288)];

/// That `docs/results/clock_intervals.csv` has exactly these rows of an interval: which of the clock, the thing, days, looks per day, share
/// of true values inside, mean length.
pub(super) fn check_rows(which: &str, rows: &[String]) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/results/clock_intervals.csv");
    let file = std::fs::read_to_string(path).unwrap();
    let known: Vec<&str> = file.lines().filter(|line| line.starts_with(&format!("{which},"))).collect();
    assert!(known == rows, "{path} should have\n{}\nand has\n{}", rows.join("\n"), known.join("\n"));
}

/// Every kind of thing with every history: nearly nine of ten are inside, and on the average not many more. (Doors, which are
/// never open at night, and a constant share, which is found in every slot, are inside more often than the intervals say.)
fn check(
    which: &str,
    mut of_thing: impl FnMut(Thing, (u32, u32), &mut Inside),
    kinds: impl IntoIterator<Item = Kind>,
) {
    let (mut all, mut rows) = (Inside::default(), Vec::new());
    for kind in kinds {
        for (days, looks) in HISTORIES {
            let mut inside = Inside::default();
            (0..8).for_each(|seed| of_thing(Thing::new(kind, seed), (days, looks), &mut inside));
            let [share, length] = inside.share_and_length();
            assert!(share > 0.85, "{kind:?}, {days} days, {looks} looks: {share} inside, {length} long");
            rows.push(format!("{which},\"{}\",{days},{looks},{share:.4},{length:.4}", kind.name()));
            all.add_all(&inside);
        }
    }
    let [share, length] = all.share_and_length();
    assert!((0.88..0.975).contains(&share), "all: {share} inside, {length} long");
    check_rows(which, &rows);
}

#[test]
fn usual_shares_are_inside_their_intervals() {
    let of_thing = |mut thing: Thing, (days, looks), inside: &mut Inside| {
        let mut clock = Clock::default();
        thing.live(&mut clock, 0..days, looks, |_, _, _| {});
        let week = clock.week(&Calendar::UTC).unwrap();
        for (slot, minute) in week.slots().iter().zip((7 * MINUTES + 15..).step_by(30)) {
            // Two days after any look.
            inside.add(thing.later(minute - 2 * MINUTES, 2 * MINUTES, false), slot.interval_90);
        }
    };
    check("schedule", of_thing, CHAINS.into_iter().chain([Kind::Door]));
}

#[test]
fn predictions_are_inside_their_intervals() {
    let of_thing = |mut thing: Thing, (days, looks), inside: &mut Inside| {
        let (mut clock, mut count) = (Clock::default(), 0);
        thing.live(&mut clock, 0..days, looks, |_, _, _| {});
        thing.live(&mut clock, days..days + 7, looks, |thing, clock, minute| {
            count += 1;
            for ahead in [1, 10, 60, 360, 1440].into_iter().filter(|_| count % 31 == 0) {
                let truth = thing.later(minute, ahead, thing.is_blocked);
                inside.add(truth, clock.interval_90(time_s(minute + ahead), &Calendar::UTC).unwrap());
            }
        });
    };
    check("prediction", of_thing, CHAINS);
}

#[test]
fn there_is_no_interval_before_two_weeks() {
    let (mut thing, mut clock) = (Thing::new(CHAINS[0], 1), Clock::default());
    let has = |clock: &Clock| {
        [Calendar::UTC, Calendar::Relative].map(|calendar| clock.interval_90(0.0, &calendar).is_some())
    };
    thing.live(&mut clock, 0..14, 100, |_, _, _| {});
    assert_eq!((has(&clock), clock.week(&Calendar::UTC)), ([false; 2], None));
    thing.live(&mut clock, 14..15, 100, |_, _, _| {});
    assert_eq!((has(&clock), clock.week(&Calendar::Relative)), ([true; 2], None));
    assert!(clock.week(&Calendar::UTC).is_some());
}

/// Changes of a door are expected when it opens and closes, not at night.
#[test]
fn changes_have_hours() {
    let (mut thing, mut clock) = (Thing::new(Kind::Door, 1), Clock::default());
    assert_eq!(clock.pace(MONDAY_S, &Calendar::UTC), 1.0);
    thing.live(&mut clock, 0..29, 100, |_, _, _| {});
    let pace = |hour: f64| clock.pace(MONDAY_S + 3600.0 * hour, &Calendar::UTC);
    let [opens, closes] = thing.hours.map(pace);
    assert!(opens > 2.0 && closes > 2.0 && pace(1.0) < 0.3, "{opens}, {closes}, at night {}", pace(1.0));
    let mean = (0..336).map(|slot| pace(0.5 * f64::from(slot))).sum::<f64>() / 336.0;
    assert!((mean - 1.0).abs() < 1e-9, "{mean}");
    assert_eq!(clock.pace(MONDAY_S, &Calendar::Relative), 1.0);
}
