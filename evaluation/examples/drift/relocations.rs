//! Unknown starts in a known map.

use crate::options::Options;
use crate::score::{error, quantile};
use interfaces::{
    Cell, CellState, Grid, GroundTruth, Purpose, RandomStream, SettingsError, TrueState, Twist, World,
};
use localizer::{ChangingMap, Localizer, LocalizerSettings, PoseState, Start};
use nalgebra::Isometry2;
use sim::physics::{Motion, PhysicsWorld, WorldSpec};
use std::time::Instant;

const TRIALS: u64 = 60;
/// The number of scans at rest until the answer.
const SCANS: usize = 8;

/// Starts at random places of the true map at the start, and prints the results.
pub(crate) fn run(
    options: &Options,
    settings: &LocalizerSettings,
    spec: &WorldSpec,
    seed: u64,
) -> Result<(), SettingsError> {
    let map = &KnownMap::new(spec, seed);
    let spec = &if options.moved { rearranged(spec, seed) } else { spec.clone() };
    let (mut right, mut wrong, mut open, mut elapsed_ms) = (0, 0, 0, Vec::new());
    for trial in 0..TRIALS {
        let Some((mut world, pose)) =
            somewhere(spec, &true_map(&PhysicsWorld::new(spec, seed)), seed + trial)
        else {
            continue;
        };
        let mut localizer = Localizer::in_map(settings, &map.states, Start::Unknown)?;
        for _ in 0..(trial % 10) * 30 {
            world.act(&Twist::STOP); // people walk and doors move
        }
        let mut slowest_ms: f64 = 0.0;
        let mut estimate = None;
        for _ in 0..SCANS {
            let begin = Instant::now();
            estimate = Some(localizer.localize(&world.sense(), map).estimate);
            slowest_ms = slowest_ms.max(begin.elapsed().as_secs_f64() * 1e3);
            world.act(&Twist::STOP);
        }
        elapsed_ms.push(slowest_ms);
        let Some(estimate) = estimate else { continue };
        let (error_m, error_rad) = error(&estimate.pose, &pose);
        match estimate.state {
            PoseState::Tracking if error_m < 0.1 && error_rad < 0.05 => right += 1,
            PoseState::Tracking => wrong += 1,
            _ => open += 1,
        }
    }
    println!(
        "unknown start: {right} right, {wrong} wrong, {open} not certain; {:.1} ms in the median, {:.1} ms at most",
        quantile(&elapsed_ms, 0.5),
        quantile(&elapsed_ms, 1.0),
    );
    Ok(())
}

/// The true map at the start. What is no wall changed in the past: furniture is moved about once in this time, s.
struct KnownMap {
    states: Grid<CellState>,
    is_wall: Vec<bool>,
}

const MOVED_EVERY_S: f64 = 1000.0;

impl KnownMap {
    fn new(spec: &WorldSpec, seed: u64) -> Self {
        let mut walls = spec.fleet().clone();
        walls.obstacles.clear();
        let walls = WorldSpec::driving(walls, spec.driven_index()).map(|spec| PhysicsWorld::new(&spec, seed));
        let states = true_map(&PhysicsWorld::new(spec, seed));
        let is_wall =
            |index| walls.as_ref().is_some_and(|walls| walls.truth().state(index) != TrueState::Free);
        let is_wall = (0..states.cells().len()).map(is_wall).collect();
        Self { states, is_wall }
    }
}

impl ChangingMap for KnownMap {
    fn states(&self) -> &Grid<CellState> {
        &self.states
    }

    fn rate(&self, index: usize) -> f64 {
        let was_furniture = self.states.cells()[index] == CellState::Blocked && !self.is_wall[index];
        if was_furniture { 1.0 / MOVED_EVERY_S } else { 0.0 }
    }
}

/// The house after every third piece of furniture was moved by up to a meter and turned.
fn rearranged(spec: &WorldSpec, seed: u64) -> WorldSpec {
    let mut random = RandomStream::new(seed, Purpose::HouseGenerator);
    let mut fleet = spec.fleet().clone();
    let furniture = fleet.obstacles.iter_mut().filter(|obstacle| obstacle.motion == Motion::Fixed);
    for obstacle in furniture.step_by(3) {
        let by = interfaces::pose(random.uniform(-1.0..1.0), random.uniform(-1.0..1.0), 0.0);
        let turn = interfaces::pose(0.0, 0.0, random.uniform(-0.5..0.5));
        obstacle.shape.pose = by * obstacle.shape.pose * turn;
    }
    WorldSpec::driving(fleet, spec.driven_index()).unwrap_or_else(|| spec.clone())
}

/// The map of all that stands at the start.
fn true_map(world: &PhysicsWorld) -> Grid<CellState> {
    let truth = world.truth();
    let mut map = Grid::filled(*truth.frame(), CellState::Free);
    for index in (0..truth.frame().len()).filter(|index| truth.state(*index) != TrueState::Free) {
        map.cells_mut()[index] = CellState::Blocked;
    }
    map
}

/// The world with the robot at a random place that is free in the map, and its pose.
fn somewhere(spec: &WorldSpec, map: &Grid<CellState>, seed: u64) -> Option<(PhysicsWorld, Isometry2<f64>)> {
    let mut random = RandomStream::new(seed, Purpose::HouseGenerator);
    let frame = map.frame();
    let is_free = |cell: Cell| {
        let mut around = (-4..=4).flat_map(|x| (-4..=4).map(move |y| Cell::new(cell.x + x, cell.y + y)));
        around.all(|cell| map.get(cell) == Some(&CellState::Free))
    };
    let mut draws = (0..1000).map(|_| frame.cell(random.uniform(0.0..frame.len() as f64) as usize));
    let center = frame.center(draws.find(|cell| is_free(*cell))?);
    let pose = interfaces::pose(center.x, center.y, random.uniform(-3.0..3.0));
    let driven = spec.driven_index();
    let mut fleet = spec.fleet().clone();
    fleet.robots[driven].pose = pose;
    Some((PhysicsWorld::new(&WorldSpec::driving(fleet, driven)?, seed), pose))
}
