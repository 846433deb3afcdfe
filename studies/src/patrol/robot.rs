use super::duty::Duty;
use super::knowledge::{Habits, Knowledge};
use super::view::{Choice, Seen, Strategy, View};
use crate::STEP_S;
use crate::belief::Model;
use crate::building::Building;
use crate::calendar::Timeline;
use interfaces::{Purpose, RandomStream};

/// What a robot did, in steps and in looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Steps in all.
    pub steps: usize,
    /// Steps on patrol: driving and looking.
    pub patrol_steps: usize,
    /// Looks from a viewpoint.
    pub looks: usize,
    /// Looks that ended in front of a closed door.
    pub closed: usize,
}

/// A robot in a building with a calendar, from Monday, 0:00, on. It is at the dock then, with an empty battery.
pub struct Patrol<'a> {
    building: &'a Building,
    duty: Duty,
    knowledge: Knowledge,
    timelines: Vec<Timeline>,
    /// The state of each thing at the last look at it, and its step.
    last_states: Vec<bool>,
    seen: Vec<Option<usize>>,
    step: usize,
    at: usize,
    charge_steps: f64,
    rng: RandomStream,
    totals: Totals,
}

/// What the robot is doing until a step.
struct Errand {
    end: usize,
    begin: usize,
    /// The viewpoint that it goes for, and the one that it reaches; `None`: it rests.
    way: Option<[usize; 2]>,
}

impl<'a> Patrol<'a> {
    /// A robot that knows the habits of all things. What the things do depends on the seed alone, not on the robot.
    pub fn new(building: &'a Building, duty: Duty, seed: u64) -> Self {
        Self::with(building, duty, Habits::Known, seed)
    }

    /// A robot that knows or learns the habits of all things. The things do the same.
    pub fn with(building: &'a Building, duty: Duty, habits: Habits, seed: u64) -> Self {
        let models: Vec<Model> = building.things.iter().map(|thing| Model::of(&thing.habit)).collect();
        let timelines = building.things.iter().zip(&models).enumerate().map(|(index, (thing, model))| {
            let rng = RandomStream::new(seed, Purpose::Thing(index));
            Timeline::of_habit(&thing.habit, model.start(), 0.0, rng)
        });
        let timelines: Vec<Timeline> = timelines.collect();
        let knowledge = Knowledge::new(building, habits, models);
        Self {
            building,
            duty,
            last_states: vec![false; timelines.len()],
            seen: vec![None; timelines.len()],
            timelines,
            knowledge,
            step: 0,
            at: building.dock,
            charge_steps: duty.full_steps().min(if duty.is_always() { f64::INFINITY } else { 0.0 }),
            rng: RandomStream::new(seed, Purpose::Patrol),
            totals: Totals::default(),
        }
    }

    /// Lets a strategy drive the robot for a number of steps. After every step, `score` gets the probability of being blocked and
    /// the true state of every thing. Returns what the robot did.
    pub fn run(
        &mut self,
        strategy: &mut dyn Strategy,
        steps: usize,
        mut score: impl FnMut(&[f64], &[bool]),
    ) -> Totals {
        let things = self.building.things.len();
        let (mut predicted, mut is_blocked) = (vec![0.0; things], vec![false; things]);
        let mut errand: Option<Errand> = None;
        let end = self.step + steps;
        self.observe(&mut is_blocked);
        loop {
            while errand.as_ref().is_none_or(|errand| errand.end <= self.step) {
                if let Some(done) = errand.take() {
                    self.finish(&done, strategy, &is_blocked);
                }
                errand = Some(self.begin(strategy, &is_blocked));
            }
            for (thing, predicted) in predicted.iter_mut().enumerate() {
                *predicted = self.knowledge.probability(thing);
            }
            score(&predicted, &is_blocked);
            self.totals.steps += 1;
            self.pass(&errand);
            if self.step >= end {
                return self.totals;
            }
            self.observe(&mut is_blocked);
        }
    }

    /// What the things do until the step.
    fn observe(&mut self, is_blocked: &mut [bool]) {
        for (timeline, is_blocked) in self.timelines.iter_mut().zip(is_blocked) {
            timeline.advance(self.step as f64 * STEP_S, |_, _| ());
            *is_blocked = timeline.is_blocked();
        }
    }

    /// A step passes.
    fn pass(&mut self, errand: &Option<Errand>) {
        self.knowledge.advance(self.step);
        if errand.as_ref().is_some_and(|errand| errand.way.is_some()) {
            self.charge_steps -= 1.0;
            self.totals.patrol_steps += 1;
        } else {
            self.charge_steps = (self.charge_steps + self.duty.charge_per_step()).min(self.duty.full_steps());
        }
        self.step += 1;
    }

    /// What the robot does next; a way that doors close before the robot leaves ends in front of them.
    fn begin(&mut self, strategy: &mut dyn Strategy, is_blocked: &[bool]) -> Errand {
        let is_docked = self.at == self.building.dock;
        self.knowledge.prepare(self.step);
        let (models, beliefs) = self.knowledge.plans();
        let view = View {
            step: self.step,
            at: self.at,
            is_docked,
            charge_steps: self.charge_steps,
            duty: self.duty,
            building: self.building,
            models,
            is_learning: self.knowledge.is_learning(),
            beliefs,
            last_states: &self.last_states,
            seen: &self.seen,
        };
        let choice = match strategy.choose(&view, &mut self.rng) {
            Choice::Go(goal) if !view.is_allowed(goal) => Choice::Rest(1),
            choice => choice,
        };
        let begin = self.step;
        let goal = match choice {
            Choice::Go(goal) => goal,
            Choice::Rest(steps) if is_docked => {
                return Errand { begin, end: begin + steps.max(1), way: None };
            }
            Choice::Rest(_) => self.building.dock,
        };
        let reached = self.building.reached(self.at, goal, is_blocked);
        Errand { begin, end: begin + self.building.steps[self.at][reached], way: Some([goal, reached]) }
    }

    /// The robot has arrived, and looks.
    fn finish(&mut self, errand: &Errand, strategy: &mut dyn Strategy, is_blocked: &[bool]) {
        let Some([goal, reached]) = errand.way else { return };
        self.at = reached;
        self.totals.looks += 1;
        self.totals.closed += usize::from(goal != reached);
        let sees = &self.building.viewpoints[reached].sees;
        let things: Vec<_> = sees.iter().map(|thing| (*thing, self.seen[*thing])).collect();
        let mut changes = 0;
        for &thing in sees {
            let state = is_blocked[thing];
            changes += usize::from(self.seen[thing].is_some() && self.last_states[thing] != state);
            self.knowledge.look(thing, state);
            self.last_states[thing] = state;
            self.seen[thing] = Some(self.step);
        }
        let steps = self.step - errand.begin;
        strategy.learn(&Seen { step: self.step, goal, reached, steps, things: &things, changes });
    }
}
