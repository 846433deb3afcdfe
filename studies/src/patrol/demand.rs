//! How much time on patrol a price buys at each hour of a week, and which price makes a battery last.

use super::duty::Duty;
use crate::SLOT_STEPS;
use crate::belief::{Belief, Model};
use crate::calendar::{SLOT_S, WEEK_S};

const SLOTS: usize = (WEEK_S / SLOT_S) as usize;
/// Slots share the demand of the first one of this number.
const STRIDE: usize = 3;
/// Intervals between two looks at a thing that are tried, steps: from five minutes to nearly four days, powers of 2.
const INTERVALS: usize = 11;
const SHORTEST: usize = 32;
/// Prices that are tried, each this factor above the one before.
const PRICES: usize = 40;
const PRICE_RATIO: f64 = 1.3;

/// What a robot spends on patrol at each hour of the week, by the price of a step of patrol: each thing is looked at
/// as soon as the gain of a look exceeds the price of its share of a tour.
#[derive(Clone, Debug)]
pub(super) struct Demand {
    /// The lowest price, gain per step.
    lowest: f64,
    /// For each group of slots and each price, the share of the time on patrol.
    shares: Vec<[f64; PRICES]>,
}

fn interval(index: usize) -> usize {
    SHORTEST << index
}

impl Demand {
    /// The demand of things with these models, where a look at one of them takes `look_steps`.
    pub(super) fn new(models: &[Model], look_steps: f64) -> Self {
        let gains: Vec<Vec<[f64; INTERVALS]>> = models.iter().map(gains).collect();
        let highest = gains.iter().flatten().flatten().fold(0.0_f64, |highest, gain| highest.max(*gain));
        let lowest = (highest / look_steps).max(1e-9) * libm::pow(PRICE_RATIO, 1.0 - PRICES as f64);
        let share = |group: usize, price: f64| {
            gains.iter().map(|gains| look_steps / interval_of(&gains[group], price * look_steps)).sum()
        };
        let shares = (0..SLOTS / STRIDE).map(|group| {
            std::array::from_fn(|index| share(group, lowest * libm::pow(PRICE_RATIO, index as f64)))
        });
        Self { lowest, shares: shares.collect() }
    }

    /// The price with which a battery is neither empty nor full for as long as possible. `scale` is a factor of the demand.
    pub(super) fn price(&self, step: usize, charge_steps: f64, duty: Duty, scale: f64) -> f64 {
        let (mut low, mut high) = (0.0, PRICES as f64 - 1.0);
        for _ in 0..12 {
            let middle = 0.5 * (low + high);
            *(if self.empties(step, charge_steps, duty, middle, scale) { &mut low } else { &mut high }) =
                middle;
        }
        self.lowest * libm::pow(PRICE_RATIO, 0.5 * (low + high))
    }

    /// The share of the time on patrol at a price.
    pub(super) fn share(&self, step: usize, price: f64) -> f64 {
        let index = (libm::log(price.max(f64::MIN_POSITIVE) / self.lowest) / libm::log(PRICE_RATIO))
            .clamp(0.0, PRICES as f64 - 1.0);
        self.share_at(step, index)
    }

    /// The same, where the price is given by its number, with linear interpolation.
    fn share_at(&self, step: usize, index: f64) -> f64 {
        let shares = &self.shares[step / SLOT_STEPS % SLOTS / STRIDE];
        let below = (index as usize).min(PRICES - 2);
        let part = index - below as f64;
        shares[below] + part * (shares[below + 1] - shares[below])
    }

    /// Whether a battery will be empty before it is full.
    fn empties(&self, step: usize, charge_steps: f64, duty: Duty, price: f64, scale: f64) -> bool {
        let mut charge = charge_steps;
        for slot in 0..SLOTS {
            let share = (scale * self.share_at(step + slot * SLOT_STEPS, price)).min(1.0);
            charge += SLOT_STEPS as f64 * ((1.0 - share) * duty.charge_per_step() - share);
            if charge <= 0.0 || charge >= duty.full_steps() {
                return charge <= 0.0;
            }
        }
        charge < charge_steps
    }
}

/// The interval after which the gain of a look reaches a cost, steps; infinite if it never does.
fn interval_of(gains: &[f64; INTERVALS], cost: f64) -> f64 {
    let Some(above) = gains.iter().position(|gain| *gain >= cost) else { return f64::INFINITY };
    if above == 0 {
        return interval(0) as f64;
    }
    let [low, high] = [gains[above - 1], gains[above]];
    let part = (cost - low) / (high - low);
    interval(above - 1) as f64 + part * (interval(above) - interval(above - 1)) as f64
}

/// The expected gain of a look at a thing in each slot, by the time since the last look.
fn gains(model: &Model) -> Vec<[f64; INTERVALS]> {
    let mut law = Belief::new(model);
    let laws: Vec<Belief> = (0..SLOTS)
        .map(|slot| {
            let now = law.clone();
            law = law.later(model, slot * SLOT_STEPS, SLOT_STEPS);
            now
        })
        .collect();
    let of_slot = |slot: usize| {
        let now = (slot + SLOTS) * SLOT_STEPS;
        let memories = model.memories(&laws[slot], now, std::array::from_fn::<_, INTERVALS, _>(interval));
        std::array::from_fn(|index| {
            let interval = interval(index);
            let before = now - interval.min(now);
            let seen = &laws[before / SLOT_STEPS % SLOTS];
            let p = seen.probability();
            let variances = [false, true].map(|is_blocked| {
                let p = seen.after(is_blocked).later(model, before, interval).probability();
                p * (1.0 - p)
            });
            let variance = (1.0 - p) * variances[0] + p * variances[1];
            variance * memories[index]
        })
    };
    (0..SLOTS).step_by(STRIDE).map(of_slot).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calendar::{Habit, Hours, Stays};

    /// A thing that changes by day only.
    fn demand() -> Demand {
        let habit = Habit {
            hours: Hours::daily(&[0, 1, 2, 3, 4, 5, 6], 8.0, 18.0),
            active: [Stays::of_mean(3600.0); 2],
            quiet: [Stays::of_mean(1e7); 2],
        };
        Demand::new(&[Model::of(&habit)], 10.0)
    }

    #[test]
    fn demand_falls_with_the_price_and_at_night() {
        let demand = demand();
        let [night, day] = [2, 12].map(|hour| hour * 360);
        let price = |index: f64| demand.lowest * libm::pow(PRICE_RATIO, index);
        for index in 10..PRICES - 1 {
            let [lower, higher] = [0.0, 1.0].map(|more| demand.share(day, price(index as f64 + more)));
            assert!(lower >= higher);
        }
        let middle = price(18.0);
        assert!(demand.share(day, middle) > 3.0 * demand.share(night, middle));
    }

    /// With the price, the battery lasts longer than with one that is a tenth higher or lower.
    #[test]
    fn the_price_makes_a_battery_last() {
        let (demand, duty) = (demand(), Duty::share(0.01));
        let step = 8 * 360;
        let lasts = |price: f64| {
            let mut charge = 60.0;
            let slots = (0..SLOTS).take_while(|slot| {
                let share = demand.share(step + slot * SLOT_STEPS, price).min(1.0);
                charge += SLOT_STEPS as f64 * ((1.0 - share) * duty.charge_per_step() - share);
                charge > 0.0 && charge < duty.full_steps()
            });
            slots.count()
        };
        let price = demand.price(step, 60.0, duty, 1.0);
        let around = [0.9, 1.0, 1.1].map(|factor| lasts(factor * price));
        assert!(around[1] >= around[0].max(around[2]) && around[1] > 20, "{around:?}");
    }
}
