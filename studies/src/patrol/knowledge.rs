use crate::belief::{Belief, Model};
use crate::building::{Building, ThingKind};
use crate::learner::Learner;

/// The learned models for planning are renewed after this time, steps: three hours.
const MODEL_STEPS: usize = 1080;

/// Whether a robot knows the habits of the things, or learns them from its looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Habits {
    /// They are known.
    #[default]
    Known,
    /// They are learned.
    Learned,
    /// They are learned for the predictions; the strategies know them. No robot is so: it shows what is lost by learned plans.
    KnownToPlan,
    /// They are learned for the strategies; the predictions know them: it shows what is lost by learned predictions.
    KnownToPredict,
}

impl Habits {
    /// All of them, with their names.
    pub const ALL: [(&'static str, Self); 4] = [
        ("known", Self::Known),
        ("learned", Self::Learned),
        ("known-to-plan", Self::KnownToPlan),
        ("known-to-predict", Self::KnownToPredict),
    ];

    /// The name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, habits)| *habits == self).map_or("", |(name, _)| *name)
    }
}

impl std::str::FromStr for Habits {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(name, _)| *name == word);
        let names = || Self::ALL.map(|(name, _)| name).join(", ");
        found.map(|(_, habits)| *habits).ok_or_else(|| format!("expected one of {}, found `{word}`", names()))
    }
}

/// What a robot knows about the habits of the things, and believes about their states.
pub(super) struct Knowledge {
    habits: Habits,
    /// The models of the habits as they are, and the beliefs with them.
    known: Option<(Vec<Model>, Vec<Belief>)>,
    learner: Option<Learner>,
    /// The models that were learned, and the beliefs at the last decision.
    learned: (Vec<Model>, Vec<Belief>),
    modeled_at: usize,
}

impl Knowledge {
    pub(super) fn new(building: &Building, habits: Habits, models: Vec<Model>) -> Self {
        let is_door = building.things.iter().map(|thing| thing.kind == ThingKind::Door);
        let beliefs = models.iter().map(Belief::new).collect();
        let mut knowledge = Self {
            habits,
            known: (habits != Habits::Learned).then_some((models, beliefs)),
            learner: (habits != Habits::Known).then(|| Learner::new(is_door.collect())),
            learned: (Vec::new(), Vec::new()),
            modeled_at: 0,
        };
        knowledge.learn_models();
        knowledge
    }

    fn plans_with_known(&self) -> bool {
        matches!(self.habits, Habits::Known | Habits::KnownToPlan)
    }

    /// Whether the models change, as the robot learns.
    pub(super) fn is_learning(&self) -> bool {
        !self.plans_with_known()
    }

    /// The models for planning are those of the mean habits.
    fn learn_models(&mut self) {
        let Some(learner) = &mut self.learner else { return };
        learner.learn_priors();
        let hours = learner.hours();
        let things = 0..learner.things();
        self.learned.0 = things.map(|thing| learner.model(thing, hours.clone())).collect();
    }

    /// A decision is due at a step.
    pub(super) fn prepare(&mut self, step: usize) {
        if step >= self.modeled_at + MODEL_STEPS {
            self.modeled_at = step;
            self.learn_models();
        }
        if let Some(learner) = &self.learner {
            let things = 0..learner.things();
            self.learned.1 = things.map(|thing| Belief::of_phases(learner.phases(thing))).collect();
        }
    }

    /// The models and beliefs that strategies plan with.
    pub(super) fn plans(&self) -> (&[Model], &[Belief]) {
        let (models, beliefs) =
            self.known.as_ref().filter(|_| self.plans_with_known()).unwrap_or(&self.learned);
        (models, beliefs)
    }

    /// The probability that a thing is blocked.
    pub(super) fn probability(&self, thing: usize) -> f64 {
        match (&self.known, &self.learner) {
            (Some((_, beliefs)), None) => beliefs[thing].probability(),
            (Some((_, beliefs)), _) if self.habits == Habits::KnownToPredict => beliefs[thing].probability(),
            (_, Some(learner)) => learner.probability(thing),
            (None, None) => 0.5,
        }
    }

    /// The step that begins with `step` passes.
    pub(super) fn advance(&mut self, step: usize) {
        if let Some(learner) = &mut self.learner {
            learner.advance();
        }
        if let Some((models, beliefs)) = &mut self.known {
            beliefs.iter_mut().zip(models).for_each(|(belief, model)| belief.advance(model, step));
        }
    }

    /// A look shows the state of a thing.
    pub(super) fn look(&mut self, thing: usize, is_blocked: bool) {
        if let Some(learner) = &mut self.learner {
            learner.look(thing, is_blocked);
        }
        if let Some((_, beliefs)) = &mut self.known {
            beliefs[thing].look(is_blocked);
        }
    }
}
