//! The learner over goals: which patch of the map to go to, and what to do there. The controller drives, as it does for all
//! strategies.

use crate::cells::draw;
use crate::motives::{Motive, REGION_CELLS, Scale};
use crate::tiles::{Active, FEATURES, Tiles};
use crate::view::View;
use agent::{Features, Stay, Travel};
use controller::{CellDrive, Controller};
use interfaces::{CellState, RandomStream, Step};
use mapper::Mapper;
use nalgebra::Isometry2;
use robot::{Autonomous, Belief, Destination, GoalSelector, Pilot};

/// What the robot can do at a goal: explore around it as in the paper, go on at once, or watch for 10 steps.
const STAYS: [Stay; 3] = [Stay::Explore, Stay::Watch(0.0), Stay::Watch(10.0)];

/// The settings of SARSA over goals.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GoalSettings {
    /// The step size.
    pub(crate) alpha: f64,
    /// The discount per step of the robot.
    pub(crate) gamma: f64,
    /// The probability of a random patch and stay.
    pub(crate) epsilon: f64,
    /// The value of every goal at first, in root mean squares of the reward.
    pub(crate) optimism: f64,
}

impl Default for GoalSettings {
    fn default() -> Self {
        Self { alpha: 0.03, gamma: 0.8, epsilon: 0.02, optimism: 10.0 }
    }
}

/// What a learner takes from world to world.
#[derive(Clone, Debug)]
pub(crate) struct Learned {
    pub(crate) tiles: Tiles,
    pub(crate) scale: Scale,
}

impl Learned {
    /// Nothing.
    pub(crate) fn new(settings: GoalSettings) -> Self {
        Self { tiles: Tiles::new(STAYS.len(), settings.optimism), scale: Scale::default() }
    }
}

/// The present goal.
#[derive(Clone, Copy, Debug)]
struct Taken {
    active: Active,
    /// The discounted rewards since, and the discount now.
    rewards: f64,
    discount: f64,
}

/// SARSA over goals of different durations, with tile coding.
#[derive(Debug)]
pub(crate) struct GoalLearner {
    settings: GoalSettings,
    tiles: Tiles,
    rng: RandomStream,
    taken: Option<Taken>,
    travel: Vec<f64>,
}

/// The sums over the candidates of a patch.
#[derive(Clone, Copy, Debug, Default)]
struct Patch {
    cells: f64,
    reachable: f64,
    travel: f64,
    unknown: f64,
    age: f64,
    changes: f64,
    rate: f64,
    watched: f64,
}

impl Patch {
    /// What the learner sees of a patch, each from 0 to 1: travel time, unknown share, age, expected changes, learned rate,
    /// and how long it was in view.
    fn features(&self) -> [f64; FEATURES] {
        let share = |value: f64, half: f64| value / (value + half);
        [
            share(self.travel / self.reachable, 10.0),
            self.unknown / self.cells,
            share(self.age / self.cells, 100.0),
            share(self.changes, 1.0),
            share(self.rate, 0.1),
            share(self.watched / self.cells, 30.0),
        ]
    }
}

fn patch_of(mapper: &Mapper, cell: usize) -> usize {
    let width = mapper.frame().width();
    cell / width / REGION_CELLS * width.div_ceil(REGION_CELLS) + cell % width / REGION_CELLS
}

impl GoalLearner {
    pub(crate) fn new(settings: GoalSettings, tiles: Tiles, rng: RandomStream) -> Self {
        Self { settings, tiles, rng, taken: None, travel: Vec::new() }
    }

    /// Takes the reward of a reading.
    fn receive(&mut self, reward: f64) {
        if let Some(taken) = &mut self.taken {
            taken.rewards += taken.discount * reward;
            taken.discount *= self.settings.gamma;
        }
    }

    fn patches(&self, mapper: &Mapper) -> Vec<Patch> {
        let frame = mapper.frame();
        let mut patches = vec![Patch::default(); patch_of(mapper, frame.len() - 1) + 1];
        for cell in (0..frame.len()).filter(|&cell| mapper.is_candidate(cell)) {
            let patch = &mut patches[patch_of(mapper, cell)];
            patch.cells += 1.0;
            if self.travel[cell].is_finite() {
                patch.reachable += 1.0;
                patch.travel += self.travel[cell];
            }
            patch.age += mapper.recency(cell);
            if mapper.states().cells()[cell] == CellState::Unknown {
                patch.unknown += 1.0;
                continue;
            }
            patch.changes += mapper.change_probability(cell);
            patch.rate += mapper.acting_rate(cell);
            let seen = mapper.statistics(cell);
            patch.watched += seen.watched_free + seen.watched_blocked;
        }
        patches
    }

    /// The patch and the stay with the largest value, or random ones.
    fn choose(&mut self, patches: &[Patch]) -> Option<(usize, usize, Active)> {
        let open: Vec<usize> = (0..patches.len()).filter(|&patch| patches[patch].reachable > 0.0).collect();
        if open.is_empty() {
            return None;
        }
        let active = |patch: usize, stay: usize| Tiles::active(&patches[patch].features(), stay);
        if self.rng.bernoulli(self.settings.epsilon) {
            let (patch, stay) = (open[draw(&mut self.rng, open.len())], draw(&mut self.rng, STAYS.len()));
            return Some((patch, stay, active(patch, stay)));
        }
        let (mut best, mut largest, mut ties) = (None, f64::NEG_INFINITY, 0);
        for (patch, stay) in
            open.into_iter().flat_map(|patch| (0..STAYS.len()).map(move |stay| (patch, stay)))
        {
            let active = active(patch, stay);
            let value = self.tiles.value(&active);
            if value >= largest {
                ties = if value > largest { 1 } else { ties + 1 };
                if value > largest || draw(&mut self.rng, ties) == 0 {
                    (best, largest) = (Some((patch, stay, active)), value);
                }
            }
        }
        best
    }
}

impl GoalSelector for GoalLearner {
    fn next_goal(
        &mut self,
        pose: &Isometry2<f64>,
        mapper: &Mapper,
        travel: &mut impl Travel,
    ) -> Option<Destination> {
        travel.times(mapper, pose, &mut self.travel);
        let patches = self.patches(mapper);
        let chosen = self.choose(&patches);
        let last = self.taken.take();
        let Some((patch, stay, active)) = chosen else {
            return Some(Destination { position: pose.translation.vector.into(), stay: Stay::Explore });
        };
        if let Some(Taken { active: before, rewards, discount }) = last {
            let target = rewards + discount * self.tiles.value(&active);
            self.tiles.learn(&before, target, self.settings.alpha);
        }
        self.taken = Some(Taken { active, rewards: 0.0, discount: 1.0 });
        let candidates = (0..mapper.frame().len())
            .filter(|&cell| mapper.is_candidate(cell) && patch_of(mapper, cell) == patch);
        let candidates: Vec<usize> = candidates.collect();
        let cell = candidates[draw(&mut self.rng, candidates.len())];
        let position = mapper.frame().center(mapper.frame().cell(cell));
        Some(Destination { position, stay: STAYS[stay] })
    }

    fn reason(&self) -> String {
        "learned value".to_owned()
    }
}

/// A robot that drives to the goals of a [`GoalLearner`].
pub(crate) struct GoalPilot {
    pub(crate) pilot: Autonomous<GoalLearner, Controller<CellDrive>>,
    pub(crate) motive: Box<dyn Motive>,
    pub(crate) scale: Scale,
    /// The range of the sensor, cells.
    pub(crate) reach: i32,
    /// The true log error, for the reference that is paid by it.
    pub(crate) true_error: Option<f64>,
}

impl GoalPilot {
    /// What it has learned.
    pub(crate) fn learned(&mut self) -> Learned {
        Learned { tiles: self.pilot.selector_mut().tiles.clone(), scale: self.scale }
    }
}

impl Pilot for GoalPilot {
    type Command = Step;

    fn command(&mut self, belief: &Belief, features: Features, mapper: &Mapper) -> Step {
        let mut view = View::new(mapper, &belief.pose, self.reach);
        view.true_error = self.true_error;
        let reward = self.scale.scaled(self.motive.reward(&view));
        self.pilot.selector_mut().receive(reward);
        let command = self.pilot.command(belief, features, mapper);
        self.pilot.take_messages(); // they must not accumulate
        command
    }
}
