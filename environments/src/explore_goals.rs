//! Exploring by goals: the learner chooses where to go, and the controller drives.

use crate::candidates::{Candidate, FEATURES};
use crate::explore_place::ExplorePlace;
use crate::explorer::{Explorer, INFO};
use crate::picture::Picture;
use crate::routes::{self, Route, Routes};
use crate::task::{Actions, Part, Results, Task, TaskError, write_state};
use agent::{Agent, AgentSettings, Policy, Travel};
use controller::{ControlInput, Controller, DiffDrive, Driver, Status};
use interfaces::{
    Purpose, RandomStream, SettingsCheck, SettingsError, Transition, Values, from_bytes, to_bytes,
};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};
use sim::physics::{Fleet, SnapshotError};
use std::sync::{Arc, Mutex, PoisonError};

/// The parts of `state`, with their lengths.
const STATE: [(&str, usize); 7] = [
    ("position", 2),
    ("heading", 2),
    // The share of the episode that is left.
    ("time_left", 1),
    // The known share of the area of the map.
    ("seen", 1),
    // The features by which the paper's agent chooses: p / (p + 50 cells), r / (r + 60 s).
    ("expected_changes", 1),
    ("longest_unseen", 1),
    // The reward of the last step per second: x / (x + 1), from 0 on.
    ("last_reward", 1),
];
const STATE_LEN: usize = 9;

/// Settings of [`ExploreGoals`] beside those of its place.
#[derive(Clone, Debug)]
pub struct GoalSettings {
    /// The strategies that propose a goal each. By default those that draw their goals are there twice: what a goal promises
    /// says which one is better. A policy that chooses among strategies itself (`curious`, `coin`,
    /// `progress`) also looks into unseen space first, as in trials; the others do not.
    pub strategies: Vec<Policy>,
    /// The longest time of a step, s: a goal that takes longer is left for the next one.
    pub max_goal_s: f64,
    /// Whether the robot explores around a goal, or stops there, as its strategy wishes. If not, a step ends on arrival.
    pub stays_at_goals: bool,
    /// Whether the observation has the part `routes`: what the whole way to each goal promises.
    pub shows_routes: bool,
}

impl Default for GoalSettings {
    fn default() -> Self {
        let names = [
            "frontier",
            "recency",
            "recency",
            "poisson",
            "poisson",
            "predicted-change",
            "predicted-change",
            "random",
        ];
        Self {
            strategies: names.into_iter().filter_map(Policy::named).collect(),
            max_goal_s: 45.0,
            stays_at_goals: true,
            shows_routes: false,
        }
    }
}

impl GoalSettings {
    fn check(&self) -> Result<(), TaskError> {
        if self.strategies.is_empty() {
            return Err(TaskError::NoStrategy);
        }
        Ok(SettingsCheck { part: "exploring task" }.within(
            "max_goal_s",
            self.max_goal_s,
            1.0..=1e6,
            "from 1 to 1000000",
        )?)
    }
}

/// [`Explore`](crate::Explore) with goals as actions: at every step each of some strategies proposes a goal, the action is
/// the index of the strategy whose goal is taken, and the controller drives there. The step ends when the goal is finished,
/// or after [`GoalSettings::max_goal_s`].
///
/// The observation has two parts. `candidates`: one row of features per strategy. `state`: position, heading, time left, what
/// is known, and the features of the paper's agent. `local_map` is as in
/// [`Explore`](crate::Explore), if it is shown; `routes`, if they are shown, have one row of features per strategy. The reward is
/// that of [`Explore`](crate::Explore), summed over the step.
///
/// A strategy whose goal is not taken forgets it, and learns nothing from what the robot sees meanwhile. A policy whose
/// index is always chosen therefore does what it does alone.
pub struct ExploreGoals {
    settings: Arc<GoalSettings>,
    explorer: Explorer,
    /// In a mutex, since strategies cannot be shared between threads; it is never locked.
    agents: Mutex<Vec<Agent>>,
    driver: Controller<DiffDrive>,
    candidates: Vec<Candidate>,
    /// The routes to the candidates, if they are shown.
    routes: Vec<Route>,
    last_goal: Option<[f64; 2]>,
    last_reward_per_s: f64,
    /// The points of the last scan, m: a mapper that was restored does not have them until the next reading.
    points: Vec<Point2<f64>>,
}

impl ExploreGoals {
    /// The task in a place. It must be reset before the first step.
    ///
    /// # Errors
    ///
    /// When there is no strategy, or a setting is out of range.
    pub fn new(place: &Arc<ExplorePlace>, settings: &Arc<GoalSettings>) -> Result<Self, TaskError> {
        settings.check()?;
        let explorer = Explorer::new(place)?;
        let agents = Mutex::new(agents(settings, &explorer, 0)?);
        let driver = explorer.one.settings.controller(0)?;
        let candidates = vec![Candidate::default(); settings.strategies.len()];
        let settings = Arc::clone(settings);
        let shown = if settings.shows_routes { candidates.len() } else { 0 };
        let (routes, points) = (vec![Route::default(); shown], Vec::new());
        let (last_goal, last_reward_per_s) = (None, 0.0);
        Ok(Self {
            settings,
            explorer,
            agents,
            driver,
            candidates,
            routes,
            last_goal,
            last_reward_per_s,
            points,
        })
    }

    /// New strategies and a new controller for an episode.
    fn begin(&mut self, seed: u64) {
        // They were made with these settings once before.
        if let (Ok(agents), Ok(driver)) =
            (agents(&self.settings, &self.explorer, seed), self.explorer.one.settings.controller(seed))
        {
            (self.agents, self.driver) = (Mutex::new(agents), driver);
        }
        (self.last_goal, self.last_reward_per_s) = (None, 0.0);
    }

    /// Lets every strategy propose a goal.
    fn propose(&mut self) {
        self.points = self.explorer.robot.mapper.points().to_vec();
        let Self { settings, explorer, agents, driver, candidates, last_goal, routes, .. } = self;
        let mapper = &explorer.robot.mapper;
        let pose = explorer.reading.pose;
        let from = Point2::from(pose.translation.vector);
        let mut times = Vec::new();
        driver.travel_times(&input(mapper, &pose, &[]), &mut times);
        let mut travel = Times(&times);
        let agents = agents.get_mut().unwrap_or_else(PoisonError::into_inner);
        for (agent, candidate) in agents.iter_mut().zip(&mut *candidates) {
            let goal = agent.next_goal(mapper, &pose, &mut travel);
            let travel_s = mapper.frame().index(goal.cell).map_or(f64::INFINITY, |index| times[index]);
            *candidate = Candidate::new(mapper, &goal, &from, travel_s, *last_goal);
        }
        if settings.shows_routes {
            let mut to = Routes::new(mapper, &times, |index| explorer.seen_from(index));
            *routes = candidates.iter().map(|goal| to.to(mapper.frame().cell_at(&goal.position()))).collect();
        }
    }

    /// Drives to the goal of a candidate. Returns the reward.
    fn drive(&mut self, choice: usize) -> f64 {
        let Self { settings, explorer, agents, driver, candidates, points, .. } = self;
        let agents = agents.get_mut().unwrap_or_else(PoisonError::into_inner);
        agents
            .iter_mut()
            .enumerate()
            .filter(|(index, _)| *index != choice)
            .for_each(|(_, agent)| agent.decline());
        let stay = if settings.stays_at_goals { candidates[choice].watch } else { Some(0.0) };
        driver.set_goal(candidates[choice].position(), stay);
        let until_s = explorer.world.time_s() + settings.max_goal_s;
        let mut reward = 0.0;
        // The controller already has the transitions of this reading.
        let now = input(&explorer.robot.mapper, &explorer.reading.pose, &[]);
        let mut command = driver.drive(&ControlInput { points, ..now });
        loop {
            reward += explorer.advance(&command);
            let (mapper, features) = (&explorer.robot.mapper, explorer.features);
            agents.iter_mut().for_each(|agent| agent.watch(features, mapper.transitions()));
            command = driver.drive(&input(mapper, &explorer.reading.pose, mapper.transitions()));
            let is_finished = matches!(driver.status(), Status::Finished(_) | Status::Idle);
            let is_late = explorer.world.time_s() >= until_s - 1e-9;
            if explorer.is_over() || is_finished || is_late || agents[choice].is_goal_obsolete(mapper) {
                return reward;
            }
        }
    }

    /// The values of controller and strategies, for snapshots.
    fn values(&mut self) -> Values<'_> {
        let mapper = &self.explorer.robot.mapper;
        let mut values = self.driver.values(mapper.states());
        let agents = self.agents.get_mut().unwrap_or_else(PoisonError::into_inner);
        values.extend(agents.iter_mut().flat_map(|agent| agent.values(mapper)));
        values
    }
}

/// The agents of an episode: one per strategy.
fn agents(settings: &GoalSettings, explorer: &Explorer, seed: u64) -> Result<Vec<Agent>, SettingsError> {
    let of_robot = &explorer.one.settings.agent;
    let alone = AgentSettings { looks_at_unseen: false, ..of_robot.clone() };
    let agent = |(number, policy): (usize, &Policy)| {
        let rng = || RandomStream::new(seed.wrapping_add(number as u64), Purpose::Agent);
        let chooses = policy.build(of_robot, &mut rng()).0.len() > 1;
        Agent::new(if chooses { of_robot } else { &alone }, policy, rng())
    };
    settings.strategies.iter().enumerate().map(agent).collect()
}

fn input<'a>(
    mapper: &'a Mapper,
    pose: &'a Isometry2<f64>,
    transitions: &'a [Transition],
) -> ControlInput<'a> {
    ControlInput { time: mapper.time(), pose, map: mapper.states(), transitions, points: mapper.points() }
}

/// Travel times that were computed before, once for all strategies.
struct Times<'a>(&'a [f64]);

impl Travel for Times<'_> {
    fn times(&mut self, _: &Mapper, _: &Isometry2<f64>, times: &mut Vec<f64>) {
        times.clear();
        times.extend_from_slice(self.0);
    }
}

impl Task for ExploreGoals {
    fn agents(&self) -> usize {
        1
    }

    fn kind(&self) -> &'static str {
        "goal exploring environment"
    }

    fn actions(&self) -> Actions {
        Actions::Choice(self.candidates.len())
    }

    fn parts(&self) -> Vec<Part> {
        let candidates = Part::new("candidates", vec![self.candidates.len(), FEATURES.len()]);
        let state = Part::new("state", vec![STATE_LEN]);
        let mut parts =
            vec![Part { slices: FEATURES.to_vec(), ..candidates }, Part { slices: STATE.to_vec(), ..state }];
        parts.extend(self.explorer.place.local_map().map(|local| local.part()));
        parts.extend(self.settings.shows_routes.then(|| routes::part(self.candidates.len())));
        parts
    }

    fn info_names(&self) -> &'static [&'static str] {
        INFO
    }

    fn reset(&mut self, seed: u64) {
        self.explorer.reset(seed);
        self.begin(seed);
        let Self { explorer, driver, .. } = self;
        // The controller reads the map at its first tick.
        driver.pause(&input(&explorer.robot.mapper, &explorer.reading.pose, &[]), false);
        self.propose();
    }

    fn step(&mut self, actions: &[f32], results: &mut Results) {
        let Results { rewards, terminated, truncated, .. } = results;
        if self.explorer.is_over() {
            (rewards[0], terminated[0], truncated[0]) = (0.0, false, true);
            return;
        }
        let choice = actions.first().map_or(0, |action| *action as usize).min(self.candidates.len() - 1);
        let begin_s = self.explorer.world.time_s();
        let reward = self.drive(choice);
        let elapsed_s = self.explorer.world.time_s() - begin_s;
        self.last_reward_per_s = if elapsed_s > 0.0 { reward / elapsed_s } else { 0.0 };
        self.last_goal = Some(self.candidates[choice].at);
        self.propose();
        (rewards[0], terminated[0], truncated[0]) = (reward as f32, false, self.explorer.is_over());
    }

    fn observe(&mut self, observations: &mut [f32]) {
        let (candidates, rest) = observations.split_at_mut(self.candidates.len() * FEATURES.len());
        let (state, rest) = rest.split_at_mut(STATE_LEN);
        let (local_map, routes) = rest.split_at_mut(rest.len() - self.routes.as_flattened().len());
        routes.copy_from_slice(self.routes.as_flattened());
        for (row, candidate) in candidates.chunks_mut(FEATURES.len()).zip(&self.candidates) {
            row.copy_from_slice(&candidate.features);
        }
        let Self { explorer, .. } = self;
        let [x, y, cos, sin, ..] = explorer.state();
        let frame = explorer.robot.mapper.frame();
        let area_m2 = frame.len() as f64 * frame.resolution_m().powi(2);
        let share = |value: f64, half: f64| value.max(0.0) / (value.max(0.0) + half);
        let left = 1.0 - f64::from(explorer.episode.steps) / f64::from(explorer.place.settings.max_steps);
        let values = [
            x,
            y,
            cos,
            sin,
            left,
            explorer.seen_m2() / area_m2,
            share(explorer.features.p, 50.0),
            share(explorer.features.r, 60.0),
            share(self.last_reward_per_s, 1.0),
        ];
        write_state(state, values);
        explorer.write_local_map(local_map);
    }

    fn info(&self, info: &mut [f32]) {
        self.explorer.info(info);
    }

    fn fleet(&self) -> &Fleet {
        self.explorer.world.fleet()
    }

    /// The map, and the candidates as green discs; the last goal is darker.
    fn picture(&self, size: usize) -> Picture {
        let mut picture = self.explorer.picture(size);
        self.candidates.iter().for_each(|candidate| picture.disc(&candidate.position(), 0.1, [60, 170, 80]));
        if let Some(last) = self.last_goal {
            picture.disc(&last.into(), 0.1, [20, 90, 40]);
        }
        picture
    }

    fn snapshot(&mut self) -> Vec<u8> {
        let explorer = self.explorer.snapshot();
        let learned = interfaces::snapshot(self.values());
        let last = (self.last_goal, self.last_reward_per_s, &self.points, &self.routes);
        to_bytes(&(explorer, learned, &self.candidates, last))
    }

    fn restore(&mut self, snapshot: &[u8]) -> Result<(), SnapshotError> {
        type Last = (Option<[f64; 2]>, f64, Vec<Point2<f64>>, Vec<Route>);
        type Saved = (Vec<u8>, Vec<u8>, Vec<Candidate>, Last);
        let (explorer, learned, candidates, last): Saved =
            from_bytes(snapshot).map_err(|_| SnapshotError::Damaged)?;
        if candidates.len() != self.candidates.len() || last.3.len() != self.routes.len() {
            return Err(SnapshotError::OtherSpec);
        }
        self.explorer.restore(&explorer)?;
        self.begin(0);
        interfaces::restore(self.values(), &learned).map_err(|_| SnapshotError::Damaged)?;
        self.candidates = candidates;
        (self.last_goal, self.last_reward_per_s, self.points, self.routes) = last;
        Ok(())
    }
}
