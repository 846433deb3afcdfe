//! Properties of every agent, in a small environment that changes.

use crate::drawing::{
    agent, can_be_a_goal, current, empty, map, names, next, next_from, reading, rng, weigh_from,
};
use agent::{
    Agent, AgentSettings, BestTrip, Brier, Chooser, Features, GoalSelector, Policy, Random, Recency,
    Situation, Trajectory,
};
use interfaces::{Cell, CellReading, CellState, RandomStream, Transition};
use mapper::Mapper;
use nalgebra::Isometry2;
use std::sync::{Arc, Mutex};

const HOUSE: [&str; 9] = [
    "##############",
    "#......#.....#",
    "#......#.....#",
    "#............#",
    "#......#.....#",
    "####.#########",
    "#............#",
    "#............#",
    "##############",
];

/// What a robot in `cell` observes at `time`: a square of 7 × 7 cells, also through walls. A block moves along the
/// lower wall, one cell in 3 steps.
fn look(time: f64, cell: Cell) -> CellReading {
    let block = Cell::new(1 + (time / 3.0) as i32 % 12, 1);
    let mut seen = reading(time, &HOUSE);
    seen.pose = interfaces::pose(f64::from(cell.x) + 0.5, f64::from(cell.y) + 0.5, 0.0);
    seen.cells.retain(|(other, _)| (other.x - cell.x).abs() <= 3 && (other.y - cell.y).abs() <= 3);
    for (other, is_blocked) in &mut seen.cells {
        *is_blocked |= *other == block;
    }
    seen
}

/// Runs a robot that flies one cell per step for 1500 steps. A goal lasts until it is reached, and 5 more steps.
/// Returns all goals, and calls `check` after each.
fn live(agent: &mut Agent, mut check: impl FnMut(&Agent, &Mapper, Cell)) -> Vec<Cell> {
    let mut mapper = empty(14, 9);
    let (mut cell, mut goal, mut left) = (Cell::new(3, 6), None, 0);
    let mut goals = Vec::new();
    for step in 0..1500 {
        let seen = look(f64::from(step), cell);
        mapper.update(&seen).unwrap();
        let features = Features::of(&mut mapper);
        agent.observe(features, mapper.transitions());
        let target = *goal.get_or_insert_with(|| {
            let goal = next_from(&seen.pose, agent, &mapper);
            check(agent, &mapper, goal);
            goals.push(goal);
            left = 5;
            goal
        });
        cell = Cell::new(cell.x + (target.x - cell.x).signum(), cell.y + (target.y - cell.y).signum());
        if cell == target {
            left -= 1;
            goal = goal.filter(|_| left > 0);
        }
    }
    goals
}

#[test]
fn the_same_seed_gives_the_same_life_and_another_seed_another() {
    for choice in names() {
        let life = |seed| live(&mut agent(choice, seed), |_, _, _| ());
        assert_eq!(life(1), life(1), "{choice}");
        // The strategies that go to the best cell use few random numbers.
        let is_best = choice == "information-gain";
        assert!(is_best || life(1) != life(2), "{choice}");
    }
}

#[test]
fn goals_can_be_goals_shares_are_theirs_and_only_learners_have_values_which_are_finite() {
    for choice in names() {
        let is_learner = choice == "curious";
        let mut agent = agent(choice, 3);
        assert_eq!(current(&agent), None);
        let shares =
            |agent: &Agent| agent.strategies(Features::default()).into_iter().map(|state| state.share);
        assert!(shares(&agent).all(|share| share == 0.0));
        let (mut counts, mut learned) = (vec![0.0; shares(&agent).len()], false);
        live(&mut agent, |agent, mapper, goal| {
            assert!(can_be_a_goal(mapper, goal), "{choice}: {goal:?}");
            counts[current(agent).expect("a goal has a strategy")] += 1.0;
            let goals: f64 = counts.iter().sum();
            assert!(shares(agent).zip(&counts).all(|(share, count)| share == count / goals));
            assert!((0.0..=49.0).contains(&agent.last_reward()), "at most all cells in view change");
            for p in [0.0, 1.0, f64::MAX, f64::INFINITY, f64::NAN] {
                for r in [0.0, 50.0, f64::MAX, f64::INFINITY, f64::NAN] {
                    for value in agent.strategies(Features { p, r }).into_iter().map(|state| state.value) {
                        assert_eq!(value.is_some(), is_learner);
                        assert!(value.is_none_or(f64::is_finite));
                        learned |= value.is_some_and(|value| value > 0.0);
                    }
                }
            }
        });
        assert_eq!(learned, is_learner);
    }
}

#[test]
fn the_strategies_of_each_choice() {
    for choice in ["curious", "coin"] {
        let strategies = agent(choice, 0).strategies(Features::default());
        assert_eq!([&*strategies[0].name, &*strategies[1].name], ["recency", "poisson"]);
        assert_eq!(strategies.len(), 2);
    }
}

#[test]
fn the_first_choice_and_the_coin_are_fair() {
    let mapper = map(&[(0.0, &["..."])]);
    for choice in ["curious", "coin"] {
        let firsts = (0..1000).filter(|&seed| {
            let mut agent = agent(choice, seed);
            next(&mut agent, &mapper);
            current(&agent) == Some(0)
        });
        // Four standard deviations.
        assert!((436..=564).contains(&firsts.count()), "{choice}");
    }
    let mut agent = agent("coin", 1);
    for _ in 0..1000 {
        next(&mut agent, &mapper);
    }
    let strategies = agent.strategies(Features::default());
    assert!(strategies.iter().all(|strategy| (0.436..=0.564).contains(&strategy.share)));
}

/// What a chooser received: strategy, features, reward.
type Lessons = Arc<Mutex<Vec<(usize, Vec<Features>, f64)>>>;

/// Chooses the strategies in turn, and records what it receives.
#[derive(Debug, Default)]
struct Pupil {
    chosen: usize,
    lessons: Lessons,
}

impl Chooser for Pupil {
    fn choose(&mut self, _: &Situation, _: &mut RandomStream) -> usize {
        self.chosen += 1;
        (self.chosen - 1) % 2
    }

    fn learn(&mut self, trajectory: &Trajectory) {
        let lesson = (trajectory.strategy, trajectory.features.to_vec(), trajectory.reward);
        self.lessons.lock().unwrap().push(lesson);
    }
}

/// An agent with two strategies.
fn taught(settings: &AgentSettings, chooser: impl Chooser + 'static) -> Agent {
    Agent::with(settings, vec![Box::new(Recency), Box::new(Random)], Box::new(chooser), rng(0)).unwrap()
}

#[test]
fn a_trajectory_is_rewarded_by_its_updates_per_reading() {
    use CellState::{Blocked, Free, Unknown};
    let turn = |before, after| Transition { cell: Cell::new(0, 0), before, after };
    let (found, block, free) = (turn(Unknown, Free), turn(Free, Blocked), turn(Blocked, Free));
    let at = |p| Features { p, r: 10.0 * p };
    let mapper = map(&[(0.0, &["..."])]);
    let pupil = Pupil::default();
    let lessons = Lessons::clone(&pupil.lessons);
    let mut agent = taught(&AgentSettings::default(), pupil);
    agent.observe(at(9.0), &[found; 50]); // Before the first goal: the reward belongs to no strategy.
    next(&mut agent, &mapper);
    agent.observe(at(1.0), &[block, found]);
    agent.observe(at(2.0), &[]);
    agent.observe(at(3.0), &[free, found]);
    agent.observe(at(4.0), &[]);
    next(&mut agent, &mapper);
    assert_eq!(agent.last_reward(), 0.5);
    next(&mut agent, &mapper); // No reading since then: nothing to learn.
    agent.observe(at(5.0), &[block, free]);
    next(&mut agent, &mapper);
    assert_eq!(agent.last_reward(), 2.0);
    let expected = [(0, [1.0, 2.0, 3.0, 4.0].map(at).to_vec(), 0.5), (0, vec![at(5.0)], 2.0)];
    assert_eq!(*lessons.lock().unwrap(), expected);
}

#[test]
fn what_follows_the_end_of_a_goal_belongs_to_no_strategy() {
    let block = Transition { cell: Cell::new(0, 0), before: CellState::Free, after: CellState::Blocked };
    let mapper = map(&[(0.0, &["..."])]);
    let pupil = Pupil::default();
    let lessons = Lessons::clone(&pupil.lessons);
    let mut agent = taught(&AgentSettings::default(), pupil);
    next(&mut agent, &mapper);
    agent.observe(Features::default(), &[block]);
    for _ in 0..2 {
        agent.end_goal(&Isometry2::identity(), &mapper);
        agent.observe(Features::default(), &[block; 9]);
    }
    assert_eq!(current(&agent), None);
    let [first, second] = &agent.strategies(Features::default())[..] else { panic!("two strategies") };
    assert_eq!([first.share, second.share], [1.0, 0.0]);
    next(&mut agent, &mapper);
    assert_eq!(*lessons.lock().unwrap(), [(0, vec![Features::default()], 1.0)]);
}

/// What should have been in view counts as seen when the robot leaves its goal, not when it selects the next one.
#[test]
fn a_visit_ends_with_its_goal() {
    let settings = AgentSettings::default();
    // The robot at the cell `x` leaves the goal.
    let worth = |goal: i32, leaves_at: f64| {
        let mut strategy = BestTrip::new(Brier, &settings);
        let mut mapper = map(&[(0.0, &["....."])]);
        let pose = Isometry2::translation(leaves_at, 0.0);
        weigh_from(&pose, &mut strategy, &mapper, &[1.0; 5]);
        agent::Strategy::stay(&mut strategy, Cell::new(goal, 0));
        mapper.update(&reading(10.0, &["....."])).unwrap();
        mapper.update(&reading(20.0, &[".    "])).unwrap();
        agent::Strategy::end(&mut strategy, &Situation::new(&mapper, &pose, Features::default()));
        mapper.update(&reading(25.0, &[".    "])).unwrap();
        weigh_from(&pose, &mut strategy, &mapper, &[1.0; 5])[2]
    };
    // On the way, the robot was called away: nothing of the view from its goal was seen.
    let away = worth(4, 0.0);
    assert!(away > 0.0);
    for goal in [0, 4] {
        let ended = worth(goal, f64::from(goal));
        assert!(ended > 0.0 && ended < away, "{ended} {away}");
    }
}

#[test]
fn an_agent_without_sense_is_refused() {
    let settings = AgentSettings { patch_cells: 0, ..Default::default() };
    let refused = Agent::new(&settings, &Policy::default(), rng(0)).unwrap_err();
    assert_eq!(refused.to_string(), "agent setting `patch_cells` must be from 1 to 1000, not 0");
    let nothing = Agent::with(&AgentSettings::default(), vec![], Box::new(Pupil::default()), rng(0));
    assert_eq!(nothing.unwrap_err().to_string(), "agent setting `strategies` must be at least one, not none");
}

/// Chooses a strategy that does not exist.
#[derive(Debug)]
struct Beyond;

impl Chooser for Beyond {
    fn choose(&mut self, _: &Situation, _: &mut RandomStream) -> usize {
        7
    }
}

#[test]
fn an_index_beyond_the_strategies_is_the_last_strategy() {
    let mut agent = taught(&AgentSettings::default(), Beyond);
    next(&mut agent, &map(&[(0.0, &["..."])]));
    assert_eq!(current(&agent), Some(1));
}

#[test]
fn a_policy_of_one_strategy_has_its_name() {
    for policy in Policy::built_in() {
        let strategies = agent(policy.name(), 0).strategies(Features::default());
        assert!(strategies.len() > 1 || strategies[0].name == policy.name());
    }
}

#[test]
fn the_page_of_strategies_lists_every_policy() {
    let page = include_str!("../../../docs/strategies.md");
    for policy in Policy::built_in() {
        let row = format!("| `{policy}` | {} |", policy.description());
        assert!(page.contains(&row), "docs/strategies.md needs the row {row}");
    }
}
