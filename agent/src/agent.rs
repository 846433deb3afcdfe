use crate::goal::{Goal, GoalSampler};
use crate::knowledge::knowledge;
use crate::{AgentSettings, Chooser, Features, Policy, Reward, Situation, Strategy, Trajectory, Travel};
use interfaces::{RandomStream, SettingsError, Transition};
use mapper::Mapper;
use nalgebra::Isometry2;

/// How much one strategy was used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Goals that it sampled.
    pub goals: usize,
    /// Readings while it was followed.
    pub readings: usize,
}

/// Decides where to look next (section 4).
///
/// [`Agent::watch`] every reading; ask for the [`Agent::next_goal`] when the controller hands back.
/// The same seed, readings and calls give the same goals, bit for bit.
#[derive(Debug)]
pub struct Agent {
    strategies: Vec<Box<dyn Strategy>>,
    chooser: Box<dyn Chooser>,
    goals: GoalSampler,
    /// The time to each cell, for strategies that ask for it.
    travel: Vec<f64>,
    reward: Reward,
    rng: RandomStream,
    /// The strategy that sampled the present goal.
    current: Option<usize>,
    /// The features of every reading since the present goal was sampled, T of section 4.
    trajectory: Vec<Features>,
    /// The map updates in these readings.
    updates: usize,
    /// What was known when the present goal was sampled.
    known: f64,
    features: Features,
    tallies: Vec<Tally>,
    last_reward: f64,
    last_length: usize,
}

impl Agent {
    /// An agent that decides by `policy`. All random numbers come from `rng`.
    ///
    /// # Errors
    ///
    /// When a setting makes no sense.
    pub fn new(
        settings: &AgentSettings,
        policy: &Policy,
        mut rng: RandomStream,
    ) -> Result<Self, SettingsError> {
        settings.check()?;
        let (strategies, chooser) = policy.build(settings, &mut rng);
        Self::with(settings, strategies, chooser, rng)
    }

    /// An agent of any strategies under any chooser. Where the chooser gives an index beyond the last
    /// strategy, the agent uses the last.
    ///
    /// # Errors
    ///
    /// When a setting makes no sense, or there is no strategy.
    pub fn with(
        settings: &AgentSettings,
        strategies: Vec<Box<dyn Strategy>>,
        chooser: Box<dyn Chooser>,
        rng: RandomStream,
    ) -> Result<Self, SettingsError> {
        settings.check()?;
        if strategies.is_empty() {
            return Err(crate::settings::error("strategies", "at least one", "none"));
        }
        Ok(Self {
            tallies: vec![Tally::default(); strategies.len()],
            strategies,
            chooser,
            goals: GoalSampler::new(settings.patch_cells),
            travel: Vec::new(),
            reward: settings.reward,
            rng,
            current: None,
            trajectory: Vec::new(),
            updates: 0,
            known: 0.0,
            features: Features::default(),
            last_reward: 0.0,
            last_length: 0,
        })
    }

    /// Takes note of one reading: the features after it, and the cells that took another state in
    /// it. Readings before the first goal belong to no strategy.
    pub fn watch(&mut self, features: Features, transitions: &[Transition]) {
        self.features = features;
        if let Some(strategy) = self.current {
            self.trajectory.push(features);
            self.updates += self.reward.count(transitions);
            self.tallies[strategy].readings += 1;
        }
    }

    /// Ends the trajectory to the last goal, learns from it, chooses a strategy and samples the
    /// next goal: a cell of the grid that [can be a goal](Mapper::is_candidate), or, if there is
    /// none yet, the robot's own cell.
    pub fn next_goal(&mut self, mapper: &Mapper, pose: &Isometry2<f64>, travel: &mut impl Travel) -> Goal {
        self.learn(mapper);
        self.travel.clear();
        if self.strategies.iter().any(|strategy| strategy.needs_travel()) {
            travel.times(mapper, pose, &mut self.travel);
        }
        let situation = Situation::new(mapper, pose, self.features).with_travel(&self.travel);
        let strategy = self.chooser.choose(&situation, &mut self.rng).min(self.strategies.len() - 1);
        self.current = Some(strategy);
        self.tallies[strategy].goals += 1;
        self.goals.sample(&mut *self.strategies[strategy], &situation, &mut self.rng)
    }

    fn learn(&mut self, mapper: &Mapper) {
        let before = std::mem::replace(&mut self.known, knowledge(mapper));
        // A goal given up before the next reading came teaches nothing.
        let Some(strategy) = self.current.filter(|_| !self.trajectory.is_empty()) else { return };
        self.last_length = self.trajectory.len();
        self.last_reward = self.updates as f64 / self.last_length as f64;
        // A first sighting that turned out wrong takes back what it brought.
        let progress = (self.known - before).max(0.0) / self.last_length as f64;
        let (features, reward) = (&self.trajectory[..], self.last_reward);
        self.chooser.learn(&Trajectory { strategy, features, reward, progress });
        self.trajectory.clear();
        self.updates = 0;
    }

    /// The names of the strategies, by their places.
    pub fn strategies(&self) -> impl ExactSizeIterator<Item = &'static str> {
        self.strategies.iter().map(|strategy| strategy.name())
    }

    /// The place of the strategy that sampled the present goal; `None` before the first.
    pub fn current(&self) -> Option<usize> {
        self.current
    }

    /// What a strategy is believed to bring at `features`, in what the chooser is rewarded
    /// for per reading; `None` from a chooser that does not value strategies, and for a place without a strategy.
    pub fn value(&self, strategy: usize, features: Features) -> Option<f64> {
        self.chooser.value(strategy, features)
    }

    /// How much each strategy was used, by their places.
    pub fn tallies(&self) -> &[Tally] {
        &self.tallies
    }

    /// The share of the goals so far that each strategy sampled, by their places; all 0 before the
    /// first goal.
    pub fn shares(&self) -> impl ExactSizeIterator<Item = f64> {
        let goals: usize = self.tallies.iter().map(|tally| tally.goals).sum();
        self.tallies.iter().map(move |tally| tally.goals as f64 / goals.max(1) as f64)
    }

    /// The reward of the last finished trajectory, in map updates per reading; 0 before the first.
    pub fn last_reward(&self) -> f64 {
        self.last_reward
    }

    /// The length of the last finished trajectory, in readings; 0 before the first.
    pub fn last_length(&self) -> usize {
        self.last_length
    }
}
