//! A cell as a two-state Markov chain that takes one step per reading.

use super::CellStatistics;

/// The rates at which a cell leaves its states, per unit of time.
///
/// If the rates are small compared with the rate of the readings, this is a continuous-time chain. The chain in
/// steps of the readings also describes faster changes: a block that stays for two steps leaves with probability ½
/// per step, which is not possible for a continuous-time chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransitionRates {
    /// The rate α of free → blocked, per unit of time.
    pub block: f64,
    /// The rate β of blocked → free, per unit of time.
    pub free: f64,
    /// The time of one step; 0 for a chain in continuous time.
    pub period: f64,
}

impl TransitionRates {
    /// The rates for a given cycle rate: the cycle is divided between the states in proportion to the time that the
    /// cell was observed in each. One cycle takes 1/α free and 1/β blocked.
    pub fn shared(seen: &CellStatistics, cycle_rate: f64) -> Self {
        // Half a reading is added to each state, so that no state has a share of 0.
        let (free, blocked) =
            (seen.watched_free + 0.5 * seen.period, seen.watched_blocked + 0.5 * seen.period);
        let rate = |own: f64| cycle_rate * ((free + blocked) / own);
        Self { block: rate(free), free: rate(blocked), period: seen.period }
    }

    /// The cycle time, 1/α + 1/β.
    pub fn interval(self) -> f64 {
        1.0 / self.block + 1.0 / self.free
    }

    /// The same rates, limited to positive, finite values and to at most one event per step.
    pub(crate) fn bounded(self) -> Self {
        let most = (1.0 / self.period).min(f64::MAX);
        let bounded = |rate: f64| if rate > 0.0 { rate.min(most) } else { f64::MIN_POSITIVE };
        Self { block: bounded(self.block), free: bounded(self.free), ..self }
    }

    /// The share of the time that the cell is blocked.
    pub(crate) fn share_blocked(self) -> f64 {
        self.block / (self.block + self.free)
    }

    /// The remaining influence of the observed state at a time `elapsed` after the observation: 1 at first, 0 at
    /// last. The memory fades `pace` times as fast as that of a chain.
    pub(crate) fn memory(self, elapsed: f64, pace: f64) -> f64 {
        if self.period > 0.0 {
            let leave = |rate: f64| (rate * self.period).min(1.0);
            Step { block: leave(self.block), free: leave(self.free) }.memory(elapsed / self.period, pace)
        } else {
            libm::exp(-(self.block + self.free) * pace * elapsed)
        }
    }
}

/// The transition probabilities of a cell from one reading to the next.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(crate) struct Step {
    /// The probability of free → blocked per step.
    pub(crate) block: f64,
    /// The probability of blocked → free per step.
    pub(crate) free: f64,
}

/// The prediction of a chain for the end of a gap.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prediction {
    /// The probability that the cell is blocked.
    pub(crate) blocked: f64,
    /// The derivatives of this probability with respect to the log-odds of leaving free, and of leaving blocked.
    pub(crate) slope: [f64; 2],
}

/// Less than this many steps count as one.
const ONE_STEP: f64 = 1.5;

impl Step {
    /// The remaining influence of the initial state after some steps: λ^steps with λ = 1 − block − free.
    ///
    /// If a cell changes at nearly every step, it alternates, and λ is below 0. Such an alternation is never
    /// regular for long, and gaps of even lengths alone could not distinguish it from standing still. After more
    /// than one step, the influence therefore counts as 0.
    ///
    /// With a `pace` other than 1, the memory of a chain that does not alternate fades this many times as fast.
    pub(crate) fn memory(self, steps: f64, pace: f64) -> f64 {
        let lost = self.block + self.free;
        if lost < 1.0 {
            libm::exp(pace * steps * libm::log1p(-lost))
        } else if steps < ONE_STEP {
            1.0 - lost
        } else {
            0.0
        }
    }
}

/// The transition probabilities of a chain over gaps of any length, prepared for many gaps.
pub(crate) struct TransitionKernel {
    step: Step,
    sum: f64,
    /// The shares of the time that the cell is free and blocked.
    share: [f64; 2],
    /// ln λ, where λ > 0.
    log_memory: f64,
    /// The regularity of the stays, and its derivative by both probabilities.
    regular: f64,
    regular_slope: f64,
}

impl TransitionKernel {
    /// The kernel of a chain. `regular` is, per state, 0 for stays of random length to 1 for equal stays.
    pub(crate) fn new(step: Step, regular: [f64; 2]) -> Self {
        let sum = step.block + step.free;
        let share = [step.free / sum, step.block / sum];
        Self {
            step,
            sum,
            share,
            log_memory: libm::log1p(-sum.min(1.0)),
            // The state with the shorter stays decides how the memory fades.
            regular: regular[0] * share[1] + regular[1] * share[0],
            regular_slope: (regular[0] - regular[1]) / sum,
        }
    }

    /// The prediction for `steps` after the cell was free or `blocked`.
    ///
    /// For a Markov chain P = π + (x₀ − π) λ^n, with the derivatives dP/da = π₀ S + (1 − x₀ − π₀) n λ^(n−1),
    /// likewise for b, where S = (1 − λ^n)/(a + b). For equal stays the memory fades in a straight
    /// line, 1 − (a + b) n, as long as that is above 0.
    pub(crate) fn predict(&self, blocked: bool, steps: f64) -> Prediction {
        let Self { step, sum, share, .. } = *self;
        let [chain, chain_fades] = if sum < 1.0 {
            let memory = libm::exp(steps * self.log_memory);
            [memory, steps * memory / (1.0 - sum)]
        } else {
            [step.memory(steps, 1.0), f64::from(u8::from(steps < ONE_STEP))]
        };
        let (mut memory, mut fades, mut grows) = (chain, chain_fades, 0.0);
        let was = if blocked { [0.0, 1.0] } else { [1.0, 0.0] };
        let apart = [was[0] - share[0], was[1] - share[1]];
        if self.regular > 0.0 {
            let line = (1.0 - sum * steps).max(0.0);
            let line_fades = if line > 0.0 { steps } else { 0.0 };
            memory += self.regular * (line - chain);
            fades += self.regular * (line_fades - chain_fades);
            grows = apart[1] * self.regular_slope * (line - chain);
        }
        let spent = (1.0 - memory) / sum;
        Prediction {
            blocked: (share[1] + apart[1] * memory).clamp(0.0, 1.0),
            slope: [
                (share[0] * (spent + grows) + apart[0] * fades) * step.block * (1.0 - step.block),
                -(share[1] * (spent + grows) + apart[1] * fades) * step.free * (1.0 - step.free),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The chain step by step.
    fn stepped(step: Step, blocked: bool, steps: u32) -> f64 {
        (0..steps).fold(f64::from(u8::from(blocked)), |p, _| p * (1.0 - step.free) + (1.0 - p) * step.block)
    }

    const STEPS: [Step; 4] = [
        Step { block: 0.001, free: 0.02 },
        Step { block: 0.05, free: 0.5 },
        Step { block: 0.3, free: 0.1 },
        Step { block: 0.4, free: 0.6 },
    ];

    #[test]
    fn a_gap_ends_as_the_chain_does_step_by_step() {
        for step in STEPS {
            for steps in [1, 2, 3, 10, 100, 1000] {
                for blocked in [false, true] {
                    let kernel = TransitionKernel::new(step, [0.0; 2]);
                    let found = kernel.predict(blocked, f64::from(steps)).blocked;
                    assert!((found - stepped(step, blocked, steps)).abs() < 1e-12, "{step:?} after {steps}");
                    let [block, free] = [step.block, step.free].map(|leave| leave / 0.1);
                    let chain = TransitionRates { block, free, period: 0.1 };
                    let memory = chain.memory(f64::from(steps) * 0.1, 1.0);
                    let share = chain.share_blocked();
                    let predicted = share + (f64::from(u8::from(blocked)) - share) * memory;
                    assert!((predicted - found).abs() < 1e-9, "{predicted}, not {found}");
                }
            }
        }
    }

    #[test]
    fn slopes_are_those_of_the_probability() {
        let moved = |step: Step, state: usize, by: f64| {
            let shift = |leave: f64| 1.0 / (1.0 + (1.0 / leave - 1.0) * (-by).exp());
            match state {
                0 => Step { block: shift(step.block), ..step },
                _ => Step { free: shift(step.free), ..step },
            }
        };
        for step in &STEPS[..3] {
            for (steps, regular) in [(1.0, [0.0; 2]), (3.0, [0.0; 2]), (41.0, [0.0; 2]), (3.0, [0.3, 0.8])] {
                for (blocked, state) in [(false, 0), (false, 1), (true, 0), (true, 1)] {
                    let at = |step: Step| TransitionKernel::new(step, regular).predict(blocked, steps);
                    let [less, more] = [-1e-5, 1e-5].map(|by| at(moved(*step, state, by)).blocked);
                    let (found, expected) = (at(*step).slope[state], (more - less) / 2e-5);
                    assert!((found - expected).abs() < 1e-8, "{step:?}, {steps}: {found}, not {expected}");
                }
            }
        }
    }

    #[test]
    fn time_is_continuous_without_a_period_and_goes_in_steps_with_one() {
        let chain = TransitionRates { block: 0.2, free: 0.3, period: 0.0 };
        assert!((chain.memory(3.0, 1.0) - (-0.5f64 * 3.0).exp()).abs() < 1e-12);
        assert!((chain.memory(3.0, 2.0) - (-0.5f64 * 6.0).exp()).abs() < 1e-12);
        let chain = TransitionRates { block: 1.0, free: 1.0, period: 1.0 };
        assert_eq!([1.0, 2.0].map(|elapsed| chain.memory(elapsed, 2.0)), [-1.0, 0.0]);
    }
}
