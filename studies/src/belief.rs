//! What a robot believes about a thing: the law of its phase, after all looks, by a model of its habit.

use crate::calendar::{
    Habit, Hours, Law, Matrix, PHASES, Phases, SLOT_S, WEEK_S, advanced, blocked_probability, product,
};
use crate::{SLOT_STEPS, STEP_S};

/// Transitions in 2⁰ to 2¹⁶ steps: the longest is more than a week.
pub(crate) const POWERS: usize = 17;
/// Weeks after which the law of a thing repeats from week to week, for all stays of up to about a week.
const WEEKS_TO_REPEAT: usize = 20;

/// A model of the habit of a thing, with what takes time to compute.
#[derive(Clone, Debug)]
pub struct Model {
    hours: Hours,
    /// Transitions in 2ⁿ steps, while the place is quiet and while it is active.
    powers: [Vec<Matrix>; 2],
    start: Phases,
    cycle_s: f64,
}

impl Model {
    /// The model that is the habit itself.
    pub fn of(habit: &Habit) -> Self {
        let powers = [false, true].map(|is_active| {
            let times = (0..POWERS).map(|power| STEP_S * (1_u64 << power) as f64);
            times.map(|time_s| habit.transitions(is_active, time_s)).collect()
        });
        Self::new(habit.hours.clone(), powers, habit.cycle_s())
    }

    /// A model with these hours, the transitions in 2ⁿ steps (quiet, active), and the mean time of a cycle, s.
    pub(crate) fn new(hours: Hours, powers: [Vec<Matrix>; 2], cycle_s: f64) -> Self {
        let start = week_start(&hours, &powers);
        Self { hours, powers, start, cycle_s }
    }

    /// The law of the phase at the beginning of a week, without any look.
    pub fn start(&self) -> &Phases {
        &self.start
    }

    /// The mean time of a cycle (free and blocked), s.
    pub fn cycle_s(&self) -> f64 {
        self.cycle_s
    }

    /// The transitions in the step that begins with `step`.
    pub fn step(&self, step: usize) -> &Matrix {
        &self.regime(step)[0]
    }

    fn regime(&self, step: usize) -> &[Matrix] {
        &self.powers[usize::from(self.hours.is_active(step as f64 * STEP_S))]
    }

    /// The integral, in steps, of the variance that a look at `step` is expected to take away from the predictions of the next
    /// `horizon` steps: the variance of the state, p (1 − p), times the sum of ρ², where ρ(τ) is the difference that the
    /// state makes for the probability a time τ later.
    ///
    /// It is exact at the ends of intervals that grow with τ, and linear in between.
    pub fn gain(&self, belief: &Belief, step: usize, horizon: usize) -> f64 {
        let p = belief.probability();
        let variance = p * (1.0 - p);
        if variance <= 1e-12 { 0.0 } else { variance * self.memory(belief, step, horizon) }
    }

    /// The sum of ρ² over the next `horizon` steps.
    fn memory(&self, belief: &Belief, step: usize, horizon: usize) -> f64 {
        self.memories(belief, step, [horizon])[0]
    }

    /// The sums of ρ² over the next steps, up to each of these horizons, which increase.
    pub(crate) fn memories<const N: usize>(
        &self,
        belief: &Belief,
        step: usize,
        horizons: [usize; N],
    ) -> [f64; N] {
        let mut laws = [false, true].map(|is_blocked| belief.after(is_blocked).phases);
        // The laws at the last switch, and the time then. What was learned of a thing is a mixture of many habits, which
        // is no chain: in place of one transition after the other, the longest ones from the switch on.
        let (mut at_switch, mut since) = (laws, 0);
        let (mut ahead, mut square, mut sum) = (0, 1.0, 0.0);
        let mut switch = 0;
        horizons.map(|horizon| {
            while ahead < horizon && square > 1e-6 {
                let at = step + ahead;
                if switch <= at {
                    switch = self.next_switch(at);
                    (at_switch, since) = (laws, ahead);
                }
                let longest = (horizon - ahead).min((ahead / 2).max(1)).min(switch.saturating_sub(at).max(1));
                let power = (longest.ilog2() as usize).min(POWERS - 1);
                let passed = ahead + (1 << power) - since;
                laws = at_switch.map(|law| longest_first(law, self.regime(at), passed));
                let rho = blocked_probability(&laws[1]) - blocked_probability(&laws[0]);
                sum += 0.5 * (square + rho * rho) * (1_u64 << power) as f64;
                square = rho * rho;
                ahead += 1 << power;
            }
            sum
        })
    }

    /// The first step after `step` at which the place becomes active or quiet.
    fn next_switch(&self, step: usize) -> usize {
        // Infinite becomes the largest number.
        (self.hours.next_switch_s(step as f64 * STEP_S) / STEP_S) as usize
    }

    /// The law of the phases after `count` steps from `step` on.
    fn later(&self, law: &Phases, step: usize, count: usize) -> Phases {
        let (mut law, mut at, end) = (*law, step, step + count);
        let mut switch = step;
        while at < end {
            if switch <= at {
                switch = self.next_switch(at);
            }
            let longest = (end - at).min(switch.saturating_sub(at).max(1));
            let power = (longest.ilog2() as usize).min(POWERS - 1);
            law = advanced(&law, &self.regime(at)[power]);
            at += 1 << power;
        }
        law
    }
}

/// The law after a number of steps with these transitions in 2ⁿ steps, the longest ones first.
fn longest_first(law: Phases, powers: &[Matrix], steps: usize) -> Phases {
    let bits = (0..POWERS).rev().filter(|power| steps >> power & 1 == 1);
    bits.fold(law, |law, power| advanced(&law, &powers[power]))
}

/// The law of the phase at the beginning of a week that the habit comes back to.
fn week_start(hours: &Hours, powers: &[Vec<Matrix>; 2]) -> Phases {
    let slots = [0, 1].map(|regime| {
        let identity: Matrix =
            std::array::from_fn(|row| std::array::from_fn(|at| f64::from(u8::from(row == at))));
        let bits = (0..POWERS).filter(|power| SLOT_STEPS >> power & 1 == 1);
        bits.fold(identity, |all, power| product(&all, &powers[regime][power]))
    });
    let week = (0..(WEEK_S / SLOT_S) as usize).map(|slot| usize::from(hours.is_active(slot as f64 * SLOT_S)));
    let mut law = [1.0 / PHASES as f64; PHASES];
    for _ in 0..WEEKS_TO_REPEAT {
        law = week.clone().fold(law, |law, regime| advanced(&law, &slots[regime]));
    }
    law
}

/// The law of the phase of a thing after all looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Belief {
    phases: Phases,
}

impl Belief {
    /// The belief without any look, at the beginning of a week.
    pub fn new(model: &Model) -> Self {
        Self { phases: model.start }
    }

    /// The belief that is this law of the phases.
    pub(crate) fn of_phases(phases: Phases) -> Self {
        Self { phases }
    }

    /// The probability that the thing is blocked.
    pub fn probability(&self) -> f64 {
        blocked_probability(&self.phases).clamp(0.0, 1.0)
    }

    /// Lets the step that begins with `step` pass.
    pub fn advance(&mut self, model: &Model, step: usize) {
        self.phases = advanced(&self.phases, model.step(step));
    }

    /// The belief after `count` steps from `step` on.
    pub(crate) fn later(&self, model: &Model, step: usize, count: usize) -> Self {
        Self { phases: model.later(&self.phases, step, count) }
    }

    /// A look shows the state.
    pub fn look(&mut self, is_blocked: bool) {
        *self = self.after(is_blocked);
    }

    /// The belief after a look that shows this state. A state that was impossible: both phases are as probable.
    pub(crate) fn after(&self, is_blocked: bool) -> Self {
        let first = 2 * usize::from(is_blocked);
        let [short, long] = [self.phases[first], self.phases[first + 1]];
        let long = if short + long > 1e-300 { long / (short + long) } else { 0.5 };
        let mut phases = [0.0; PHASES];
        phases[first] = 1.0 - long;
        phases[first + 1] = long;
        Self { phases }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calendar::Stays;

    #[test]
    fn the_gain_of_a_chain_is_the_closed_form() {
        let (free_s, blocked_s) = (4000.0_f64, 2000.0_f64);
        let model = Model::of(&Habit::chain(free_s, blocked_s));
        let belief = Belief::new(&model);
        let p = blocked_s / (free_s + blocked_s);
        assert!((belief.probability() - p).abs() < 1e-9);
        let sum = 1.0 / free_s + 1.0 / blocked_s;
        for horizon in [1, 30, 300, 20_000] {
            let time_s = horizon as f64 * STEP_S;
            let expected = p * (1.0 - p) * (1.0 - (-2.0 * sum * time_s).exp()) / (2.0 * sum) / STEP_S;
            let gain = model.gain(&belief, 0, horizon);
            assert!((gain / expected - 1.0).abs() < 0.03, "{horizon}: {gain} against {expected}");
        }
    }

    /// The gain is the difference of the expected Brier scores without and with the look, summed step by step.
    #[test]
    fn the_gain_is_what_a_look_takes_away() {
        let stays = |short_s, long_s| Stays { short_s, long_s, long_share: 0.3 };
        let habit = Habit {
            hours: Hours::daily(&[0, 1, 2, 3, 4], 8.0, 18.0),
            active: [stays(600.0, 9000.0), stays(300.0, 7000.0)],
            quiet: [Stays::of_mean(90_000.0), Stays::of_mean(5000.0)],
        };
        let model = Model::of(&habit);
        let start = (17.5 * 360.0) as usize;
        let mut belief = Belief::new(&model);
        (0..start).for_each(|step| belief.advance(&model, step));
        let horizon = 1000;
        let variance = |mut belief: Belief| {
            let steps = (start..start + horizon).map(|step| {
                belief.advance(&model, step);
                belief.probability() * (1.0 - belief.probability())
            });
            steps.sum::<f64>()
        };
        let p = belief.probability();
        let [free, blocked] = [false, true].map(|is_blocked| variance(belief.after(is_blocked)));
        let expected = variance(belief.clone()) - (1.0 - p) * free - p * blocked;
        let gain = model.gain(&belief, start, horizon);
        assert!((gain / expected - 1.0).abs() < 0.05, "{gain} against {expected}");
    }
}
