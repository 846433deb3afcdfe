use crate::choosers::{Chooser, Trajectory};
use crate::goal_sampler::{Goal, sample};
use crate::policy::Policy;
use crate::settings::AgentSettings;
use crate::situation::{Features, Situation, Travel};
use crate::strategies::{Stay, Strategy};
use crate::unseen::UnseenSpace;
use interfaces::{RandomStream, SettingsError, Transition, Values, values};
use mapper::Mapper;
use nalgebra::Isometry2;

/// Selects goals. Implemented by the agent, and by a tour.
pub trait GoalSelector {
    /// The next goal of a robot at `pose`; `None` when no goal is left. Called when the last goal is finished. `travel` gives
    /// the travel time to every cell.
    fn next_goal(&mut self, pose: &Isometry2<f64>, mapper: &Mapper, travel: &mut impl Travel)
    -> Option<Goal>;

    /// Whether the present goal has served its purpose before the robot is there.
    fn is_obsolete(&self, _: &Mapper) -> bool {
        false
    }

    /// The robot, at `pose`, leaves the last goal, and no other goal follows for a while: it goes to its dock. Can be called more than
    /// once.
    fn end_goal(&mut self, _pose: &Isometry2<f64>, _: &Mapper) {}

    /// Called at every reading: the features after the reading, and the cells that changed their state in it.
    fn observe(&mut self, _: Features, _: &[Transition]) {}

    /// The reason for the last goal, in a few words.
    fn reason(&self) -> String;

    /// The strategies, if the selector has any.
    fn strategies(&self, _features: Features) -> Vec<StrategyState> {
        Vec::new()
    }

    /// Everything that readings and goals have changed: what a state file holds of the selector. `mapper` is that of the same
    /// state; what follows from it is not in the list. Empty for a selector that remembers nothing.
    fn values(&mut self, _mapper: &Mapper) -> Values<'_> {
        Vec::new()
    }
}

/// One strategy of the agent at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct StrategyState {
    /// The name on the command line.
    pub name: String,
    /// The learned value V(p, r) (section 4): the expected number of map updates per observation. `None` if the agent does not
    /// learn.
    pub value: Option<f64>,
    /// The share of goals so far that were selected by this strategy, from 0 to 1.
    pub share: f64,
    /// Whether this strategy selected the present goal. None did before the first goal, and for a look into unseen space.
    pub is_current: bool,
}

/// Selects the next goal of the robot (section 4).
///
/// The same seed, readings and calls give the same goals, bit for bit. Readings before the first goal belong to no strategy.
#[derive(Debug)]
pub struct Agent {
    strategies: Vec<Box<dyn Strategy>>,
    chooser: Box<dyn Chooser>,
    patch_cells: usize,
    /// Looks into unseen space before the strategies decide; `None`: the strategies decide alone.
    unseen: Option<UnseenSpace>,
    /// The travel time to each cell, for strategies that need it.
    travel: Vec<f64>,
    rng: RandomStream,
    /// The index of the strategy that sampled the present goal; `None` for a look into unseen space.
    current: Option<usize>,
    /// The features of every reading since the present goal was sampled, T of section 4.
    trajectory: Vec<Features>,
    /// The map updates in these readings: changes of known cells.
    updates: usize,
    features: Features,
    /// The number of goals that were selected by each strategy.
    goal_counts: Vec<usize>,
    last_reward: f64,
}

impl Agent {
    /// An agent that decides by `policy`. All random numbers come from `rng`.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn new(
        settings: &AgentSettings,
        policy: &Policy,
        mut rng: RandomStream,
    ) -> Result<Self, SettingsError> {
        settings.check()?;
        let (strategies, chooser) = policy.build(settings, &mut rng);
        Self::with(settings, strategies, chooser, rng)
    }

    /// An agent with these strategies and this chooser. If the chooser returns an index beyond the last strategy,
    /// the agent uses the last strategy.
    ///
    /// # Errors
    ///
    /// When a setting is out of range, or there is no strategy.
    pub fn with(
        settings: &AgentSettings,
        strategies: Vec<Box<dyn Strategy>>,
        chooser: Box<dyn Chooser>,
        rng: RandomStream,
    ) -> Result<Self, SettingsError> {
        settings.check()?;
        if strategies.is_empty() {
            let (part, key, expected) = ("agent", "strategies", "at least one");
            return Err(SettingsError { part, key, expected, found: "none".to_owned() });
        }
        Ok(Self {
            goal_counts: vec![0; strategies.len()],
            strategies,
            chooser,
            patch_cells: settings.patch_cells,
            unseen: settings
                .unseen_first
                .then(|| UnseenSpace::new(settings.patch_cells, settings.sensor_radius_m)),
            travel: Vec::new(),
            rng,
            current: None,
            trajectory: Vec::new(),
            updates: 0,
            features: Features::default(),
            last_reward: 0.0,
        })
    }

    /// The reward of the last finished trajectory, in map updates per reading; 0 before the first.
    pub fn last_reward(&self) -> f64 {
        self.last_reward
    }

    fn learn(&mut self) {
        // There is nothing to learn from a trajectory without a reading.
        let Some(strategy) = self.current.filter(|_| !self.trajectory.is_empty()) else { return };
        let length = self.trajectory.len() as f64;
        self.last_reward = self.updates as f64 / length;
        let (features, reward) = (&self.trajectory[..], self.last_reward);
        self.chooser.learn(&Trajectory { strategy, features, reward });
        self.trajectory.clear();
        self.updates = 0;
    }
}

impl GoalSelector for Agent {
    /// Ends the trajectory to the last goal, and learns from the trajectory. With
    /// [`unseen_first`](AgentSettings::unseen_first), and while unseen space can be looked at, the next goal is a
    /// look, which belongs to no strategy. Otherwise the agent chooses a strategy and samples the next
    /// goal: a cell that [can be a goal](Mapper::is_candidate). If there is no such cell, the goal is the cell of
    /// the robot.
    fn next_goal(
        &mut self,
        pose: &Isometry2<f64>,
        mapper: &Mapper,
        travel: &mut impl Travel,
    ) -> Option<Goal> {
        self.learn();
        self.travel.clear();
        let looks = self.unseen.as_mut().is_some_and(|unseen| unseen.update(mapper));
        if looks || self.strategies.iter().any(|strategy| strategy.needs_travel()) {
            travel.times(mapper, pose, &mut self.travel);
        }
        let situation = Situation::new(mapper, pose, self.features).with_travel(&self.travel);
        if let Some(unseen) = self.unseen.as_mut().filter(|_| looks)
            && let Some(look) = unseen.look(&situation)
        {
            self.current = None;
            return Some(Goal {
                position: mapper.frame().center(look.from),
                stay: Stay::Watch(unseen.begin(look)),
            });
        }
        let strategy = self.chooser.choose(&situation, &mut self.rng).min(self.strategies.len() - 1);
        self.current = Some(strategy);
        self.goal_counts[strategy] += 1;
        Some(sample(self.patch_cells, &mut *self.strategies[strategy], &situation, &mut self.rng))
    }

    /// A look into unseen space is obsolete when its target is in view already.
    fn is_obsolete(&self, mapper: &Mapper) -> bool {
        self.current.is_none() && self.unseen.as_ref().is_some_and(|unseen| unseen.is_seen(mapper))
    }

    /// Ends the trajectory and the visit, if the robot is there, and learns from them; nothing is learned from what the robot sees
    /// until the next goal.
    fn end_goal(&mut self, pose: &Isometry2<f64>, mapper: &Mapper) {
        self.learn();
        let situation = Situation::new(mapper, pose, self.features);
        if let Some(strategy) = self.current.take() {
            self.strategies[strategy].end(&situation);
        }
        if let Some(unseen) = &mut self.unseen {
            unseen.end(&situation);
        }
    }

    fn observe(&mut self, features: Features, transitions: &[Transition]) {
        self.features = features;
        if self.current.is_some() {
            self.trajectory.push(features);
            self.updates += transitions.iter().filter(|transition| transition.event().is_some()).count();
        }
    }

    fn reason(&self) -> String {
        match self.current {
            Some(current) => {
                format!("{} (last reward {:.2})", self.strategies[current].name(), self.last_reward)
            }
            None => "unseen space".into(),
        }
    }

    fn strategies(&self, features: Features) -> Vec<StrategyState> {
        let goals = self.goal_counts.iter().sum::<usize>().max(1) as f64;
        let states = self.strategies.iter().enumerate().map(|(index, strategy)| StrategyState {
            name: strategy.name().to_owned(),
            value: self.chooser.value(index, features),
            share: self.goal_counts[index] as f64 / goals,
            is_current: self.current == Some(index),
        });
        states.collect()
    }

    fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        let mut values = values![
            self.rng,
            self.current,
            self.trajectory,
            self.updates,
            self.features,
            self.goal_counts,
            self.last_reward
        ];
        values.extend(self.unseen.iter_mut().flat_map(|unseen| unseen.values(mapper)));
        values.extend(self.strategies.iter_mut().flat_map(|strategy| strategy.values(mapper)));
        values.extend(self.chooser.values());
        values
    }
}
