use super::candidates::{CANDIDATES, Candidates, Law, Weights, normalized};
use crate::SLOT_STEPS;
use crate::calendar::{PHASES, Phases};

/// The least share of its prior probability that a candidate has after an update of the prior.
const MIN_SHARE: f64 = 0.001;

/// What is known about one thing, given that the building is now quiet or active.
///
/// Laws are computed at anchors whose distance grows with the time since the last look; in between the
/// probability is linear.
#[derive(Clone, Debug)]
pub(super) struct Track {
    begin: Anchor,
    end: Anchor,
    /// The step of the last look.
    seen: usize,
}

/// The laws at a step: [quiet, active].
#[derive(Clone, Debug)]
struct Anchor {
    step: usize,
    laws: Box<[Law; 2]>,
    /// The probabilities of being blocked.
    blocked: [f64; 2],
}

impl Anchor {
    fn new(step: usize, laws: [Law; 2]) -> Self {
        let mass = |law: &[[f32; CANDIDATES]]| f64::from(law.iter().map(sum).sum::<f32>());
        let blocked = [0, 1].map(|regime| {
            let [free, blocked] = [mass(&laws[regime][..PHASES / 2]), mass(&laws[regime][PHASES / 2..])];
            blocked / (free + blocked)
        });
        Self { step, laws: Box::new(laws), blocked }
    }

    fn later(&self, candidates: &Candidates, steps: usize) -> Self {
        let laws = [0, 1].map(|regime| candidates.advanced(&self.laws[regime], regime, steps));
        Self::new(self.step + steps, laws)
    }
}

impl Track {
    pub(super) fn new(candidates: &Candidates) -> Self {
        let begin = Anchor::new(0, candidates.start);
        let end = begin.later(candidates, 1);
        Self { begin, end, seen: 0 }
    }

    /// The time has come to a step; `mixing[to][from]` is the probability that the building came from a state.
    pub(super) fn advance(&mut self, candidates: &Candidates, step: usize, mixing: Option<&[[f64; 2]; 2]>) {
        if step < self.end.step {
            return;
        }
        std::mem::swap(&mut self.begin, &mut self.end);
        if let Some(mixing) = mixing {
            let laws = mixing.map(|shares| {
                let [quiet, active] = shares.map(|share| share as f32);
                let [law, other] = &*self.begin.laws;
                std::array::from_fn(|phase| {
                    std::array::from_fn(|index| quiet * law[phase][index] + active * other[phase][index])
                })
            });
            self.begin = Anchor::new(step, laws);
        }
        self.plan(candidates);
    }

    /// The next anchor: within the slot, and not later than half of the time since the last look.
    fn plan(&mut self, candidates: &Candidates) {
        let at = self.begin.step;
        let longest = ((at - self.seen) / 2).max(1).min(SLOT_STEPS - at % SLOT_STEPS);
        let steps = if longest == SLOT_STEPS { SLOT_STEPS } else { 1 << longest.ilog2() };
        self.end = self.begin.later(candidates, steps);
    }

    /// A look; returns how probable its result was while the building is quiet and active.
    pub(super) fn look(&mut self, candidates: &Candidates, step: usize, is_blocked: bool) -> [f64; 2] {
        let now = self.begin.later(candidates, step - self.begin.step);
        let likelihoods = now.blocked.map(|blocked| if is_blocked { blocked } else { 1.0 - blocked });
        let mut laws = *now.laws;
        for (law, likelihood) in laws.iter_mut().zip(likelihoods) {
            let scale = likelihood.max(1e-12).recip() as f32;
            let first = PHASES / 2 * usize::from(is_blocked);
            for (phase, law) in law.iter_mut().enumerate() {
                let scale = if (first..first + PHASES / 2).contains(&phase) { scale } else { 0.0 };
                law.iter_mut().for_each(|share| *share *= scale);
            }
        }
        self.begin = Anchor::new(step, laws);
        self.seen = step;
        self.plan(candidates);
        likelihoods
    }

    /// The probabilities of being blocked while the building is quiet and active.
    pub(super) fn probabilities(&self, step: usize) -> [f64; 2] {
        let part = (step - self.begin.step) as f64 / (self.end.step - self.begin.step) as f64;
        std::array::from_fn(|regime| {
            let [begin, end] = [self.begin.blocked[regime], self.end.blocked[regime]];
            (begin + part * (end - begin)).clamp(0.0, 1.0)
        })
    }

    /// The law of the phases over all candidates.
    pub(super) fn phases(&self, step: usize, active: f64) -> Phases {
        let part = (step - self.begin.step) as f64 / (self.end.step - self.begin.step) as f64;
        std::array::from_fn(|phase| {
            let share = |anchor: &Anchor| {
                let [quiet, busy] = [0, 1].map(|regime| f64::from(sum(&anchor.laws[regime][phase])));
                quiet + active * (busy - quiet)
            };
            let [begin, end] = [&self.begin, &self.end].map(share);
            begin + part * (end - begin)
        })
    }

    /// The prior probabilities of the candidates change. Each candidate then has at least a small share of its prior
    /// probability: none of them is exact, so that looks must not exclude one for good (Herbster and Warmuth, 1998).
    pub(super) fn change_prior(
        &mut self,
        candidates: &Candidates,
        from: &Weights,
        to: &Weights,
        active: f64,
    ) {
        let before = self.weights(active);
        let after = normalized(std::array::from_fn(|index| before[index] * to[index] / from[index]));
        let factors: [f64; CANDIDATES] = std::array::from_fn(|index| {
            ((1.0 - MIN_SHARE) * after[index] + MIN_SHARE * to[index]) / before[index].max(1e-30)
        });
        let mut laws = *self.begin.laws;
        for law in &mut laws {
            for law in law.iter_mut() {
                law.iter_mut().zip(factors).for_each(|(share, factor)| *share *= factor as f32);
            }
            let scale = law.iter().map(sum).sum::<f32>().recip();
            law.iter_mut().flatten().for_each(|share| *share *= scale);
        }
        let steps = self.end.step - self.begin.step;
        self.begin = Anchor::new(self.begin.step, laws);
        self.end = self.begin.later(candidates, steps);
    }

    /// The law over phases and candidates at the last anchor.
    pub(super) fn law(&self, active: f64) -> Law {
        let [quiet, busy] = &*self.begin.laws;
        let share = active as f32;
        std::array::from_fn(|phase| {
            std::array::from_fn(|index| {
                quiet[phase][index] + share * (busy[phase][index] - quiet[phase][index])
            })
        })
    }

    /// The weights of the candidates.
    pub(super) fn weights(&self, active: f64) -> Weights {
        std::array::from_fn(|index| {
            let [quiet, busy] = [0, 1]
                .map(|regime| self.begin.laws[regime].iter().map(|law| f64::from(law[index])).sum::<f64>());
            quiet + active * (busy - quiet)
        })
    }
}

/// The sum of the shares of all candidates, in lanes.
fn sum(shares: &[f32; CANDIDATES]) -> f32 {
    let mut lanes = [0.0; 8];
    for shares in shares.chunks_exact(8) {
        lanes.iter_mut().zip(shares).for_each(|(lane, share)| *lane += share);
    }
    lanes.iter().sum()
}
