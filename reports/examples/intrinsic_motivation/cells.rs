//! The learner over single steps: a table with a value for each cell of the robot and each action.

use crate::motives::{Motive, Scale};
use crate::view::View;
use agent::Features;
use interfaces::{RandomStream, Step};
use mapper::Mapper;
use robot::{Belief, Pilot};

/// The settings of Q-learning.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellSettings {
    /// The step size.
    pub(crate) alpha: f64,
    /// The discount per step.
    pub(crate) gamma: f64,
    /// The probability of a random action.
    pub(crate) epsilon: f64,
    /// The value of an action that was never tried, in root mean squares of the reward.
    pub(crate) optimism: f64,
    /// The earlier steps that are learned again at every step (Dyna-Q, Sutton 1990), from the last reward of each.
    pub(crate) replays: usize,
}

impl Default for CellSettings {
    fn default() -> Self {
        Self { alpha: 0.3, gamma: 0.95, epsilon: 0.05, optimism: 100.0, replays: 0 }
    }
}

const ACTIONS: usize = Step::ALL.len();

/// Tabular Q-learning.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    settings: CellSettings,
    values: Vec<[f64; ACTIONS]>,
    /// The last reward and the next state after each action in each state.
    model: Vec<[Option<(f64, usize)>; ACTIONS]>,
    /// The pairs that `model` has.
    known: Vec<(usize, usize)>,
    last: Option<(usize, usize)>,
    rng: RandomStream,
}

impl Table {
    pub(crate) fn new(states: usize, settings: CellSettings, rng: RandomStream) -> Self {
        let (values, model) = (vec![[settings.optimism; ACTIONS]; states], vec![[None; ACTIONS]; states]);
        Self { settings, values, model, known: Vec::new(), last: None, rng }
    }

    /// Learns that the last action was paid `reward` and led to `state`. Returns the next action.
    pub(crate) fn act(&mut self, reward: f64, state: usize) -> usize {
        if let Some((before, action)) = self.last {
            if self.model[before][action].replace((reward, state)).is_none() {
                self.known.push((before, action));
            }
            self.learn(before, action, reward, state);
            for _ in 0..self.settings.replays {
                let (before, action) = self.known[draw(&mut self.rng, self.known.len())];
                if let Some((reward, state)) = self.model[before][action] {
                    self.learn(before, action, reward, state);
                }
            }
        }
        let is_random = self.rng.bernoulli(self.settings.epsilon);
        let action = if is_random { draw(&mut self.rng, ACTIONS) } else { self.best(state) };
        self.last = Some((state, action));
        action
    }

    fn learn(&mut self, before: usize, action: usize, reward: f64, state: usize) {
        let next = self.values[state].iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let value = &mut self.values[before][action];
        *value += self.settings.alpha * (reward + self.settings.gamma * next - *value);
    }

    /// The action with the largest value; a random one of several.
    fn best(&mut self, state: usize) -> usize {
        let (mut best, mut ties) = (0, 1);
        for action in 1..ACTIONS {
            let (value, largest) = (self.values[state][action], self.values[state][best]);
            ties = if value > largest { 1 } else { ties + usize::from(value == largest) };
            if value > largest || (value == largest && draw(&mut self.rng, ties) == 0) {
                best = action;
            }
        }
        best
    }
}

/// A random number below `count`, which is at least 1.
pub(crate) fn draw(rng: &mut RandomStream, count: usize) -> usize {
    (rng.uniform(0.0..count as f64) as usize).min(count - 1)
}

/// A robot that is driven by a [`Table`].
pub(crate) struct CellPilot {
    pub(crate) table: Table,
    pub(crate) motive: Box<dyn Motive>,
    pub(crate) scale: Scale,
    /// The range of the sensor, cells.
    pub(crate) reach: i32,
}

impl Pilot for CellPilot {
    type Command = Step;

    fn command(&mut self, belief: &Belief, _: Features, mapper: &Mapper) -> Step {
        let view = View::new(mapper, &belief.pose, self.reach);
        let reward = self.scale.scaled(self.motive.reward(&view));
        let state = mapper.frame().index(view.robot).unwrap_or(0);
        Step::ALL[self.table.act(reward, state)]
    }
}
