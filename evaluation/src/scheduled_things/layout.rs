//! Where the things with a schedule are, and the ways between places past the doors among them.

use crate::metrics::{Routes, Way};
use interfaces::{CellState, GridFrame, GroundTruth, TrueState};
use mapper::{Door, Mapper, ThingKind};
use nalgebra::{Point2, Vector2};
use sim::physics::{Motion, ObstacleSpec, PhysicsGroundTruth, Rectangle, WorldSpec};
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

/// The part of a closed leaf whose cells are those of the door: cells at its ends can belong to the wall.
const MIDDLE: f64 = 0.6;
/// A door of the map whose closed leaf is centered this near to that of the world is this door, m.
const SAME_DOOR_M: f64 = 0.3;
/// How far beside a closed leaf a free cell is looked for, m.
const BESIDE_M: f64 = 0.5;
/// The number of places between which users want to go, spread evenly over the free cells.
const PLACES: usize = 12;

/// The things with a schedule, and the routes past their doors.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) things: Vec<Thing>,
    pub(super) routes: Routes,
}

/// A thing that is there, or closed, by a schedule.
#[derive(Clone, Debug)]
pub(super) struct Thing {
    center: Point2<f64>,
    is_door: bool,
    /// The cells that are blocked when it is there, from its center on.
    cells: Vec<usize>,
}

impl Thing {
    fn new(obstacle: &ObstacleSpec, frame: &GridFrame) -> Self {
        let (shape, is_door) = (&obstacle.shape, matches!(obstacle.motion, Motion::Door(_)));
        let cell_m = frame.resolution_m();
        let reach = match is_door {
            true => Vector2::new(MIDDLE * shape.half_m.x, 0.0),
            false => shape.half_m.map(|half_m| (half_m - cell_m / 2.0).max(0.0)),
        };
        let steps = reach.map(|reach_m| (2.0 * reach_m / cell_m).ceil() as i32);
        let offset = |step: i32, axis: usize| f64::from(step) / f64::from(steps[axis].max(1)) * reach[axis];
        let points = (-steps.x..=steps.x).flat_map(|x| (-steps.y..=steps.y).map(move |y| (x, y)));
        let cells: BTreeSet<usize> = points
            .filter_map(|(x, y)| {
                frame.index(frame.cell_at(&(shape.pose * Point2::new(offset(x, 0), offset(y, 1)))))
            })
            .collect();
        let center = Point2::from(shape.pose.translation.vector);
        let own = frame.index(frame.cell_at(&center));
        let others = cells.into_iter().filter(|cell| Some(*cell) != own);
        Self { center, is_door, cells: own.into_iter().chain(others).collect() }
    }

    /// The probability that it is there, or closed, as the map predicts it from its last reading: for a door of the map by its clock,
    /// otherwise that of the cell that is most probably blocked. ½ if no cell was ever seen.
    pub(super) fn predicted(&self, mapper: &Mapper, time_s: f64) -> f64 {
        if let Some(door) = self.is_door.then(|| self.door(mapper)).flatten() {
            return 1.0 - door.clock.probability(mapper.epoch_s() + time_s, mapper.calendar());
        }
        let ahead_s = (time_s - mapper.time()).max(0.0);
        let known = self.cells.iter().filter(|cell| mapper.states().cells()[**cell] != CellState::Unknown);
        known.map(|cell| mapper.blocked_probability_later(*cell, ahead_s)).reduce(f64::max).unwrap_or(0.5)
    }

    fn door<'a>(&self, mapper: &'a Mapper) -> Option<&'a Door> {
        let doors = mapper.things().iter().filter_map(|thing| match &thing.kind {
            ThingKind::Door(door) if door.is_open.is_some() => Some(&**door),
            _ => None,
        });
        let far_m = |door: &&Door| {
            (nalgebra::center(&door.closed.ends[0], &door.closed.ends[1]) - self.center).norm()
        };
        doors.filter(|door| far_m(door) <= SAME_DOOR_M).min_by(|a, b| far_m(a).total_cmp(&far_m(b)))
    }

    /// Whether it is there, or closed.
    pub(super) fn is_blocked(&self, truth: &PhysicsGroundTruth) -> bool {
        self.cells.first().is_some_and(|cell| truth.state(*cell) != TrueState::Free)
    }
}

impl Layout {
    pub(super) fn of(spec: &WorldSpec) -> Self {
        let scheduled: Vec<&ObstacleSpec> =
            spec.obstacles.iter().filter(|obstacle| obstacle.schedule().is_some()).collect();
        let things: Vec<Thing> = scheduled.iter().map(|obstacle| Thing::new(obstacle, &spec.frame)).collect();
        let leaves: Vec<(usize, Rectangle)> = things
            .iter()
            .zip(&scheduled)
            .enumerate()
            .filter(|(_, (thing, _))| thing.is_door)
            .map(|(index, (_, obstacle))| (index, obstacle.shape))
            .collect();
        let routes = if leaves.is_empty() { Routes::default() } else { routes(spec, &leaves) };
        Self { things, routes }
    }
}

/// The ways between places and both sides of each door, over free cells, at the speed of the robot. Things that come and go are passed.
fn routes(spec: &WorldSpec, leaves: &[(usize, Rectangle)]) -> Routes {
    let frame = &spec.frame;
    let fixed = spec.obstacles.iter().filter(|obstacle| matches!(obstacle.motion, Motion::Fixed));
    let walls: Vec<Rectangle> =
        spec.walls.iter().copied().chain(fixed.map(|obstacle| obstacle.shape)).collect();
    let doors: Vec<Rectangle> = leaves.iter().map(|leaf| leaf.1).collect();
    let mut is_free: Vec<bool> = (0..frame.len()).map(|index| !covers(&walls, frame, index)).collect();
    let start = frame.index(frame.cell_at(&spec.driven().pose.translation.vector.into()));
    let inside: Vec<usize> = start.map_or(Vec::new(), |start| {
        let times_s = distances_m(frame, &is_free, start);
        (0..frame.len())
            .filter(|index| times_s[*index].is_finite() && !covers(&doors, frame, *index))
            .collect()
    });
    (0..frame.len()).filter(|index| covers(&doors, frame, *index)).for_each(|index| is_free[index] = false);
    let places = PLACES.min(inside.len());
    // In the middle of equal parts of the free cells.
    let mut nodes: Vec<usize> =
        (0..places).map(|place| inside[(2 * place + 1) * inside.len() / (2 * places)]).collect();
    let mut ways = vec![Vec::new(); places];
    let speed_mps = spec.driven().drive.max_linear_mps;
    for (door, leaf) in leaves {
        let [Some(one), Some(other)] = [-1.0, 1.0].map(|side| beside(frame, &is_free, leaf, side)) else {
            continue;
        };
        let length_m = (frame.center(frame.cell(one)) - frame.center(frame.cell(other))).norm();
        let way = |to| vec![Way { to, time_s: length_m / speed_mps, door: Some(*door) }];
        ways.extend([way(nodes.len() + 1), way(nodes.len())]);
        nodes.extend([one, other]);
    }
    for (from, cell) in nodes.iter().enumerate() {
        let far_m = distances_m(frame, &is_free, *cell);
        let others = nodes.iter().enumerate().filter(|(to, cell)| *to != from && far_m[**cell].is_finite());
        ways[from].extend(others.map(|(to, cell)| Way { to, time_s: far_m[*cell] / speed_mps, door: None }));
    }
    Routes { ways, ends: (0..places).collect() }
}

fn covers(shapes: &[Rectangle], frame: &GridFrame, index: usize) -> bool {
    let at = frame.center(frame.cell(index));
    shapes.iter().any(|shape| {
        let own = shape.pose.inverse_transform_point(&at);
        own.x.abs() <= shape.half_m.x + 0.5 * frame.resolution_m()
            && own.y.abs() <= shape.half_m.y + 0.5 * frame.resolution_m()
    })
}

/// The nearest free cell on one side of a closed leaf.
fn beside(frame: &GridFrame, is_free: &[bool], leaf: &Rectangle, side: f64) -> Option<usize> {
    let cell_m = frame.resolution_m();
    let steps = (0..=(BESIDE_M / cell_m) as u32).map(|step| leaf.half_m.y + f64::from(step) * cell_m);
    let mut cells =
        steps.filter_map(|from_m| frame.index(frame.cell_at(&(leaf.pose * Point2::new(0.0, side * from_m)))));
    cells.find(|cell| is_free[*cell])
}

/// The length of the shortest way from a cell to every cell, over free cells and their 8 neighbors, m.
fn distances_m(frame: &GridFrame, is_free: &[bool], from: usize) -> Vec<f64> {
    let mut far_m = vec![f64::INFINITY; frame.len()];
    far_m[from] = 0.0;
    // Lengths of 0 or more have the order of their bits.
    let mut open = BinaryHeap::from([Reverse((0_u64, from))]);
    while let Some(Reverse((bits, index))) = open.pop() {
        let here_m = f64::from_bits(bits);
        if here_m > far_m[index] {
            continue;
        }
        let cell = frame.cell(index);
        for (x, y) in (-1..=1).flat_map(|x| (-1..=1).map(move |y| (x, y))) {
            let Some(next) = frame.index(interfaces::Cell::new(cell.x + x, cell.y + y)) else { continue };
            let next_m = here_m + f64::from(x * x + y * y).sqrt() * frame.resolution_m();
            if is_free[next] && next_m < far_m[next] {
                far_m[next] = next_m;
                open.push(Reverse((next_m.to_bits(), next)));
            }
        }
    }
    far_m
}
