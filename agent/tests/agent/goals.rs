//! Which goals follow from which weights.

use crate::drawing::{agent, can_be_a_goal, empty, map, names, next, next_from, reading, rng, weigh};
use agent::{
    Agent, AgentSettings, Always, Features, GoalSelector, Poisson, Random, Recency, Situation, Strategy,
};
use interfaces::{Cell, CellReading};
use mapper::Mapper;
use proptest::prelude::*;
use proptest::strategy::Strategy as _;

/// A strategy with constant weights.
#[derive(Clone, Debug)]
struct Given(Vec<f64>);

impl Strategy for Given {
    fn name(&self) -> &'static str {
        "given"
    }

    fn weigh(&mut self, _: &Situation, weights: &mut [f64]) {
        weights.copy_from_slice(&self.0);
    }
}

fn agent_of(strategy: impl Strategy + 'static, patch_cells: usize, seed: u64) -> Agent {
    let settings = AgentSettings { patch_cells, ..Default::default() };
    Agent::with(&settings, vec![Box::new(strategy)], Box::new(Always(0)), rng(seed)).unwrap()
}

/// The probability of each cell by the definition: patches in proportion to the mean weight of their goals, uniform
/// within a patch; uniform over all goals if there are no weights.
fn probabilities(mapper: &Mapper, weights: &[f64], patch_cells: i32) -> Vec<f64> {
    let frame = mapper.frame();
    let goals: Vec<Cell> =
        (0..frame.len()).map(|i| frame.cell(i)).filter(|&cell| can_be_a_goal(mapper, cell)).collect();
    let patch = |cell: Cell| (cell.x.div_euclid(patch_cells), cell.y.div_euclid(patch_cells));
    let weight = |cell: Cell| weights[frame.index(cell).unwrap()];
    let mates = |cell: Cell| goals.iter().copied().filter(move |&other| patch(other) == patch(cell));
    let share = |cell: Cell| {
        let count = mates(cell).count() as f64;
        mates(cell).map(weight).sum::<f64>() / count / count
    };
    let total: f64 = goals.iter().map(|&cell| share(cell)).sum();
    let mut probabilities = vec![0.0; frame.len()];
    for &cell in &goals {
        let probability = if total > 0.0 { share(cell) / total } else { 1.0 / goals.len() as f64 };
        probabilities[frame.index(cell).unwrap()] = probability;
    }
    probabilities
}

/// Samples goals, and compares how often each cell was selected with how often it should be.
#[track_caller]
fn assert_frequencies(agent: &mut Agent, mapper: &Mapper, probabilities: &[f64]) {
    let draws = 40_000;
    let mut counts = vec![0.0; probabilities.len()];
    for _ in 0..draws {
        let goal = next(agent, mapper);
        counts[mapper.frame().index(goal).expect("a goal in the grid")] += 1.0;
    }
    let (mut chi_square, mut freedom) = (0.0, -1.0);
    for (count, probability) in counts.iter().zip(probabilities) {
        let expected = f64::from(draws) * probability;
        if expected == 0.0 {
            assert_eq!(*count, 0.0, "a goal where there must be none");
        } else {
            chi_square += (count - expected).powi(2) / expected;
            freedom += 1.0;
        }
    }
    // Mean and standard deviation of a chi-square distribution; four of them are 1 in 10,000.
    let limit = freedom + 4.0 * (2.0f64 * freedom).sqrt();
    assert!(chi_square < limit, "chi-square {chi_square:.1} with {freedom} degrees of freedom");
}

const ROOM: &[&str] = &[
    "###########  ", //
    "#....#....#  ",
    "#....#....   ",
    "#.........#  ",
    "#....#....###",
    "#....#....###",
    "#############",
];

#[test]
fn a_goal_comes_as_often_as_its_patch_weighs() {
    let mapper = map(&[(0.0, ROOM)]);
    let weights: Vec<f64> = (0..mapper.frame().len()).map(|index| (index % 7) as f64).collect();
    for patch_cells in [1, 3, 5, 100] {
        let expected = probabilities(&mapper, &weights, patch_cells);
        let mut agent = agent_of(Given(weights.clone()), patch_cells as usize, 1);
        assert_frequencies(&mut agent, &mapper, &expected);
    }
}

#[test]
fn recency_and_poisson_are_sampled_by_their_weights() {
    let mut blocked = ROOM.to_vec();
    blocked[4] = "#....#..#.###";
    let west = ["#....", "#....", "#....", "#...."];
    let mapper = map(&[(0.0, ROOM), (1.0, &blocked), (2.0, ROOM), (30.0, ROOM), (90.0, &west)]);
    let recency = weigh(&mut Recency, &mapper, &[]);
    let poisson = weigh(&mut Poisson, &mapper, &[]);
    assert!(poisson.iter().any(|&weight| weight > 0.0));
    for (choice, weights) in [("recency", recency), ("poisson", poisson)] {
        let expected = probabilities(&mapper, &weights, 5);
        assert_frequencies(&mut agent(choice, 2), &mapper, &expected);
    }
}

#[test]
fn without_any_weight_every_candidate_is_as_likely() {
    let mapper = map(&[(0.0, ROOM)]);
    let uniform = probabilities(&mapper, &vec![0.0; mapper.frame().len()], 5);
    // Nothing ever changed, and everything was seen just now: only information gain still expects a gain.
    for choice in names().filter(|&name| name != "information-gain") {
        assert_frequencies(&mut agent(choice, 3), &mapper, &uniform);
    }
}

#[test]
fn random_is_uniform_whatever_was_seen() {
    let mapper = map(&[(0.0, ROOM), (50.0, &["#....", "#....", "#...."])]);
    let none = vec![0.0; mapper.frame().len()];
    assert_eq!(weigh(&mut Random, &mapper, &[]), none);
    let uniform = probabilities(&mapper, &none, 5);
    assert_frequencies(&mut agent("random", 4), &mapper, &uniform);
}

#[test]
fn recency_weighs_by_the_time_since_a_cell_was_seen() {
    let mapper = map(&[
        (3.0, &[".... ", "###  "]), //
        (10.0, &["..   ", "#    "]),
    ]);
    // A cell never seen counts as last seen at 0.
    let expected = [0.0, 7.0, 7.0, 10.0, 10.0, 0.0, 0.0, 7.0, 7.0, 10.0];
    assert_eq!(weigh(&mut Recency, &mapper, &[]), expected, "from the lowest row on");
}

#[test]
fn poisson_weighs_by_the_probability_of_a_change() {
    // The middle cell is watched for 8 s: free until 2 s, blocked until 6 s, and free again.
    let mapper = map(&[
        (0.0, &["..."]), //
        (2.0, &[".#."]),
        (6.0, &["..."]),
        (8.0, &["..."]),
        (11.0, &[".  "]),
    ]);
    // Last seen 3 s ago, of a cycle of about 8 s: free for 2 + 2 s, blocked for 4 s.
    let interval = mapper.interval(1);
    assert!((4.0..16.0).contains(&interval), "{interval}");
    let expected = 1.0 - f64::exp(-3.0 / interval);
    let [left, middle, right] = weigh(&mut Poisson, &mapper, &[])[..] else { panic!("three cells") };
    assert_eq!((left, right), (0.0, 0.0));
    assert!((middle - expected).abs() < 1e-12, "{middle} is not {expected}");
}

#[test]
fn without_a_candidate_the_goal_is_where_the_robot_is() {
    let inside_a_wall = map(&[(0.0, &["###", "###"])]);
    for mapper in [empty(3, 2), inside_a_wall] {
        for (x, y, cell) in [(1.5, 0.5, Cell::new(1, 0)), (-7.5, 99.5, Cell::new(-8, 99))] {
            for choice in names() {
                let pose = interfaces::pose(x, y, 0.0);
                assert_eq!(next_from(&pose, &mut agent(choice, 5), &mapper), cell);
            }
        }
    }
}

#[test]
fn weights_that_are_no_numbers_count_as_zero() {
    let mapper = map(&[(0.0, &["......"])]);
    let weights = vec![f64::NAN, -1.0, f64::NEG_INFINITY, 0.0, 1e-3, -0.0];
    let mut agent = agent_of(Given(weights), 1, 6);
    for _ in 0..100 {
        assert_eq!(next(&mut agent, &mapper), Cell::new(4, 0));
    }
}

#[test]
fn the_largest_weights_do_not_overflow() {
    let mapper = map(&[(0.0, &["......"])]);
    let weights = vec![f64::INFINITY, f64::MAX, 0.0, f64::MAX, f64::INFINITY, 1.0];
    let expected = [0.25, 0.25, 0.0, 0.25, 0.25, 0.0];
    assert_frequencies(&mut agent_of(Given(weights), 1, 7), &mapper, &expected);
}

fn any_weight() -> impl proptest::strategy::Strategy<Value = f64> {
    prop_oneof![6 => Just(0.0), 3 => 1e-3..1e3, 1 => -1e3..0.0, 1 => Just(f64::NAN), 1 => Just(f64::INFINITY)]
}

proptest! {
    #[test]
    fn a_goal_is_always_a_candidate_of_a_patch_that_weighs(
        (width, height, cells, weights) in (1usize..14, 1usize..14).prop_flat_map(|(width, height)| {
            let cells = prop::collection::vec(0..3, width * height);
            let weights = prop::collection::vec(any_weight(), width * height);
            (Just(width), Just(height), cells, weights)
        }),
        patch_cells in 1usize..8,
        seed in any::<u64>(),
    ) {
        let mut mapper = empty(width, height);
        let seen = (0..cells.len()).filter(|&index| cells[index] > 0);
        let cells = seen.map(|index| (mapper.frame().cell(index), cells[index] == 2)).collect();
        let pose = interfaces::pose(-5.0, 0.0, 0.0);
        mapper.update(&CellReading { time: 1.0, pose, cells }).unwrap();

        let frame = *mapper.frame();
        let patch = |cell: Cell| (cell.x / patch_cells as i32, cell.y / patch_cells as i32);
        let goals: Vec<Cell> =
            (0..frame.len()).map(|i| frame.cell(i)).filter(|&cell| can_be_a_goal(&mapper, cell)).collect();
        let weighs = |cell: Cell| weights[frame.index(cell).unwrap()] > 0.0;
        let weighty: Vec<_> = goals.iter().filter(|&&cell| weighs(cell)).map(|&cell| patch(cell)).collect();

        let mut agent = agent_of(Given(weights.clone()), patch_cells, seed);
        for _ in 0..10 {
            let goal = next_from(&pose, &mut agent, &mapper);
            if goals.is_empty() {
                prop_assert_eq!(goal, Cell::new(-5, 0));
            } else {
                prop_assert!(goals.contains(&goal));
                prop_assert!(weighty.is_empty() || weighty.contains(&patch(goal)));
            }
        }
    }
}

#[test]
fn readings_at_one_instant_leave_only_numbers() {
    // Changes without any time between them: arbitrary rates, and no observation for long.
    let mut mapper = map(&[(0.0, &["..."]), (0.0, &[".#."]), (0.0, &["..."]), (0.0, &[".#."])]);
    mapper.update(&reading(1e300, &[".  "])).unwrap();
    for choice in names() {
        let mut agent = agent(choice, 8);
        for _ in 0..20 {
            let features = Features::of(&mut mapper);
            agent.observe(features, mapper.transitions());
            assert!(can_be_a_goal(&mapper, next(&mut agent, &mapper)));
            assert!(agent.last_reward().is_finite());
            let strategies = agent.strategies(features);
            assert!(strategies.iter().all(|strategy| strategy.value.is_none_or(f64::is_finite)));
        }
    }
}
