//! The two-state chain that explains best what was seen of a cell, gaps included.

use super::table::Bins;
use crate::chain::Step;
use std::ops::Add;

/// What was watched: per state (free, blocked) the events that ended it and the readings' steps that
/// began in it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Watch {
    pub(crate) events: [f64; 2],
    pub(crate) steps: [f64; 2],
}

impl Add for Watch {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let sum = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        Self { events: sum(self.events, other.events), steps: sum(self.steps, other.steps) }
    }
}

/// What is fitted.
pub(super) struct Evidence<'a> {
    /// What was watched, and what was known before.
    pub(super) watch: Watch,
    pub(super) gaps: &'a Bins,
    /// The time of one step.
    pub(super) period: f64,
    /// How regular stays are, per state.
    pub(super) regular: [f64; 2],
}

/// The maximum of the posterior, and its shape there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fit {
    /// The chain per step.
    pub(crate) step: Step,
    /// What the gaps are worth at the maximum: the watching, per state, that would pull each
    /// probability as hard and hold it as firmly.
    pub(crate) worth: Watch,
    /// What the gaps tell of both probabilities together: the mixed term of their information, in
    /// log-odds.
    pub(crate) mixed: f64,
}

/// Scoring steps at most. Most fits take three to six.
const MOST_ROUNDS: usize = 30;
/// A probability is found when its log-odds move less than this.
const FOUND: f64 = 1e-7;
/// Log-odds move by at most this in one round.
const LONGEST_MOVE: f64 = 2.0;
/// Log-odds stay within these bounds.
const EXTREME: f64 = 30.0;

/// Score and information of the gaps in log-odds.
#[derive(Clone, Copy, Debug, Default)]
struct Slope {
    score: [f64; 2],
    information: [f64; 2],
    mixed: f64,
}

impl Evidence<'_> {
    fn slope_of_gaps(&self, step: Step) -> Slope {
        let mut sum = Slope::default();
        for bin in self.gaps.iter() {
            let count = f64::from(bin.count);
            let gap = step.over(bin.before(), bin.length() / self.period, self.regular);
            let seen = if bin.after() { gap.blocked } else { -(1.0 - gap.blocked) };
            // Score of what was seen, and its expected square over both outcomes.
            let variance = gap.blocked * (1.0 - gap.blocked);
            if variance <= f64::MIN_POSITIVE {
                continue;
            }
            for (score, slope) in sum.score.iter_mut().zip(gap.slope) {
                *score += count * slope / seen;
            }
            for (information, slope) in sum.information.iter_mut().zip(gap.slope) {
                *information += count * slope * slope / variance;
            }
            sum.mixed += count * gap.slope[0] * gap.slope[1] / variance;
        }
        sum
    }

    fn log_posterior(&self, step: Step) -> f64 {
        let mut sum = 0.0;
        for (state, leave) in [step.block, step.free].into_iter().enumerate() {
            let (events, steps) = (self.watch.events[state], self.watch.steps[state]);
            sum += events * libm::log(leave) + (steps - events) * libm::log1p(-leave);
        }
        for bin in self.gaps.iter() {
            let blocked = step.over(bin.before(), bin.length() / self.period, self.regular).blocked;
            let seen = if bin.after() { blocked } else { 1.0 - blocked };
            sum += f64::from(bin.count) * libm::log(seen.max(f64::MIN_POSITIVE));
        }
        sum
    }

    /// Fits by Fisher scoring from `start`, with smaller moves where a whole one would lead downhill.
    pub(super) fn fit(&self, start: Step) -> Fit {
        let logit = |leave: f64| (libm::log(leave) - libm::log1p(-leave)).clamp(-EXTREME, EXTREME);
        let mut odds = [logit(start.block), logit(start.free)];
        let mut step = from_odds(odds);
        let mut height = self.log_posterior(step);
        let mut slope = self.slope_of_gaps(step);
        for _ in 0..MOST_ROUNDS {
            let [mut score, mut information] = [slope.score, slope.information];
            for (state, leave) in [step.block, step.free].into_iter().enumerate() {
                let (events, steps) = (self.watch.events[state], self.watch.steps[state]);
                score[state] += events - steps * leave;
                information[state] += steps * leave * (1.0 - leave);
            }
            let determinant = information[0] * information[1] - slope.mixed * slope.mixed;
            let mut by = [
                (information[1] * score[0] - slope.mixed * score[1]) / determinant,
                (information[0] * score[1] - slope.mixed * score[0]) / determinant,
            ];
            let longest = by[0].abs().max(by[1].abs());
            if !longest.is_finite() || longest < FOUND {
                break;
            }
            let scale = (LONGEST_MOVE / longest).min(1.0);
            by = by.map(|by| by * scale);
            let mut has_moved = false;
            for _ in 0..12 {
                let next = [0, 1].map(|state| (odds[state] + by[state]).clamp(-EXTREME, EXTREME));
                let next_step = from_odds(next);
                let next_height = self.log_posterior(next_step);
                if next_height >= height {
                    has_moved = next != odds;
                    (odds, step, height) = (next, next_step, next_height);
                    break;
                }
                by = by.map(|by| by / 2.0);
            }
            if !has_moved {
                break;
            }
            slope = self.slope_of_gaps(step);
        }
        let mut worth = Watch::default();
        for (state, leave) in [step.block, step.free].into_iter().enumerate() {
            worth.steps[state] = slope.information[state] / (leave * (1.0 - leave));
            worth.events[state] = leave * worth.steps[state] + slope.score[state];
        }
        Fit { step, worth, mixed: slope.mixed }
    }
}

fn from_odds(odds: [f64; 2]) -> Step {
    let probability = |odds: f64| 1.0 / (1.0 + libm::exp(-odds));
    Step { block: probability(odds[0]), free: probability(odds[1]) }
}
