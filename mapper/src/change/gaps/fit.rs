//! The two-state chain that explains the observations of a cell best, gaps included.

use super::histogram::GapHistogram;
use crate::change::Exposure;
use crate::change::transition_kernel::{Prediction, Step, TransitionKernel};

/// The observations to which a chain is fitted.
pub(super) struct Observations<'a> {
    /// The exposure in view, with the prior.
    pub(super) exposure: Exposure,
    /// The gaps.
    pub(super) gaps: &'a GapHistogram,
    /// The time of one step.
    pub(super) period: f64,
    /// The regularity of stays, per state.
    pub(super) regular: [f64; 2],
}

/// The maximum of the posterior, and its shape there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// The transition probabilities per step.
    pub(super) step: Step,
    /// The exposure whose score and information equal those of the gaps at the maximum.
    pub(super) worth: Exposure,
    /// The mixed term of the information of the gaps, in log-odds.
    pub(super) mixed: f64,
}

/// The maximum number of scoring steps. Most fits take two or three.
const MAX_ROUNDS: usize = 30;
/// The search ends when the log-odds of both probabilities change by less than this.
const FOUND: f64 = 1e-4;
/// The maximum change of log-odds in one step.
const LONGEST_MOVE: f64 = 2.0;
/// The limit of the absolute value of log-odds.
const EXTREME: f64 = 30.0;
/// The maximum number of times that a step which leads downhill is halved.
const MAX_HALVINGS: usize = 12;

/// Evidence whose sum gives more than this many times, or less than this part of, the probability that was found is on a kink.
const KINK: f64 = 2.0;

/// The logarithm of the posterior at one point, and its first and expected second derivatives in log-odds.
#[derive(Clone, Copy, Debug, Default)]
struct Height {
    height: f64,
    score: [f64; 2],
    information: [f64; 2],
    mixed: f64,
}

impl Observations<'_> {
    fn of_gaps(&self, step: Step) -> Height {
        let (kernel, per_period) = (TransitionKernel::new(step, self.regular), 1.0 / self.period);
        let mut sum = Height::default();
        for bin in self.gaps.iter() {
            let count = f64::from(bin.count);
            let Prediction { blocked, slope } = kernel.predict(bin.before(), bin.length() * per_period);
            let seen = if bin.after() { blocked } else { 1.0 - blocked };
            let sign = if bin.after() { 1.0 } else { -1.0 };
            sum.height += count * libm::log(seen.max(f64::MIN_POSITIVE));
            // The score of the observation, and its expected square over both outcomes.
            let variance = blocked * (1.0 - blocked);
            if variance > f64::MIN_POSITIVE {
                let (pull, weight) = (count * sign / seen, count / variance);
                for (state, slope) in slope.into_iter().enumerate() {
                    sum.score[state] += pull * slope;
                    sum.information[state] += weight * slope * slope;
                }
                sum.mixed += weight * slope[0] * slope[1];
            }
        }
        sum
    }

    /// Adds the exposure in view to the gaps.
    fn with_exposure(&self, step: Step, gaps: Height) -> Height {
        let mut sum = gaps;
        for (state, leave) in [step.block, step.free].into_iter().enumerate() {
            let (events, steps) = (self.exposure.events[state], self.exposure.steps[state]);
            sum.height += events * libm::log(leave) + (steps - events) * libm::log1p(-leave);
            sum.score[state] += events - steps * leave;
            sum.information[state] += steps * leave * (1.0 - leave);
        }
        sum
    }

    /// Fits by Fisher scoring from `start`, with smaller steps where a full step would lead downhill; `None` if a
    /// result is not finite.
    pub(super) fn fit(&self, start: Step) -> Option<Fit> {
        let mut odds = [start.block, start.free].map(|leave| {
            let odds = libm::log(leave) - libm::log1p(-leave);
            odds.clamp(-EXTREME, EXTREME)
        });
        let mut step = from_odds(odds);
        let mut gaps = self.of_gaps(step);
        for _ in 0..MAX_ROUNDS {
            let here = self.with_exposure(step, gaps);
            let Some(mut by) = here.best_move() else { break };
            let mut found = None;
            for _ in 0..MAX_HALVINGS {
                let next = [0, 1].map(|state| (odds[state] + by[state]).clamp(-EXTREME, EXTREME));
                let next_step = from_odds(next);
                let next_gaps = self.of_gaps(next_step);
                if self.with_exposure(next_step, next_gaps).height >= here.height {
                    found = Some((next, next_step, next_gaps));
                    break;
                }
                by = by.map(|by| by / 2.0);
            }
            let Some(found) = found else { break };
            (odds, step, gaps) = found;
            if by.iter().all(|by| by.abs() < FOUND) {
                break;
            }
        }
        let mut worth = Exposure::default();
        for (state, leave) in [step.block, step.free].into_iter().enumerate() {
            worth.steps[state] = gaps.information[state] / (leave * (1.0 - leave));
            worth.events[state] = leave * worth.steps[state] + gaps.score[state];
            // Where stays are equal, the likelihood of gaps has kinks. At a maximum on a kink the scores do not cancel, and
            // the sum of all evidence would be another chain, down to a negative number of events.
            let steps = self.exposure.steps[state] + worth.steps[state];
            let events = self.exposure.events[state] + worth.events[state];
            if !(leave * steps / KINK..=leave * steps * KINK).contains(&events) {
                worth.events[state] = leave * steps - self.exposure.events[state];
            }
        }
        let results = [worth.steps, worth.events, [gaps.mixed, gaps.height]];
        let is_finite = results.iter().flatten().all(|result| result.is_finite());
        is_finite.then_some(Fit { step, worth, mixed: gaps.mixed })
    }
}

impl Height {
    /// The step to the maximum, by slope and information.
    fn best_move(&self) -> Option<[f64; 2]> {
        let ([a, b], [u, v]) = (self.information, self.score);
        let determinant = a * b - self.mixed * self.mixed;
        let by = [(b * u - self.mixed * v) / determinant, (a * v - self.mixed * u) / determinant];
        let longest = by[0].abs().max(by[1].abs());
        longest.is_finite().then(|| by.map(|by| by * (LONGEST_MOVE / longest).min(1.0)))
    }
}

fn from_odds(odds: [f64; 2]) -> Step {
    let probability = |odds: f64| 1.0 / (1.0 + libm::exp(-odds));
    Step { block: probability(odds[0]), free: probability(odds[1]) }
}
