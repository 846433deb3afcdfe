use super::calendar::{DAY_S, WEEK_S};
use super::simplex;

/// Slots of half an hour.
const SLOTS: usize = 48;
const DAYS: usize = 7;
const SLOT_S: f64 = DAY_S / SLOTS as f64;

/// The kernel over slots with a standard deviation of one hour: people are on time within an hour.
const DEVIATION_SLOTS: f64 = 2.0;
const REACH: usize = 6;

/// The weight of the mean against slots of the day, and of the day against slots of the week, in days.
const MEAN_DAYS: f64 = 2.0;
const DAY_DAYS: f64 = 3.0;

/// The shares of mean, day and week before anything is known, and the number of days that this counts.
const PRIOR: [f64; 3] = [0.2, 0.3, 0.5];
const PRIOR_DAYS: f64 = 0.4;
/// A day counts k / (k + this) for the shares, where k days are known before.
const LEARNED_DAYS: f64 = 5.0;

/// The share of the looks in one slot that found the thing blocked, and their weight.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
struct Slot {
    blocked: f32,
    weight: f32,
}

impl Slot {
    fn mean(self) -> Option<f64> {
        (self.weight > 0.0).then(|| f64::from(self.blocked) / f64::from(self.weight))
    }
}

/// How probable it is that a thing is blocked at an hour of the day and of the week: a mixture of the mean over all looks,
/// of a profile of the day and of a profile of the week, which learns whether days and weeks repeat.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Schedule {
    /// For each weekday and slot, the days at which the slot was seen. Without the present day.
    week: Vec<Slot>,
    /// The looks of the present day.
    today: Vec<Slot>,
    /// The number of the present day.
    day: i64,
    /// All looks, for the mean: each slot of each day counts once.
    total: Slot,
    days: f64,
    gram: [[f64; 3]; 3],
    right: [f64; 3],
    shares: [f64; 3],
}

impl Default for Schedule {
    fn default() -> Self {
        Self {
            week: vec![Slot::default(); WEEK_SLOTS],
            today: vec![Slot::default(); SLOTS],
            day: i64::MIN,
            total: Slot::default(),
            days: 0.0,
            gram: [[0.0; 3]; 3],
            right: [0.0; 3],
            shares: PRIOR,
        }
    }
}

fn day_and_slot(civil_s: f64) -> (i64, usize) {
    let day = (civil_s / DAY_S).floor();
    (day as i64, (((civil_s - day * DAY_S) / SLOT_S) as usize).min(SLOTS - 1))
}

impl Schedule {
    /// Adds a look. Looks of a day count from its end on.
    pub(super) fn add(&mut self, civil_s: Option<f64>, is_blocked: bool) {
        let (day, slot) = civil_s.map_or((0, 0), day_and_slot);
        if day != self.day {
            self.end_day();
            self.day = day;
        }
        let slot = &mut self.today[slot];
        slot.blocked += f32::from(u8::from(is_blocked));
        slot.weight += 1.0;
    }

    /// The share of the time that the thing is blocked.
    pub(super) fn mean(&self) -> f64 {
        let (mut blocked, mut weight) = (f64::from(self.total.blocked) + 0.5, f64::from(self.total.weight) + 1.0);
        for mean in self.today.iter().filter_map(|slot| slot.mean()) {
            blocked += mean;
            weight += 1.0;
        }
        blocked / weight
    }

    /// The probability that the thing is blocked at a local civil time; without a time, the mean.
    pub(super) fn probability(&self, civil_s: Option<f64>) -> f64 {
        let mean = self.mean();
        let Some(civil_s) = civil_s.filter(|_| self.days > 0.0) else { return mean };
        let (day, slot) = day_and_slot(civil_s);
        let parts = self.parts(mean, day.rem_euclid(DAYS as i64) as usize, slot);
        self.shares.iter().zip(parts).map(|(share, part)| share * part).sum()
    }

    /// The predictions by the mean, by the day and by the week.
    fn parts(&self, mean: f64, weekday: usize, slot: usize) -> [f64; 3] {
        let (mut day, mut week) = ([0.0; 2], [0.0; 2]);
        for offset in 0..=2 * REACH {
            let weight = kernel(offset);
            let at = weekday * SLOTS + slot + WEEK_SLOTS + offset - REACH;
            let (weekday, slot) = (at / SLOTS % DAYS, at % SLOTS);
            for (other, slots) in self.week.chunks(SLOTS).enumerate() {
                let Slot { blocked, weight: days } = slots[slot];
                let looked = [f64::from(blocked) * weight, f64::from(days) * weight];
                for (sum, looked) in day.iter_mut().zip(looked) {
                    *sum += looked;
                }
                if other == weekday {
                    for (sum, looked) in week.iter_mut().zip(looked) {
                        *sum += looked;
                    }
                }
            }
        }
        let day = (day[0] + MEAN_DAYS * mean) / (day[1] + MEAN_DAYS);
        let week = (week[0] + DAY_DAYS * day) / (week[1] + DAY_DAYS);
        [mean, day, week]
    }

    /// Learns how well the parts predicted the day that ends, and adds the day.
    fn end_day(&mut self) {
        let weekday = self.day.rem_euclid(DAYS as i64) as usize;
        let means: Vec<(usize, f64)> =
            self.today.iter().enumerate().filter_map(|(slot, looks)| Some((slot, looks.mean()?))).collect();
        if means.is_empty() {
            return;
        }
        let before = self.total.mean().unwrap_or(0.5);
        if self.days > 0.0 {
            let weight = self.days / (self.days + LEARNED_DAYS) / SLOTS as f64;
            for &(slot, found) in &means {
                let parts = self.parts(before, weekday, slot);
                for (row, part) in parts.iter().enumerate() {
                    self.right[row] += weight * part * found;
                    for (column, other) in parts.iter().enumerate() {
                        self.gram[row][column] += weight * part * other;
                    }
                }
            }
            self.fit();
        }
        for (slot, found) in means {
            for into in [&mut self.week[weekday * SLOTS + slot], &mut self.total] {
                into.blocked += found as f32;
                into.weight += 1.0;
            }
            self.today[slot] = Slot::default();
        }
        self.days += 1.0;
    }

    /// The shares of the parts by least squares.
    fn fit(&mut self) {
        let (mut gram, mut right) = (self.gram, self.right);
        for part in 0..3 {
            gram[part][part] += PRIOR_DAYS * RIDGE;
            right[part] += PRIOR_DAYS * RIDGE * PRIOR[part];
        }
        simplex::minimize(&gram, &right, &mut self.shares);
    }
}

/// The squared error that a day of the prior costs for shares that are wrong by 1.
const RIDGE: f64 = 0.1;
const WEEK_SLOTS: usize = DAYS * SLOTS;
const _: () = assert!(WEEK_S == WEEK_SLOTS as f64 * SLOT_S);

/// The weight of a slot at an offset from −`REACH`.
fn kernel(offset: usize) -> f64 {
    let apart = (offset as f64 - REACH as f64) / DEVIATION_SLOTS;
    KERNEL_SCALE * libm::exp(-0.5 * apart * apart)
}

/// With this factor the weights have the sum 1: a slot seen at N days, with its neighbors, counts N days.
const KERNEL_SCALE: f64 = 0.2;
