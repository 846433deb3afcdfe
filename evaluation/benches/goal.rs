//! The time to select a goal in a completely seen house of 12 × 12 m in cells of 0.05 m, with 2000 cells that ever
//! changed. A goal is selected every few seconds of simulated time.

use agent::{Agent, AgentSettings, Features, GoalSelector, Policy, Travel};
use interfaces::{Cell, CellReading, GridFrame, Purpose, RandomStream};
use mapper::{Mapper, MapperSettings};
use nalgebra::{Isometry2, Point2};

fn main() {
    divan::main();
}

const SIDE: i32 = 240;

/// Along straight lines, at one meter per unit of time.
struct Flight;

impl Travel for Flight {
    fn times(&mut self, mapper: &Mapper, pose: &Isometry2<f64>, times: &mut Vec<f64>) {
        let (frame, from) = (mapper.frame(), pose.translation.vector.into());
        times.clear();
        times.extend((0..frame.len()).map(|cell| nalgebra::distance(&frame.center(frame.cell(cell)), &from)));
    }
}

/// Rooms of 4 × 4 m that were observed one after the other; obstacles appear and disappear in one of them.
fn house() -> Mapper {
    let frame = GridFrame::new(Point2::origin(), 0.05, SIDE as usize, SIDE as usize).unwrap();
    let mut mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
    for step in 0..180 {
        let room = step / 20;
        let (left, bottom) = (room % 3 * 80, room / 3 * 80);
        let cells = (bottom..bottom + 80).flat_map(|y| (left..left + 80).map(move |x| Cell::new(x, y)));
        let is_blocked =
            |cell: Cell| cell.x % 80 < 2 || cell.y % 80 < 2 || (room == 4 && step % 2 == 0 && cell.x < 105);
        let cells = cells.map(|cell| (cell, is_blocked(cell))).collect();
        let time = f64::from(step) * 0.1;
        mapper.update(&CellReading { time, pose: Isometry2::identity(), cells }).unwrap();
    }
    mapper
}

#[divan::bench(args = ["recency", "poisson", "random", "curious", "fresh-map", "information-gain"])]
fn next_goal(bencher: divan::Bencher, strategy: &str) {
    let mut mapper = house();
    let settings = AgentSettings { patch_cells: 10, ..Default::default() };
    let policy: Policy = strategy.parse().unwrap();
    let mut agent = Agent::new(&settings, &policy, RandomStream::new(0, Purpose::Agent)).unwrap();
    let (features, pose) = (Features::of(&mut mapper), Isometry2::identity());
    // A trajectory of 5 s at 10 Hz; the same call learns from it.
    bencher.bench_local(|| {
        for _ in 0..50 {
            agent.observe(features, &[]);
        }
        agent.next_goal(&pose, &mapper, &mut Flight)
    });
}
