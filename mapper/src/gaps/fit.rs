//! The two-state chain that explains best what was seen of a cell, gaps included.

use super::table::Bins;
use crate::chain::Step;

/// What was watched: per state (free, blocked) the events that ended it and the readings' steps that
/// began in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Watch {
    pub(crate) events: [f64; 2],
    pub(crate) steps: [f64; 2],
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

/// Events and steps that are added to what was seen: a beta distribution per step, which for rates far
/// below one per step is the gamma distribution.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prior {
    pub(crate) events: f64,
    pub(crate) steps: f64,
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

impl Slope {
    fn of_gaps(step: Step, bins: &Bins, period: f64) -> Self {
        let mut sum = Self::default();
        for bin in bins.iter() {
            let count = f64::from(bin.count);
            let gap = step.over(bin.before(), bin.length() / period);
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
}

fn log_posterior(step: Step, watch: &Watch, bins: &Bins, period: f64, prior: Prior) -> f64 {
    let mut sum = 0.0;
    for (state, leave) in [step.block, step.free].into_iter().enumerate() {
        let events = watch.events[state] + prior.events;
        let stays = watch.steps[state] + prior.steps - events;
        sum += events * libm::log(leave) + stays * libm::log1p(-leave);
    }
    for bin in bins.iter() {
        let blocked = step.over(bin.before(), bin.length() / period).blocked;
        let seen = if bin.after() { blocked } else { 1.0 - blocked };
        sum += f64::from(bin.count) * libm::log(seen.max(f64::MIN_POSITIVE));
    }
    sum
}

fn from_odds(odds: [f64; 2]) -> Step {
    let probability = |odds: f64| 1.0 / (1.0 + libm::exp(-odds));
    Step { block: probability(odds[0]), free: probability(odds[1]) }
}

/// Fits by Fisher scoring from `start`, with smaller moves where a whole one would lead downhill.
pub(crate) fn fit(watch: &Watch, bins: &Bins, period: f64, prior: Prior, start: Step) -> Fit {
    let logit = |leave: f64| (libm::log(leave) - libm::log1p(-leave)).clamp(-EXTREME, EXTREME);
    let mut odds = [logit(start.block), logit(start.free)];
    let mut step = from_odds(odds);
    let mut height = log_posterior(step, watch, bins, period, prior);
    let mut slope = Slope::of_gaps(step, bins, period);
    for _ in 0..MOST_ROUNDS {
        let [mut score, mut information] = [slope.score, slope.information];
        for (state, leave) in [step.block, step.free].into_iter().enumerate() {
            let steps = watch.steps[state] + prior.steps;
            score[state] += watch.events[state] + prior.events - steps * leave;
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
            let next_height = log_posterior(next_step, watch, bins, period, prior);
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
        slope = Slope::of_gaps(step, bins, period);
    }
    let mut worth = Watch { events: [0.0; 2], steps: [0.0; 2] };
    for (state, leave) in [step.block, step.free].into_iter().enumerate() {
        worth.steps[state] = slope.information[state] / (leave * (1.0 - leave));
        worth.events[state] = leave * worth.steps[state] + slope.score[state];
    }
    Fit { step, worth, mixed: slope.mixed }
}
