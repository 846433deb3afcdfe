//! Looks into space that was never seen.

use crate::drawing::{current, map, reading, rng};
use agent::{Agent, AgentSettings, Goal, GoalSelector, Policy, Stay, Travel};
use interfaces::{Cell, CellState};
use mapper::Mapper;
use nalgebra::Isometry2;

/// A space behind the wall on the right, seen through a gap. A blank was never seen.
const GAP: [&str; 5] = ["########", "#...#   ", "#...#   ", "#.....  ", "########"];

/// The robot can reach the free cells left of the column `gap`, in the time of a straight line.
struct UpTo {
    gap: i32,
}

impl Travel for UpTo {
    fn times(&mut self, mapper: &Mapper, _: &Isometry2<f64>, times: &mut Vec<f64>) {
        let frame = mapper.frame();
        let time = |index| {
            let cell = frame.cell(index);
            let is_reached = cell.x < self.gap && mapper.states().get(cell) == Some(&CellState::Free);
            if is_reached { f64::from(cell.x + cell.y) } else { f64::INFINITY }
        };
        times.clear();
        times.extend((0..frame.len()).map(time));
    }
}

fn agent(unseen_first: bool) -> Agent {
    let settings = AgentSettings { unseen_first, sensor_radius_m: 10.0, ..Default::default() };
    let policy: Policy = "recency".parse().unwrap();
    Agent::new(&settings, &policy, rng(1)).unwrap()
}

/// The goal, and whether it is a look.
fn next(agent: &mut Agent, mapper: &Mapper) -> (Goal, bool) {
    let goal = agent.next_goal(&Isometry2::identity(), mapper, &mut UpTo { gap: 4 }).unwrap();
    (goal, current(agent).is_none())
}

#[test]
fn unseen_space_is_looked_at_first_from_where_it_can_be_seen() {
    let mapper = map(&[(0.0, &GAP)]);
    let (goal, is_look) = next(&mut agent(true), &mapper);
    assert!(is_look && matches!(goal.stay, Stay::Watch(_)));
    // The frontier is in the rows of the gap and above it, so that the view is from the row of the gap or below.
    let cell = mapper.frame().cell_at(&goal.position);
    assert!(mapper.states().get(cell) == Some(&CellState::Free) && cell.x < 4, "{goal:?}");
    assert!(!next(&mut agent(false), &mapper).1, "the paper's robot follows its strategy");
}

#[test]
fn a_look_that_shows_nothing_is_repeated_after_a_time_that_doubles() {
    let (mut mapper, mut agent) = (map(&[(0.0, &GAP)]), agent(true));
    let mut looks = Vec::new();
    for time in 1..=300 {
        mapper.update(&reading(f64::from(time), &GAP)).unwrap();
        if next(&mut agent, &mapper).1 {
            looks.push(time);
        }
    }
    // A look ends when the next goal is selected, one second later here.
    assert_eq!(looks, [1, 32, 93, 214]);
}

#[test]
fn a_look_that_shows_more_is_followed_by_the_next_at_once_and_ends_early() {
    let (mut mapper, mut agent) = (map(&[(0.0, &GAP)]), agent(true));
    assert!(next(&mut agent, &mapper).1 && !agent.is_obsolete(&mapper));
    let more = ["########", "#...#.  ", "#...#.. ", "#.......", "########"];
    mapper.update(&reading(1.0, &more)).unwrap();
    assert!(next(&mut agent, &mapper).1);
    let all = ["########", "#...#...", "#...#...", "#.......", "########"];
    for time in 2..4 {
        mapper.update(&reading(f64::from(time), &all)).unwrap();
    }
    assert!(agent.is_obsolete(&mapper));
    assert!(!next(&mut agent, &mapper).1, "nothing is unseen");
    assert!(!agent.is_obsolete(&mapper), "the goal of a strategy stays");
}

#[test]
fn what_no_reachable_cell_sees_is_no_goal() {
    let closed = ["########", "#...#   ", "#...#.  ", "#...#.  ", "########"];
    let mapper = map(&[(0.0, &closed)]);
    assert!(mapper.is_candidate(mapper.frame().index(Cell::new(6, 1)).unwrap()));
    assert!(!next(&mut agent(true), &mapper).1);
}
