//! Maps drawn by hand: `#` blocked, `.` free, a blank not seen; the top line has the highest y.

use agent::{Agent, AgentSettings, Features, GoalSelector, Policy, Situation, Strategy, Travel};
use interfaces::{Cell, CellReading, CellState, GridFrame, Purpose, RandomStream};
use mapper::{Mapper, MapperSettings};
use nalgebra::{Isometry2, Point2};

/// A robot that flies along straight lines, at one meter per unit of time.
struct Flight;

impl Travel for Flight {
    fn times(&mut self, mapper: &Mapper, pose: &Isometry2<f64>, times: &mut Vec<f64>) {
        let (frame, from) = (mapper.frame(), pose.translation.vector.into());
        times.clear();
        times.extend((0..frame.len()).map(|cell| nalgebra::distance(&frame.center(frame.cell(cell)), &from)));
    }
}

/// What a sensor observes at `time`.
pub(crate) fn reading(time: f64, drawing: &[&str]) -> CellReading {
    let row = |(y, line): (usize, &&str)| {
        let cell = |(x, letter)| match letter {
            '#' | '.' => Some((Cell::new(x as i32, y as i32), letter == '#')),
            _ => None,
        };
        line.chars().enumerate().filter_map(cell).collect::<Vec<_>>()
    };
    let cells = drawing.iter().rev().enumerate().flat_map(row).collect();
    CellReading { time, pose: Isometry2::identity(), cells }
}

/// An empty map of `width` × `height` cells of 1 m.
pub(crate) fn empty(width: usize, height: usize) -> Mapper {
    let frame = GridFrame::new(Point2::origin(), 1.0, width, height).unwrap();
    Mapper::new(&MapperSettings::default(), frame).unwrap()
}

/// The map after the drawings were observed one after the other, each at its time.
pub(crate) fn map(sightings: &[(f64, &[&str])]) -> Mapper {
    let drawing = sightings[0].1;
    let mut mapper = empty(drawing[0].len(), drawing.len());
    for &(time, drawing) in sightings {
        mapper.update(&reading(time, drawing)).unwrap();
    }
    mapper
}

/// The weights for a robot at the origin with these travel times to the cells.
pub(crate) fn weigh(strategy: &mut (impl Strategy + ?Sized), mapper: &Mapper, travel: &[f64]) -> Vec<f64> {
    weigh_from(&Isometry2::identity(), strategy, mapper, travel)
}

/// The weights for a robot at a pose.
pub(crate) fn weigh_from(
    pose: &Isometry2<f64>,
    strategy: &mut (impl Strategy + ?Sized),
    mapper: &Mapper,
    travel: &[f64],
) -> Vec<f64> {
    let mut weights = vec![0.0; mapper.frame().len()];
    let situation = Situation::new(mapper, pose, Default::default()).with_travel(travel);
    strategy.weigh(&situation, &mut weights);
    weights
}

/// The next goal of a robot that flies.
pub(crate) fn next(agent: &mut Agent, mapper: &Mapper) -> Cell {
    next_from(&Isometry2::identity(), agent, mapper)
}

/// The next goal of a robot that flies, at a pose.
pub(crate) fn next_from(pose: &Isometry2<f64>, agent: &mut Agent, mapper: &Mapper) -> Cell {
    let goal = agent.next_goal(pose, mapper, &mut Flight).unwrap();
    mapper.frame().cell_at(&goal.position)
}

/// The index of the strategy that selected the present goal.
pub(crate) fn current(agent: &Agent) -> Option<usize> {
    agent.strategies(Features::default()).iter().position(|strategy| strategy.is_current)
}

/// Whether a cell can be a goal: a free cell of the map, or a cell that shares a side with a free cell.
pub(crate) fn can_be_a_goal(mapper: &Mapper, cell: Cell) -> bool {
    let is_free = |cell| mapper.states().get(cell) == Some(&CellState::Free);
    mapper.frame().contains(cell) && (is_free(cell) || cell.neighbours4().into_iter().any(is_free))
}

pub(crate) fn rng(seed: u64) -> RandomStream {
    RandomStream::new(seed, Purpose::Agent)
}

/// The names of the built-in policies.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    Policy::built_in().iter().map(Policy::name)
}

/// An agent of a built-in policy.
pub(crate) fn agent(policy: &str, seed: u64) -> Agent {
    Agent::new(&AgentSettings::default(), &policy.parse().unwrap(), rng(seed)).unwrap()
}

/// The settings for a sensor with this range.
pub(crate) fn seeing(sensor_radius_m: f64) -> AgentSettings {
    AgentSettings { sensor_radius_m, ..Default::default() }
}
