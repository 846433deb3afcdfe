//! What is usual in every half hour of the week, as people read it: probabilities with intervals, and the hours of changes.

use statrs::function::beta::{beta_reg, inv_beta_reg};

/// Half hours from Monday 0:00 to Sunday 24:00, local civil time.
pub(super) const SLOTS_OF_WEEK: usize = 336;
/// The hours of a slot.
const SLOT_H: f64 = 168.0 / SLOTS_OF_WEEK as f64;
/// The probability on each side of an interval of 90 %.
const TAIL: f64 = 0.05;
/// It is clear on which side of one half a share is if it is on the other one with this probability. Days of one weekday repeat
/// each other more than draws with a constant probability do, so that TAIL would be too strict.
const UNCLEAR: f64 = 0.15;

/// The variance of the probability at an hour around which the thing was never seen, divided by that of the state: the mean of all
/// other hours is worth one day (`MEAN_DAYS` of the schedule), which is one draw.
pub(super) const UNSEEN_VARIANCE: f64 = 1.0;

/// What is usual in one half hour of the week.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct UsualSlot {
    /// The share of the weeks in which the thing is blocked then: a probability, if nothing is known of the present.
    pub probability: f64,
    /// The interval that contains the true share with a probability of 90 %.
    pub interval_90: [f64; 2],
    /// The number of days on which the thing was seen in this half hour of this weekday.
    pub days: u32,
    /// The variance of the probability, divided by that of the state.
    #[serde(skip)]
    variance: f64,
    /// The variance of the share of a day, divided by that of a thing that is blocked for all of a half hour or for nothing of it.
    #[serde(skip)]
    dispersion: f64,
}

impl UsualSlot {
    pub(super) fn new(probability: f64, days: u32, variance: f64, dispersion: f64) -> Self {
        let interval_90 = interval_90(probability, variance);
        Self { probability, interval_90, days, variance, dispersion }
    }

    /// The interval that contains the share of this many later weeks in which the thing will be blocked then, with a
    /// probability of 90 %.
    pub fn interval_90_of_weeks(&self, weeks: f64) -> [f64; 2] {
        interval_90(self.probability, self.variance + self.dispersion / weeks)
    }

    fn is_blocked(&self) -> bool {
        self.probability > 0.5
    }

    /// Whether it is clear on which side of one half the probability is. It never is at an hour around which the thing was not seen:
    /// most of the time open does not mean open at night.
    fn is_clear(&self) -> bool {
        if self.variance >= UNSEEN_VARIANCE {
            return false;
        }
        let [a, b] = distribution(self.probability, self.variance);
        let below = beta_reg(a, b, 0.5);
        below.min(1.0 - below) < UNCLEAR
    }
}

/// The parameters of the beta distribution of a probability, whose variance is this share of that of the state. (The interval of
/// Wilson would shrink it toward one half, and it was shrunk toward the mean already.)
fn distribution(probability: f64, variance: f64) -> [f64; 2] {
    /// Keeps the parameters apart from 0.
    const MIN: f64 = 1e-3;
    [probability, 1.0 - probability].map(|share| (share / variance).max(MIN))
}

/// The interval that contains this probability with 90 %. It begins at 0, and ends at 1, where all draws can be equal with a
/// probability of 5 %.
pub(super) fn interval_90(probability: f64, variance: f64) -> [f64; 2] {
    let [a, b] = distribution(probability, variance);
    let can_be_equal = |share: f64| libm::pow(1.0 - share, 1.0 / variance) > TAIL;
    let low = if can_be_equal(probability) { 0.0 } else { inv_beta_reg(a, b, TAIL) };
    let high = if can_be_equal(1.0 - probability) { 1.0 } else { inv_beta_reg(a, b, 1.0 - TAIL) };
    // Nearly all of a very skewed distribution is on one side of its mean.
    [low.min(probability), high.max(probability)]
}

/// A time of the week at which the usual state of a thing changes. Hours count from Monday 0:00, local civil time.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct UsualChange {
    /// Whether the thing is usually blocked from then on.
    pub becomes_blocked: bool,
    /// The hour of the week, from 0 to 168.
    pub hour: f64,
    /// The begin of the interval that contains the true hour with a probability of 90 %; negative in the week before.
    pub earliest_hour: f64,
    /// The end of this interval; above 168 in the week after.
    pub latest_hour: f64,
}

/// What is usual for a thing in a week.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Week {
    slots: Vec<UsualSlot>,
}

impl Week {
    /// The number of days from which on intervals of the hours of a week contain as many of the true ones as they say: every
    /// weekday was seen twice.
    pub const MIN_DAYS: u32 = 14;

    pub(super) fn new(slot: impl Fn(usize) -> UsualSlot) -> Self {
        Self { slots: (0..SLOTS_OF_WEEK).map(slot).collect() }
    }

    /// The 336 half hours from Monday 0:00 on.
    pub fn slots(&self) -> &[UsualSlot] {
        &self.slots
    }

    /// The half hour at an hour of the week, from 0 to 168.
    pub fn at(&self, hour_of_week: f64) -> &UsualSlot {
        &self.slots[(hour_of_week / SLOT_H) as usize % SLOTS_OF_WEEK]
    }

    /// The times at which the usual state changes, in order: between two half hours in which it is clear what is usual. Empty for a
    /// thing that is usually in one state all week, and for one of which this is not clear.
    pub fn usual_changes(&self) -> Vec<UsualChange> {
        let clear: Vec<usize> = (0..SLOTS_OF_WEEK).filter(|slot| self.slots[*slot].is_clear()).collect();
        let next = clear.iter().skip(1).copied().chain(clear.first().map(|first| first + SLOTS_OF_WEEK));
        clear.iter().zip(next).filter_map(|(before, after)| self.change(*before, after)).collect()
    }

    /// The change between two clear half hours; the second can be in the next week.
    fn change(&self, before: usize, after: usize) -> Option<UsualChange> {
        let is_blocked = |slot: usize| self.slots[slot % SLOTS_OF_WEEK].is_blocked();
        if is_blocked(before) == is_blocked(after) {
            return None;
        }
        let crossings: Vec<usize> =
            (before + 1..=after).filter(|slot| is_blocked(slot - 1) != is_blocked(*slot)).collect();
        let hour_of = |slot: usize| (slot as f64 + 0.5) * SLOT_H;
        let hour = self.crossing(*crossings.get(crossings.len() / 2)?);
        let past_weeks = 168.0 * (hour / 168.0).floor();
        Some(UsualChange {
            becomes_blocked: is_blocked(after),
            hour: hour - past_weeks,
            earliest_hour: hour_of(before) - past_weeks,
            latest_hour: hour_of(after) - past_weeks,
        })
    }

    /// The hour at which the probability, between the middles of two slots, is one half.
    fn crossing(&self, slot: usize) -> f64 {
        let [before, after] = [slot - 1, slot].map(|slot| self.slots[slot % SLOTS_OF_WEEK].probability);
        (slot as f64 - 0.5 + (0.5 - before) / (after - before)) * SLOT_H
    }
}
