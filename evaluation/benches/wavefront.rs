//! The time of planning and driving in a house of 12×12 m with four rooms, in cells of 0.05 m.

use controller::{
    ControlInput, Controller, Costmap, DIAGONAL, DiffDrive, DiffDriveSettings, Driver, Inflation,
    InflationSettings, Moves, Path, Planner, STRAIGHT, Settings, Wavefront,
};
use divan::{Bencher, black_box};
use interfaces::{Cell, CellState, Grid, GridFrame, Purpose, RandomStream, Transition, pose};
use nalgebra::{Point2, Vector2};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::TAU;

const RADIUS_M: f64 = 0.2;

fn main() {
    divan::main();
}

/// Four rooms of 6×6 m, walls of 0.1 m, doors of 1 m.
fn house() -> Grid<CellState> {
    let frame = GridFrame::new(Point2::origin(), 0.05, 240, 240).expect("a frame");
    let mut map = Grid::filled(frame, CellState::Free);
    for index in 0..frame.len() {
        let Cell { x, y } = frame.cell(index);
        let outer = x.min(y).min(239 - x).min(239 - y) < 2;
        let wall = |across: i32, along: i32| (119..=120).contains(&across) && (along % 120 - 60).abs() > 10;
        if outer || wall(x, y) || wall(y, x) {
            map.cells_mut()[index] = CellState::Blocked;
        }
    }
    map
}

fn inflated() -> Inflation {
    Inflation::new(&InflationSettings::default(), RADIUS_M, &house())
}

/// The front of a robot that has moved by one cell: 8 cells become blocked, 8 free.
fn passing_by(map: &Grid<CellState>) -> [Vec<Transition>; 2] {
    let cells = |x: i32| (150..158).map(move |y| Cell::new(x, y));
    let block = cells(180).map(|cell| (cell, CellState::Free, CellState::Blocked));
    let free = cells(172).map(|cell| (cell, CellState::Blocked, CellState::Free));
    assert!(cells(180).all(|cell| map.get(cell) == Some(&CellState::Free)));
    let there: Vec<_> =
        block.chain(free).map(|(cell, before, after)| Transition { cell, before, after }).collect();
    let back = there.iter().map(|t| Transition { cell: t.cell, before: t.after, after: t.before }).collect();
    [there, back]
}

#[divan::bench]
fn wavefront_full_field(bencher: Bencher) {
    let inflation = inflated();
    let mut wave = Wavefront::new(*inflation.costmap().frame(), Moves::Eight);
    bencher.bench_local(|| {
        wave.clear();
        wave.spread(inflation.costmap(), black_box(Cell::new(40, 40)), None);
        wave.path_cost(Cell::new(200, 200))
    });
}

#[divan::bench]
fn heap_dijkstra_full_field(bencher: Bencher) {
    let inflation = inflated();
    bencher.bench_local(|| dijkstra(inflation.costmap(), black_box(Cell::new(40, 40))));
}

/// Dijkstra's algorithm as in textbooks, for comparison.
fn dijkstra(map: &Costmap, source: Cell) -> Vec<u32> {
    let frame = *map.frame();
    let mut costs = vec![u32::MAX; frame.len()];
    let mut heap = BinaryHeap::from([Reverse((0, source))]);
    costs[frame.index(source).unwrap_or(0)] = 0;
    while let Some(Reverse((cost, cell))) = heap.pop() {
        if frame.index(cell).is_none_or(|index| costs[index] < cost) {
            continue;
        }
        for next in cell.neighbours8() {
            let straight = next.x == cell.x || next.y == cell.y;
            let open = map.is_traversable(next)
                && (straight
                    || map.is_traversable(Cell::new(next.x, cell.y))
                        && map.is_traversable(Cell::new(cell.x, next.y)));
            let next_cost = cost + u32::from(map.cost(cell)) * if straight { STRAIGHT } else { DIAGONAL };
            if let Some(index) = frame.index(next).filter(|index| open && next_cost < costs[*index]) {
                costs[index] = next_cost;
                heap.push(Reverse((next_cost, next)));
            }
        }
    }
    costs
}

#[divan::bench]
fn plan_to_the_opposite_room(bencher: Bencher) {
    let map = house();
    let mut planner = Planner::new(&InflationSettings::default(), RADIUS_M, Moves::Eight, &map);
    let mut path = Path::default();
    let (from, to) = (Point2::new(2.0, 2.0), Point2::new(10.0, 9.0));
    bencher.bench_local(|| planner.plan(&map, black_box(&from), &to, &mut path));
}

#[divan::bench]
fn plan_across_the_room(bencher: Bencher) {
    let map = house();
    let mut planner = Planner::new(&InflationSettings::default(), RADIUS_M, Moves::Eight, &map);
    let mut path = Path::default();
    let (from, to) = (Point2::new(2.0, 2.0), Point2::new(4.0, 3.0));
    bencher.bench_local(|| planner.plan(&map, black_box(&from), &to, &mut path));
}

#[divan::bench]
fn inflation_update_of_16_cells(bencher: Bencher) {
    let map = house();
    let mut inflation = inflated();
    let [there, back] = passing_by(&map);
    let mut forth = false;
    bencher.bench_local(|| {
        forth = !forth;
        inflation.update(black_box(if forth { &there } else { &back }), |_| {}, |_| {});
    });
}

#[divan::bench]
fn inflation_of_a_new_map(bencher: Bencher) {
    let map = house();
    bencher.bench_local(|| {
        Inflation::new(&InflationSettings::default(), RADIUS_M, black_box(&map))
            .costmap()
            .cost(Cell::new(0, 0))
    });
}

/// A tick on the way: a scan of 720 beams 0.4 m from a wall; nothing to plan.
#[divan::bench]
fn drive_tick(bencher: Bencher) {
    let map = house();
    let robot = pose(2.0, 0.5, 0.0);
    let points: Vec<_> =
        (0..720).map(|beam| first_hit(&map, robot.translation.vector.into(), beam)).collect();
    let input = |time| ControlInput { time, pose: &robot, map: &map, transitions: &[], points: &points };
    let drive = DiffDrive::new(DiffDriveSettings::default()).expect("defaults");
    let rng = RandomStream::new(0, Purpose::Controller);
    let mut controller = Controller::new(Settings::default(), drive, rng).expect("defaults");
    controller.set_goal(Point2::new(5.0, 0.5), Some(0.0));
    (0..10).for_each(|tick| {
        controller.drive(&input(0.1 * f64::from(tick)));
    });
    bencher
        .with_inputs(|| controller.clone())
        .bench_local_values(|mut controller| (controller.drive(&input(1.0)), controller));
}

fn first_hit(map: &Grid<CellState>, from: Point2<f64>, beam: u32) -> Point2<f64> {
    let (sin, cos) = (TAU * f64::from(beam) / 720.0).sin_cos();
    let mut at = from;
    while map.get(map.frame().cell_at(&at)) == Some(&CellState::Free) {
        at += Vector2::new(cos, sin) * 0.005;
    }
    at
}
