//! How certain a schedule is. Its probability in a slot is a weighted mean of what was found, and the correlations of the looks
//! say how much such a mean varies: with a state that lasts for hours, all slots of an afternoon are one draw; with one that lasts
//! for minutes, each is a draw of its own.

use super::{DAY_DAYS, DAYS, KERNEL, MEAN_DAYS, PARTS, REACH, SLOT_S, SLOTS, Schedule, parts};
use crate::clock::calendar::{Civil, DAY_S};
use crate::clock::week::{UNSEEN_VARIANCE, UsualSlot, Week};

/// Looks that are farther apart count as independent, days.
const MAX_LAG_DAYS: usize = 63;

/// The share of the variance of a state by which hypotheses with these weights differ about its probability.
pub(in crate::clock) fn disagreement<const N: usize>(weights: [f64; N], values: [f64; N]) -> f64 {
    let pairs = || weights.into_iter().zip(values);
    let mean: f64 = pairs().map(|(weight, value)| weight * value).sum();
    let variance: f64 = pairs().map(|(weight, value)| weight * (value - mean) * (value - mean)).sum();
    variance / (mean * (1.0 - mean)).max(f64::MIN_POSITIVE)
}

/// Covariances of the means of one day over the slots of each part, if the state has a variance of 1.
struct Covariances {
    /// Of each slot with itself, and of different ones.
    same: [[f64; PARTS]; PARTS],
    apart: [[f64; PARTS]; PARTS],
    /// Of looks that are this number of days apart, from 1 on.
    days: Vec<f64>,
}

impl Covariances {
    /// `dispersion` is the variance of the mean of a slot, `correlation` that of looks which are a time apart, s.
    fn new(dispersion: f64, correlation: impl Fn(f64) -> f64) -> Self {
        const MIDDLE: usize = SLOTS / 2;
        let (sum, mut around, mut own) = (KERNEL.iter().sum::<f64>(), [0.0; SLOTS], [0.0; SLOTS]);
        for (at, weight) in KERNEL.iter().enumerate() {
            around[MIDDLE + at - REACH] = weight / sum;
        }
        own[MIDDLE] = 1.0;
        let weights = [[1.0 / SLOTS as f64; SLOTS], around, around, own];
        let lags: [f64; SLOTS] = std::array::from_fn(|lag| correlation(lag as f64 * SLOT_S).min(dispersion));
        let matrix = |of: &dyn Fn(usize, usize) -> f64| {
            let with = |a: usize, b: usize| -> f64 {
                let pairs = (0..SLOTS).flat_map(|i| (0..SLOTS).map(move |j| (i, j)));
                pairs.map(|(i, j)| weights[a][i] * weights[b][j] * of(i, j)).sum()
            };
            std::array::from_fn(|a| std::array::from_fn(|b| with(a, b)))
        };
        Self {
            same: matrix(&|i, j| if i == j { dispersion } else { 0.0 }),
            apart: matrix(&|i, j| if i == j { 0.0 } else { lags[i.abs_diff(j)] }),
            days: (1..=MAX_LAG_DAYS).map(|day| correlation(day as f64 * DAY_S)).collect(),
        }
    }

    /// The variance of the sum of the parts with these weights, each a mean over its number of days. Of the slots of a part, this
    /// share was seen on a day.
    fn variance(&self, weights: [f64; PARTS], days: [f64; PARTS], seen: f64) -> f64 {
        let mut sum = 0.0;
        for a in 0..PARTS {
            for b in 0..PARTS {
                // The smaller part is from some of the days of the larger one.
                let n = days[a].max(days[b]).max(1.0);
                let step = if a.min(b) < 2 { 1 } else { DAYS };
                let others = self.days.iter().skip(step - 1).step_by(step).zip(1..);
                let others = others.map(|(lag, number)| 2.0 * (1.0 - f64::from(number) / n).max(0.0) * lag);
                let same = self.same[a][b] / if a.max(b) < 3 { seen } else { 1.0 };
                sum += weights[a] * weights[b] * (same + self.apart[a][b] + others.sum::<f64>()) / n;
            }
        }
        sum
    }
}

impl Schedule {
    /// What is usual in every slot of the week; `None` before the thing was seen on [`Week::MIN_DAYS`]. `correlation` is that of
    /// what looks differ from the schedule by, at a lag, s.
    pub(in crate::clock) fn week(&self, correlation: impl Fn(f64) -> f64) -> Option<Week> {
        let covariances = self.covariances(correlation)?;
        Some(Week::new(|slot| self.usual(slot, &covariances)))
    }

    /// The variance of the probability at a local civil time, as a share of that of the state.
    pub(in crate::clock) fn variance(&self, civil: Civil, correlation: impl Fn(f64) -> f64) -> Option<f64> {
        let covariances = self.covariances(correlation)?;
        if civil.has_hours {
            return Some(self.variance_of(super::slot_of_week(civil), &covariances));
        }
        Some(covariances.variance([1.0, 0.0, 0.0, 0.0], [self.days; PARTS], 1.0))
    }

    fn covariances(&self, correlation: impl Fn(f64) -> f64) -> Option<Covariances> {
        let is_enough = self.days >= f64::from(Week::MIN_DAYS);
        is_enough.then(|| Covariances::new(self.dispersion(), correlation))
    }

    fn usual(&self, slot: usize, covariances: &Covariances) -> UsualSlot {
        let days = self.week[slot].days.into();
        UsualSlot::new(self.of_slot(slot), days, self.variance_of(slot, covariances), self.dispersion())
    }

    /// The variance of the probability in a slot of the week: that of the looks it is a mean of, and what its parts differ by.
    fn variance_of(&self, slot: usize, covariances: &Covariances) -> f64 {
        let (weekday, of_day) = (slot / SLOTS, slot % SLOTS);
        let [day, week] = self.smoothed(weekday, of_day);
        if day.days == 0.0 {
            return UNSEEN_VARIANCE;
        }
        let own = f64::from(self.week[slot].days);
        // What each part is by itself, without the one that it is shrunk toward.
        let alone = |days: f64, prior: f64| days / (days + prior);
        let mut weights = self.shares;
        for (part, alone) in
            [(3, alone(own, DAY_DAYS)), (2, alone(week.days, DAY_DAYS)), (1, alone(day.days, MEAN_DAYS))]
        {
            weights[part - 1] += (1.0 - alone) * weights[part];
            weights[part] *= alone;
        }
        let seen = day.weights / (KERNEL.iter().sum::<f64>() * day.days);
        let of_looks = covariances.variance(
            weights,
            [self.days, day.days, week.days, own],
            seen.clamp(1.0 / SLOTS as f64, 1.0),
        );
        of_looks + disagreement(self.shares, parts(self.mean(), self.profile(weekday, of_day)))
    }
}
