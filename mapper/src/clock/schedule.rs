mod certainty;

use super::calendar::{Civil, DAY_S};
use super::simplex;
use super::week::SLOTS_OF_WEEK;
pub(super) use certainty::disagreement;

/// Slots of half an hour.
const SLOTS: usize = SLOTS_OF_WEEK / DAYS;
const DAYS: usize = 7;
const SLOT_S: f64 = DAY_S / SLOTS as f64;

/// Slots are smoothed with a biweight kernel of this half width, slots: a standard deviation of 75 minutes, about as
/// punctual as people are.
const HALF_WIDTH: f64 = 6.6;
const REACH: usize = HALF_WIDTH as usize;
const KERNEL: [f64; 2 * REACH + 1] = kernel();

/// The weight of the mean against the slots of the day, and of the day against the slots of the week, in days.
const MEAN_DAYS: f64 = 1.0;
const DAY_DAYS: f64 = 3.0;

/// Mean, day, week, and the slot of the week by itself.
const PARTS: usize = 4;
/// Their shares before any day, and the weight of these, in days with a variance of 0.1.
const PRIOR: [f64; PARTS] = [0.2, 0.3, 0.5, 0.0];
const PRIOR_WEIGHT: f64 = 0.04;
/// Day number k counts k / (k + this) for the shares: the profiles of the first days are still poor.
const LEARNED_DAYS: f64 = 5.0;
/// With this many slots seen, a day counts in full.
const FULL_DAY: f64 = 12.0;

/// The weight of a dispersion of one before all days, in days with a variance of 1.
const DISPERSION_PRIOR: f64 = 0.1;

/// The weights of neighboring slots.
const fn kernel() -> [f64; 2 * REACH + 1] {
    let mut kernel = [0.0; 2 * REACH + 1];
    let mut at = 0;
    while at < kernel.len() {
        let apart = (at as f64 - REACH as f64) / HALF_WIDTH;
        kernel[at] = (1.0 - apart * apart) * (1.0 - apart * apart);
        at += 1;
    }
    kernel
}

/// The days on which a slot of the week was seen, in four bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
struct Slot {
    /// The sum over these days of the share of the looks that found the thing blocked, in units of 1/`UNIT`.
    blocked: u16,
    days: u16,
}

impl Slot {
    const UNIT: f64 = 256.0;
    const MAX_DAYS: u16 = 255;

    fn add(&mut self, mean: f64) {
        if self.days == Self::MAX_DAYS {
            // Five years: the older half counts half.
            *self = Self { blocked: self.blocked / 2, days: self.days / 2 };
        }
        self.blocked += libm::round(mean * Self::UNIT) as u16;
        self.days += 1;
    }

    /// Days blocked, and all days.
    fn days(self) -> [f64; 2] {
        [f64::from(self.blocked) / Self::UNIT, f64::from(self.days)]
    }
}

/// The days on which a slot and its neighbors were seen.
#[derive(Default)]
struct Smoothed {
    blocked: f64,
    weights: f64,
    /// The days of the slot that was seen most, the less the farther it is. Neighboring slots of one day say nearly the
    /// same: together they count one day, however many of them were seen.
    days: f64,
}

impl Smoothed {
    fn add(&mut self, weight: f64, [blocked, days]: [f64; 2]) {
        self.blocked += weight * blocked;
        self.weights += weight * days;
        self.days = self.days.max(weight * days);
    }

    /// The smoothed mean, shrunk toward a prior that counts this many days; both are a factor of the mean and a constant.
    fn shrunk(&self, prior: [f64; 2], prior_days: f64) -> [f64; 2] {
        let share = prior_days / (self.days + prior_days);
        let mean = if self.weights > 0.0 { self.blocked / self.weights } else { 0.0 };
        [share * prior[0], share * prior[1] + (1.0 - share) * mean]
    }
}

/// The looks in one slot of the present day.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
struct Looks {
    blocked: u16,
    all: u16,
}

impl Looks {
    fn mean(self) -> Option<f64> {
        (self.all > 0).then(|| f64::from(self.blocked) / f64::from(self.all))
    }
}

/// Slots that were seen: the sum of their means, and their number.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
struct Total {
    blocked: f64,
    slots: f64,
}

/// The probability that a thing is blocked by the hour of the day and of the week: a mixture of the mean, of a profile of
/// the day, and of a profile of the week. Learns from each day how well these predicted it, before it adds the day.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Schedule {
    /// The slots of the week, from Monday 0:00 on, without the present day.
    week: Vec<Slot>,
    /// The slots of the present day.
    today: Vec<Looks>,
    /// The number of the present day.
    day: i64,
    /// All slots of all days, for the mean: without, and of, the present day.
    past: Total,
    present: Total,
    /// The number of days before the present day.
    days: f64,
    gram: [[f64; PARTS]; PARTS],
    right: [f64; PARTS],
    shares: [f64; PARTS],
    /// Sums over the days: the squared errors of predictions, and their expectation for states that last half hours.
    errors: [f64; 2],
    /// Cache: day, slot and profile of the last look.
    latest: Option<(i64, usize, Profile)>,
}

/// The predictions by day, week and slot in one slot, each as a factor of the mean and a constant.
type Profile = [[f64; 2]; PARTS - 1];

impl Default for Schedule {
    fn default() -> Self {
        Self {
            week: vec![Slot::default(); SLOTS_OF_WEEK],
            today: vec![Looks::default(); SLOTS],
            day: i64::MIN,
            past: Total::default(),
            present: Total::default(),
            days: 0.0,
            gram: [[0.0; PARTS]; PARTS],
            right: [0.0; PARTS],
            shares: PRIOR,
            errors: [0.0; 2],
            latest: None,
        }
    }
}

/// The number of a day, and the slot of the day.
fn day_and_slot(civil: Civil) -> (i64, usize) {
    let day = (civil.time_s / DAY_S).floor();
    (day as i64, (((civil.time_s - day * DAY_S) / SLOT_S) as usize).min(SLOTS - 1))
}

fn slot_of_week(civil: Civil) -> usize {
    let (day, slot) = day_and_slot(civil);
    weekday(day) * SLOTS + slot
}

fn weekday(day: i64) -> usize {
    day.rem_euclid(DAYS as i64) as usize
}

impl Schedule {
    #[cfg(test)]
    pub(super) fn heap_bytes(&self) -> usize {
        size_of_val(&*self.week) + size_of_val(&*self.today)
    }

    /// Goes on to the day of a time. The looks of a day count for its hours as soon as the day has ended.
    pub(super) fn advance(&mut self, civil: Civil) {
        let (day, slot) = day_and_slot(civil);
        if day != self.day {
            self.end_day();
            self.day = day;
        }
        if self.latest.is_none_or(|(of_day, of_slot, _)| (of_day, of_slot) != (day, slot)) {
            self.latest = Some((day, slot, self.profile(weekday(day), slot)));
        }
    }

    /// Adds a look in the present day.
    pub(super) fn add(&mut self, civil: Civil, is_blocked: bool) {
        let looks = &mut self.today[day_and_slot(civil).1];
        let before = looks.mean();
        if looks.all < u16::MAX {
            looks.blocked += u16::from(is_blocked);
            looks.all += 1;
        }
        self.present.blocked += looks.mean().unwrap_or(0.0) - before.unwrap_or(0.0);
        self.present.slots += f64::from(u8::from(before.is_none()));
    }

    /// The number of days with a look.
    pub(super) fn days_seen(&self) -> u32 {
        self.days as u32 + u32::from(self.present.slots > 0.0)
    }

    /// The number of slots with a look, of all days.
    pub(super) fn slots(&self) -> f64 {
        self.past.slots + self.present.slots
    }

    /// The share of the time that the thing is blocked, with one slot of a half before all looks.
    pub(super) fn mean(&self) -> f64 {
        let Total { blocked, slots } = self.past;
        (blocked + self.present.blocked + 0.5) / (slots + self.present.slots + 1.0)
    }

    /// The probability that the thing is blocked at a local civil time; without hours, the mean.
    pub(super) fn probability(&self, civil: Civil) -> f64 {
        let mean = self.mean();
        if self.days == 0.0 || !civil.has_hours {
            return mean;
        }
        let (day, slot) = day_and_slot(civil);
        let profile = match self.latest {
            Some((of_day, of_slot, profile)) if (of_day, of_slot) == (day, slot) => profile,
            _ => self.profile(weekday(day), slot),
        };
        self.mix(parts(mean, profile))
    }

    /// The rate of changes at a local civil time, divided by the mean rate: they are divided over the week in proportion to
    /// p (1 − p), as those of a chain whose memory fades as fast at all hours.
    pub(super) fn pace(&self, civil: Civil) -> f64 {
        if self.days == 0.0 || !civil.has_hours {
            return 1.0;
        }
        let changes = |slot: usize| {
            let probability = self.of_slot(slot);
            probability * (1.0 - probability)
        };
        let mean = (0..SLOTS_OF_WEEK).map(changes).sum::<f64>() / SLOTS_OF_WEEK as f64;
        changes(slot_of_week(civil)) / mean.max(f64::MIN_POSITIVE)
    }

    /// The probability that the thing is blocked in a slot of the week.
    fn of_slot(&self, slot: usize) -> f64 {
        self.mix(parts(self.mean(), self.profile(slot / SLOTS, slot % SLOTS)))
    }

    fn mix(&self, parts: [f64; PARTS]) -> f64 {
        self.shares.iter().zip(parts).map(|(share, part)| share * part).sum()
    }

    /// The variance of what is found in a slot, divided by that of a state that lasts for the whole slot.
    fn dispersion(&self) -> f64 {
        ((self.errors[0] + DISPERSION_PRIOR) / (self.errors[1] + DISPERSION_PRIOR)).min(1.0)
    }

    /// The profiles at a slot. With few days, the week is that of the day, and the day is the mean.
    fn profile(&self, weekday: usize, slot: usize) -> Profile {
        let [day, week] = self.smoothed(weekday, slot);
        let mut own = Smoothed::default();
        own.add(1.0, self.week[weekday * SLOTS + slot].days());
        let day = day.shrunk([1.0, 0.0], MEAN_DAYS);
        let week = week.shrunk(day, DAY_DAYS);
        [day, week, own.shrunk(week, DAY_DAYS)]
    }

    /// The days on which the hours around a slot were seen: of all weekdays, and of its own.
    fn smoothed(&self, weekday: usize, slot: usize) -> [Smoothed; 2] {
        let (mut day, mut week) = (Smoothed::default(), Smoothed::default());
        for (offset, weight) in KERNEL.iter().enumerate() {
            let at = weekday * SLOTS + slot + SLOTS_OF_WEEK + offset - REACH;
            let of_day = |day: usize| self.week[(at + day * SLOTS) % SLOTS_OF_WEEK].days();
            week.add(*weight, of_day(0));
            let all = (0..DAYS).map(of_day);
            day.add(*weight, all.fold([0.0; 2], |sum, seen| [sum[0] + seen[0], sum[1] + seen[1]]));
        }
        [day, week]
    }

    /// Compares the predictions for the present day with what was seen, then adds the day.
    fn end_day(&mut self) {
        let weekday = weekday(self.day);
        let seen: Vec<(usize, f64)> =
            self.today.iter().enumerate().filter_map(|(slot, looks)| Some((slot, looks.mean()?))).collect();
        if seen.is_empty() {
            return;
        }
        if self.days > 0.0 {
            let mean = self.past.blocked / self.past.slots;
            // Slots within two hours say nearly the same.
            let share = (seen.len() as f64 / FULL_DAY).min(1.0) / seen.len() as f64;
            let weight = share * self.days / (self.days + LEARNED_DAYS);
            for &(slot, found) in &seen {
                let parts = parts(mean, self.profile(weekday, slot));
                let predicted = self.mix(parts);
                self.errors[0] += weight * (found - predicted) * (found - predicted);
                self.errors[1] += weight * predicted * (1.0 - predicted);
                self.learn(parts, found, weight);
            }
            self.fit();
        }
        for (slot, mean) in seen {
            self.week[weekday * SLOTS + slot].add(mean);
        }
        self.past.blocked += self.present.blocked;
        self.past.slots += self.present.slots;
        self.present = Total::default();
        self.today.fill(Looks::default());
        self.days += 1.0;
        self.latest = None;
    }

    fn learn(&mut self, parts: [f64; PARTS], found: f64, weight: f64) {
        for row in 0..PARTS {
            self.right[row] += weight * parts[row] * found;
            for column in 0..PARTS {
                self.gram[row][column] += weight * parts[row] * parts[column];
            }
        }
    }

    fn fit(&mut self) {
        let (mut gram, mut right) = (self.gram, self.right);
        for part in 0..PARTS {
            gram[part][part] += PRIOR_WEIGHT;
            right[part] += PRIOR_WEIGHT * PRIOR[part];
        }
        simplex::minimize(&gram, &right, &mut self.shares);
    }
}

/// The predictions of all parts.
fn parts(mean: f64, profile: Profile) -> [f64; PARTS] {
    let mut parts = [mean; PARTS];
    for (part, [factor, constant]) in parts[1..].iter_mut().zip(profile) {
        *part = factor * mean + constant;
    }
    parts
}
