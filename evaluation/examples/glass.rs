//! Beams without a return, in worlds with glass, black furniture, short ranges and large halls on which no limit was tuned.
//!
//! ```text
//! cargo run -p curious-evaluation --example glass -- [FIRST_SEED [SEEDS [MINUTES]]]
//! ```
//!
//! A robot that wanders (or stands) in generated houses, whose people and doors move, and in halls larger than the range. A
//! share of the length of all walls is glass that returns beams within 5° to 25° of its normal; black furniture returns none.
//! The same scans with their true poses go to four mappers: beams without a return are free, are judged as the live node
//! does it, are judged as `map_log` does it (all scans first), are ignored. *Cleared*: the number of times that a cell inside
//! a wall or a piece of furniture became free on the map. *Free*: free cells on the map that are not, m².

use interfaces::{CellState, GridFrame, LaserReading, Purpose, RandomStream, Twist};
use mapper::{Mapper, MapperSettings, NoReturn, NoReturns};
use nalgebra::{Point2, Vector2};
use rand::RngExt;
use rayon::prelude::*;
use sim::physics::{
    BehaviorSpec, Fleet, FleetSpec, Glass, Motion, Rectangle, RobotView, WanderSpec, WorldSpec,
};

/// One kind of world.
#[derive(Clone, Copy)]
struct Kind {
    name: &'static str,
    is_hall: bool,
    /// The share of the length of the walls that is glass.
    glass: f64,
    is_black: bool,
    range_m: f64,
    drives: bool,
}

const HOUSE: Kind =
    Kind { name: "", is_hall: false, glass: 0.0, is_black: false, range_m: 10.0, drives: true };
const HALL: Kind = Kind { is_hall: true, range_m: 8.0, ..HOUSE };

const KINDS: [Kind; 17] = [
    Kind { name: "houses", ..HOUSE },
    Kind { name: "houses, stationary", drives: false, ..HOUSE },
    Kind { name: "houses, range 2.5 m", range_m: 2.5, ..HOUSE },
    Kind { name: "houses, range 2.5 m, stationary", range_m: 2.5, drives: false, ..HOUSE },
    Kind { name: "halls of 40 × 30 m", ..HALL },
    Kind { name: "halls, stationary", drives: false, ..HALL },
    Kind { name: "houses, 5 % glass", glass: 0.05, ..HOUSE },
    Kind { name: "houses, 10 % glass", glass: 0.1, ..HOUSE },
    Kind { name: "houses, 20 % glass", glass: 0.2, ..HOUSE },
    Kind { name: "houses, 40 % glass", glass: 0.4, ..HOUSE },
    Kind { name: "houses, 20 % glass, stationary", glass: 0.2, drives: false, ..HOUSE },
    Kind { name: "houses, 20 % glass, range 2.5 m", glass: 0.2, range_m: 2.5, ..HOUSE },
    Kind { name: "houses, black furniture", is_black: true, ..HOUSE },
    Kind { name: "houses, black furniture, 10 % glass", is_black: true, glass: 0.1, ..HOUSE },
    Kind { name: "halls, 20 % glass", glass: 0.2, ..HALL },
    Kind { name: "halls, 40 % glass", glass: 0.4, ..HALL },
    Kind { name: "halls, 20 % glass, stationary", glass: 0.2, drives: false, ..HALL },
];

impl Kind {
    fn world(&self, seed: u64) -> FleetSpec {
        let mut spec = WorldSpec::generate_house(seed).fleet().clone();
        let mut rng = RandomStream::new(seed, Purpose::HouseGenerator);
        if self.is_hall {
            hall(&mut spec, &mut rng);
        }
        if self.is_black {
            let black = spec.obstacles.extract_if(.., |obstacle| matches!(obstacle.motion, Motion::Fixed));
            let black: Vec<Rectangle> = black.map(|obstacle| obstacle.shape).collect();
            spec.glass.extend(black.iter().map(|&shape| Glass { shape, returns_within_rad: 0.0 }));
            spec.walls.extend(black);
        }
        self.glaze(&mut spec, &mut rng);
        let robot = &mut spec.robots[0];
        (robot.laser.beams, robot.laser.range_max_m) = (360, self.range_m);
        let wander = BehaviorSpec::Wander(WanderSpec { speed_mps: 0.5, clearance_m: 0.3 });
        robot.behavior = if self.drives { wander } else { BehaviorSpec::Standing };
        spec
    }

    /// Turns walls into glass until their share of the length is reached. Walls are cut into pieces of at most 2 m.
    fn glaze(&self, spec: &mut FleetSpec, rng: &mut RandomStream) {
        let black = spec.walls.split_off(spec.walls.len() - spec.glass.len());
        spec.walls = spec.walls.iter().flat_map(pieces).collect();
        let length_m = |wall: &Rectangle| 2.0 * wall.half_m.amax();
        let mut left_m = self.glass * spec.walls.iter().map(length_m).sum::<f64>();
        let mut rest = spec.walls.clone();
        while left_m > 0.0 && !rest.is_empty() {
            let shape = rest.swap_remove(rng.random_range(0..rest.len()));
            let returns_within_rad = rng.random_range(5.0_f64..25.0).to_radians();
            spec.glass.push(Glass { shape, returns_within_rad });
            left_m -= length_m(&shape);
        }
        spec.walls.extend(black);
    }
}

/// A hall with ten pillars, and the robot in the middle of its left part.
fn hall(spec: &mut FleetSpec, rng: &mut RandomStream) {
    let at = Point2::new;
    spec.frame = GridFrame::covering(Point2::origin(), 40.0, 30.0, 0.05).expect("a valid frame");
    let walls =
        [(0.0, 0.0, 40.0, 0.1), (0.0, 29.9, 40.0, 30.0), (0.0, 0.1, 0.1, 29.9), (39.9, 0.1, 40.0, 29.9)];
    spec.walls = walls.map(|(x, y, right, top)| Rectangle::between(at(x, y), at(right, top))).into();
    spec.walls.extend((0..10).map(|_| {
        let low = at(rng.random_range(14.0..38.0), rng.random_range(2.0..28.0));
        Rectangle::between(low, low + Vector2::new(0.6, 0.4))
    }));
    spec.obstacles.clear();
    spec.robots.truncate(1);
    spec.robots[0].pose = interfaces::pose(10.0, rng.random_range(4.0..26.0), rng.random_range(-3.0..3.0));
}

fn pieces(wall: &Rectangle) -> Vec<Rectangle> {
    let axis = wall.half_m.imax();
    let count = (wall.half_m[axis]).ceil().max(1.0);
    let mut half_m = wall.half_m;
    half_m[axis] /= count;
    let piece = |number: usize| {
        let mut by_m = Vector2::zeros();
        by_m[axis] = (2.0 * number as f64 + 1.0 - count) * half_m[axis];
        Rectangle { half_m, ..wall.moved(wall.pose.rotation * by_m) }
    };
    (0..count as usize).map(piece).collect()
}

fn stop(_: &RobotView<'_>, _: &LaserReading) -> Twist {
    Twist::STOP
}

/// The scans of the first robot, with their true poses.
fn scans(spec: &FleetSpec, seed: u64, duration_s: f64) -> Vec<LaserReading> {
    let (mut fleet, mut scans) = (Fleet::new(spec, seed), Vec::<LaserReading>::new());
    while fleet.time_s() < duration_s {
        fleet.step(&mut stop);
        let Some(robot) = fleet.robot(0) else { break };
        let Some(reading) = robot.reading() else { continue };
        if scans.last().is_none_or(|last| last.time_s < reading.time_s) {
            scans.push(reading.clone());
        }
    }
    scans
}

/// What one reading of the beams makes of a run.
#[derive(Clone, Copy, Default)]
struct Outcome {
    cleared: f64,
    free_m2: f64,
    swallowed: f64,
    is_trusted: bool,
}

fn map(spec: &FleetSpec, scans: &[LaserReading], mut no_returns: NoReturns, learns: bool) -> Outcome {
    let mut mapper = Mapper::new(&MapperSettings::default(), spec.frame).expect("default settings");
    let fixed = spec.obstacles.iter().filter(|obstacle| matches!(obstacle.motion, Motion::Fixed));
    let solids: Vec<Rectangle> = spec.walls.iter().copied().chain(fixed.map(|fixed| fixed.shape)).collect();
    let is_solid = |at: &Point2<f64>| solids.iter().any(|solid| solid.distance_m(at) <= 0.0);
    let mut outcome = Outcome::default();
    for scan in scans {
        let mut filtered = scan.clone();
        no_returns.apply(&mut filtered);
        no_returns.protect(&mut filtered);
        mapper.update(&filtered).expect("a valid reading");
        if learns {
            no_returns.learn(scan);
        }
        let gone = mapper.transitions().iter().filter(|change| change.before == CellState::Blocked);
        outcome.cleared += gone.filter(|change| is_solid(&spec.frame.center(change.cell))).count() as f64;
    }
    let cells = mapper.states().cells().iter().enumerate();
    let free = cells.filter(|&(index, state)| {
        *state == CellState::Free && !is_solid(&spec.frame.center(spec.frame.cell(index)))
    });
    outcome.free_m2 = free.count() as f64 * spec.frame.resolution_m().powi(2);
    outcome.swallowed = no_returns.evidence().map(|scanner| scanner.swallowed()).fold(0.0, f64::max);
    outcome.is_trusted = scans.last().is_some_and(|last| no_returns.is_trusted(last));
    outcome
}

/// The outcomes of free, live, log and ignore.
fn outcomes(kind: &Kind, seed: u64, duration_s: f64) -> [Outcome; 4] {
    let spec = kind.world(seed);
    let scans = scans(&spec, seed, duration_s);
    let mut judged = NoReturns::new(NoReturn::Learn);
    scans.iter().for_each(|scan| judged.learn(scan));
    [
        map(&spec, &scans, NoReturns::new(NoReturn::Free), false),
        map(&spec, &scans, NoReturns::new(NoReturn::Learn), true),
        map(&spec, &scans, judged, false),
        map(&spec, &scans, NoReturns::new(NoReturn::Ignore), false),
    ]
}

fn main() {
    let argument =
        |index, default| std::env::args().nth(index).map_or(Ok(default), |text| text.parse::<u64>());
    let number = |index, default| argument(index, default).expect("a whole number");
    let (first, seeds, minutes) = (number(1, 7000), number(2, 8), number(3, 3));
    println!(
        "| worlds | swallowed, learned from the log | trusted: live, log | cleared: free, live, log, ignore | free, m²: free, live, log, ignore |"
    );
    println!("|---|---|---|---|---|");
    for kind in &KINDS {
        let runs: Vec<[Outcome; 4]> = (first..first + seeds)
            .into_par_iter()
            .map(|seed| outcomes(kind, seed, 60.0 * minutes as f64))
            .collect();
        let mean = |of: fn(&Outcome) -> f64| {
            let mean = |way: usize| runs.iter().map(|run| of(&run[way])).sum::<f64>() / runs.len() as f64;
            [0, 1, 2, 3].map(|way| format!("{:.0}", mean(way))).join(", ")
        };
        let trusted =
            [1, 2].map(|way| runs.iter().filter(|run| run[way].is_trusted).count().to_string()).join(", ");
        let mut swallowed: Vec<f64> = runs.iter().map(|run| run[2].swallowed).collect();
        swallowed.sort_by(f64::total_cmp);
        let swallowed =
            swallowed.iter().map(|share| format!("{:.1}", 100.0 * share)).collect::<Vec<_>>().join(" ");
        println!(
            "| {} | {swallowed} % | {trusted} | {} | {} |",
            kind.name,
            mean(|o| o.cleared),
            mean(|o| o.free_m2)
        );
    }
}
