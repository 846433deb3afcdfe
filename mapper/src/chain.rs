//! A cell as a two-state Markov chain that steps with the readings.

use interfaces::CellState;

/// The rates at which a cell leaves its states, per unit of time.
///
/// Where rates are small beside the pace of the readings this is the continuous-time chain. A chain
/// that takes one step per reading is right for both: a block that stays for two steps leaves with
/// probability ½ per step, which no continuous chain that is looked at once per step does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Chain {
    /// Free → blocked, α.
    pub(crate) block: f64,
    /// Blocked → free, β.
    pub(crate) free: f64,
    /// The time of one step; 0 for a chain in continuous time.
    pub(crate) period: f64,
}

impl Chain {
    /// Mean time of a cycle, 1/α + 1/β.
    pub(crate) fn interval(self) -> f64 {
        1.0 / self.block + 1.0 / self.free
    }

    /// The same with rates that are numbers, and not more than one event per step.
    pub(crate) fn bounded(self) -> Self {
        let most = (1.0 / self.period).min(f64::MAX);
        let bounded = |rate: f64| if rate > 0.0 { rate.min(most) } else { f64::MIN_POSITIVE };
        Self { block: bounded(self.block), free: bounded(self.free), ..self }
    }

    /// The probability that the cell is blocked `elapsed` after it was seen in `state`.
    pub(crate) fn blocked_probability(self, state: CellState, elapsed: f64) -> f64 {
        let share = self.block / (self.block + self.free);
        let seen = f64::from(u8::from(state == CellState::Blocked));
        let memory = if self.period > 0.0 {
            let leave = |rate: f64| (rate * self.period).min(1.0);
            Step { block: leave(self.block), free: leave(self.free) }.memory(elapsed / self.period)
        } else {
            libm::exp(-(self.block + self.free) * elapsed)
        };
        (share + (seen - share) * memory).clamp(0.0, 1.0)
    }
}

/// The probabilities to leave a state from one reading to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    /// Free → blocked.
    pub(crate) block: f64,
    /// Blocked → free.
    pub(crate) free: f64,
}

/// What a chain says of the end of a gap.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GapEnd {
    /// The probability that the cell is blocked then.
    pub(crate) blocked: f64,
    /// How it grows with the log-odds of leaving free, and of leaving blocked.
    pub(crate) slope: [f64; 2],
}

/// Fewer steps than this are one.
const ONE_STEP: f64 = 1.5;

impl Step {
    /// How much of knowing the state is left after some steps: λ^steps with λ = 1 − block − free.
    ///
    /// A cell that changes at nearly every step alternates, and λ is below 0. Nobody can count on such a
    /// beat for long, and by gaps of even lengths alone it could not be told from standing still: after more than one
    /// step nothing is left of it.
    pub(crate) fn memory(self, steps: f64) -> f64 {
        let lost = self.block + self.free;
        if lost < 1.0 {
            libm::exp(steps * libm::log1p(-lost))
        } else if steps < ONE_STEP {
            1.0 - lost
        } else {
            0.0
        }
    }
}

/// A chain, prepared to look over many gaps.
pub(crate) struct Gaze {
    step: Step,
    sum: f64,
    /// The shares of the time that the cell is free and blocked.
    share: [f64; 2],
    /// ln λ, where there is one.
    log_memory: f64,
    /// How far stays are by the clock, and how that grows with both probabilities.
    part: f64,
    part_grows: f64,
}

impl Gaze {
    /// `regular` says, per state, how far stays are by the clock.
    pub(crate) fn new(step: Step, regular: [f64; 2]) -> Self {
        let sum = step.block + step.free;
        let share = [step.free / sum, step.block / sum];
        Self {
            step,
            sum,
            share,
            log_memory: libm::log1p(-sum.min(1.0)),
            // The state that is left sooner tells how the memory fades.
            part: regular[0] * share[1] + regular[1] * share[0],
            part_grows: (regular[0] - regular[1]) / sum,
        }
    }

    /// What is seen `steps` after the cell was free or `blocked`.
    ///
    /// For a Markov chain P = π + (x₀ − π) λ^n, with the derivatives dP/da = π₀ S + (1 − x₀ − π₀) n λ^(n−1),
    /// likewise for b, where S = (1 − λ^n)/(a + b). For stays by the clock the memory fades in a straight
    /// line, 1 − (a + b) n, as long as that is above 0.
    pub(crate) fn over(&self, blocked: bool, steps: f64) -> GapEnd {
        let Self { step, sum, share, .. } = *self;
        let [chain, chain_fades] = if sum < 1.0 {
            let memory = libm::exp(steps * self.log_memory);
            [memory, steps * memory / (1.0 - sum)]
        } else {
            [step.memory(steps), f64::from(u8::from(steps < ONE_STEP))]
        };
        let (mut memory, mut fades, mut grows) = (chain, chain_fades, 0.0);
        let was = if blocked { [0.0, 1.0] } else { [1.0, 0.0] };
        let apart = [was[0] - share[0], was[1] - share[1]];
        if self.part > 0.0 {
            let line = (1.0 - sum * steps).max(0.0);
            let line_fades = if line > 0.0 { steps } else { 0.0 };
            memory += self.part * (line - chain);
            fades += self.part * (line_fades - chain_fades);
            grows = apart[1] * self.part_grows * (line - chain);
        }
        let spent = (1.0 - memory) / sum;
        GapEnd {
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
                    let found = Gaze::new(step, [0.0; 2]).over(blocked, f64::from(steps)).blocked;
                    assert!((found - stepped(step, blocked, steps)).abs() < 1e-12, "{step:?} after {steps}");
                    let chain = Chain { block: step.block / 0.1, free: step.free / 0.1, period: 0.1 };
                    let state = if blocked { CellState::Blocked } else { CellState::Free };
                    let predicted = chain.blocked_probability(state, f64::from(steps) * 0.1);
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
                    let at =
                        |by: f64| Gaze::new(moved(*step, state, by), regular).over(blocked, steps).blocked;
                    let (found, expected) = (
                        Gaze::new(*step, regular).over(blocked, steps).slope[state],
                        (at(1e-5) - at(-1e-5)) / 2e-5,
                    );
                    assert!((found - expected).abs() < 1e-8, "{step:?}, {steps}: {found}, not {expected}");
                }
            }
        }
    }

    #[test]
    fn without_a_period_time_is_continuous() {
        let chain = Chain { block: 0.2, free: 0.3, period: 0.0 };
        let expected = 0.4 - 0.4 * (-0.5f64 * 3.0).exp();
        assert!((chain.blocked_probability(CellState::Free, 3.0) - expected).abs() < 1e-12);
    }

    #[test]
    fn a_cell_that_changes_at_every_step_alternates_for_one_step() {
        let chain = Chain { block: 1.0, free: 1.0, period: 1.0 };
        assert_eq!(chain.blocked_probability(CellState::Free, 1.0), 1.0);
        assert_eq!(chain.blocked_probability(CellState::Free, 2.0), 0.5);
    }
}
