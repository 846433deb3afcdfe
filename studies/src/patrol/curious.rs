use super::fixed_length::NextViewpoint;
use super::view::{Seen, View};
use crate::STEP_S;
use agent::{Chooser, Curious, Features, Trajectory};
use interfaces::RandomStream;

/// The paper's robot at viewpoints: its learner chooses `recency` or `poisson` for every goal, and a viewpoint is drawn in
/// proportion to the mean weight of the things that are seen from it.
pub(super) struct CuriousViewpoints {
    learner: Option<Curious>,
    strategy: usize,
    /// The features when the goal was chosen.
    features: Features,
}

/// The index of `recency`; that of `poisson` is 1.
const RECENCY: usize = 0;

impl CuriousViewpoints {
    pub(super) fn new() -> Self {
        Self { learner: None, strategy: RECENCY, features: Features { p: 0.0, r: 0.0 } }
    }
}

/// Eq. 2 with the mean time T of a cycle: 1 − e^(−age/T).
fn change_probability(view: &View<'_>, thing: usize) -> f64 {
    let age_s = view.age(thing) as f64 * STEP_S;
    1.0 - libm::exp(-age_s / view.models[thing].cycle_s())
}

impl NextViewpoint for CuriousViewpoints {
    fn next(&mut self, view: &View<'_>, rng: &mut RandomStream) -> Option<usize> {
        let things = 0..view.building.things.len();
        self.features = Features {
            p: things.clone().map(|thing| change_probability(view, thing)).sum(),
            r: things.map(|thing| view.age(thing)).max().unwrap_or(0) as f64 * STEP_S,
        };
        let learner = self.learner.get_or_insert_with(|| Curious::new(2.0, 2, rng));
        let probabilities = learner.probabilities(self.features);
        self.strategy = usize::from(!rng.bernoulli(probabilities[RECENCY]));
        let weight = |viewpoint: usize| {
            let sees = &view.building.viewpoints[viewpoint].sees;
            let weights = sees.iter().map(|thing| match self.strategy {
                RECENCY => view.age(*thing) as f64,
                _ => change_probability(view, *thing),
            });
            weights.sum::<f64>() / sees.len().max(1) as f64
        };
        let allowed: Vec<usize> =
            (0..view.building.viewpoints.len()).filter(|viewpoint| view.is_open(*viewpoint)).collect();
        let weights: Vec<f64> = allowed.iter().map(|viewpoint| weight(*viewpoint)).collect();
        let sum: f64 = weights.iter().sum();
        if sum <= 0.0 {
            let drawn = rng.uniform(0.0..allowed.len() as f64) as usize;
            return allowed.get(drawn).copied();
        }
        let mut left = rng.uniform(0.0..sum);
        let drawn = weights.iter().position(|weight| {
            left -= weight;
            left < 0.0
        });
        drawn.map(|at| allowed[at]).or(allowed.last().copied())
    }

    fn learn(&mut self, seen: &Seen<'_>) {
        let (features, strategy) = ([self.features], self.strategy);
        let reward = seen.changes as f64 / seen.steps.max(1) as f64;
        if let Some(learner) = &mut self.learner {
            learner.learn(&Trajectory { strategy, features: &features, reward });
        }
    }
}
