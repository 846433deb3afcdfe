//! A cell as a two-state Markov chain that steps with the readings.

use geometry::CellState;

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

impl Step {
    /// How much of knowing the state is left after some steps: λ^steps with λ = 1 − block − free.
    pub(crate) fn memory(self, steps: f64) -> f64 {
        let lost = self.block + self.free;
        if lost < 1.0 {
            libm::exp(steps * libm::log1p(-lost))
        } else {
            // A cell that changes at nearly every step alternates: only whole steps mean something.
            libm::pow(1.0 - lost, libm::round(steps))
        }
    }

    /// What is seen `steps` after the cell was free or `blocked`.
    ///
    /// For a Markov chain P = π + (x₀ − π) λ^n, with the derivatives dP/da = π₀ S + (1 − x₀ − π₀) n λ^(n−1),
    /// likewise for b, where S = (1 − λ^n)/(a + b). For stays by the clock the memory fades in a straight line,
    /// 1 − (a + b) n, as long as that is above 0. `regular` mixes the two.
    pub(crate) fn over(self, blocked: bool, steps: f64, regular: [f64; 2]) -> GapEnd {
        let sum = self.block + self.free;
        let share = [self.free / sum, self.block / sum];
        // The state that is left sooner tells how the memory fades.
        let line = regular[0] * share[1] + regular[1] * share[0];
        let memory = self.memory(steps);
        let late = if sum < 1.0 { steps * memory / (1.0 - sum) } else { steps * self.memory(steps - 1.0) };
        let left = (1.0 - sum * steps).max(0.0);
        let late = (1.0 - line) * late + line * if left > 0.0 { steps } else { 0.0 };
        let memory = (1.0 - line) * memory + line * left;
        let was = if blocked { [0.0, 1.0] } else { [1.0, 0.0] };
        let spent = (1.0 - memory) / sum;
        GapEnd {
            blocked: (share[1] + (was[1] - share[1]) * memory).clamp(0.0, 1.0),
            slope: [
                (share[0] * spent + (was[0] - share[0]) * late) * self.block * (1.0 - self.block),
                -(share[1] * spent + (was[1] - share[1]) * late) * self.free * (1.0 - self.free),
            ],
        }
    }
}
