//! What is usual in every half hour of the week, as people read it: probabilities with intervals, and the hours of changes.

/// Half hours from Monday 0:00 to Sunday 24:00, local civil time.
pub(super) const SLOTS_OF_WEEK: usize = 336;
/// The hours of a slot.
const SLOT_H: f64 = 168.0 / SLOTS_OF_WEEK as f64;
/// The quantile of the normal distribution for an interval of 90 %.
const NORMAL_90: f64 = 1.645;
/// The same for the hours of changes. Days of one weekday repeat each other more than draws with a constant probability do, and
/// within this quantile are 87 to 97 % of the hours of simulated doors (tests).
const NORMAL_OF_HOURS: f64 = 1.2;

/// What is usual in one half hour of the week.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct UsualSlot {
    /// The share of the weeks in which the thing is blocked then: a probability, if nothing is known of the present.
    pub probability: f64,
    /// The interval that contains the true share with a probability of 90 %.
    pub interval_90: [f64; 2],
    /// The number of days on which the thing was seen in this half hour of this weekday.
    pub days: u32,
    /// The share is as certain as if it was found on this many independent days.
    effective_days: f64,
    /// The variance of the share of a day, divided by that of a thing that is blocked for all of a half hour or for nothing of it.
    dispersion: f64,
}

impl UsualSlot {
    pub(super) fn new(probability: f64, days: u32, effective_days: f64, dispersion: f64) -> Self {
        let effective_days = effective_days / dispersion;
        let interval_90 = interval(probability, effective_days, NORMAL_90);
        Self { probability, interval_90, days, effective_days, dispersion }
    }

    /// The interval that contains the share of this many later weeks in which the thing will be blocked then, with a
    /// probability of 90 %.
    pub fn interval_90_of_weeks(&self, weeks: f64) -> [f64; 2] {
        let days = 1.0 / (1.0 / self.effective_days + self.dispersion / weeks);
        interval(self.probability, days, NORMAL_90)
    }

    fn is_blocked(&self) -> bool {
        self.probability > 0.5
    }

    /// Whether it is clear on which side of one half the probability is.
    fn is_clear(&self) -> bool {
        let [low, high] = interval(self.probability, self.effective_days, NORMAL_OF_HOURS);
        low > 0.5 || high < 0.5
    }
}

/// The interval of Wilson (1927) for a share that was found in n draws. It begins at 0, and ends at 1, where all draws can be
/// equal with a probability of 5 %.
fn interval(share: f64, n: f64, quantile: f64) -> [f64; 2] {
    let draws = quantile * quantile / n;
    let center = (share + draws / 2.0) / (1.0 + draws);
    let half = quantile / (1.0 + draws) * ((share * (1.0 - share) + draws / 4.0) / n).sqrt();
    let can_be_equal = |share: f64| libm::pow(1.0 - share, n) > 0.05;
    let low = if can_be_equal(share) { 0.0 } else { center - half };
    let high = if can_be_equal(1.0 - share) { 1.0 } else { center + half };
    [low.max(0.0), high.min(1.0)]
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
