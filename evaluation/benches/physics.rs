//! The time of a tick of the shipped worlds, and of a step of fleets: `cargo bench -p curious-evaluation --bench physics`.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use interfaces::{Twist, World};
use sim::physics::{Controller, Fleet, FleetSpec, PhysicsWorld, RobotView, Velocity};
use std::f64::consts::TAU;

const WORLDS: [&str; 7] = ["four_rooms", "turned_house", "house", "office", "cave", "warehouse", "yard"];

fn main() {
    divan::main();
}

fn world(name: &str) -> PhysicsWorld {
    match worldfile::shipped::load(name) {
        Ok(spec) => PhysicsWorld::new(&spec, 0),
        Err(error) => panic!("{error}"),
    }
}

/// A tick without sensing: two physics steps, scan and behavior of the dummy robot, the ground truth.
#[divan::bench(args = WORLDS)]
fn act(bencher: Bencher<'_, '_>, name: &str) {
    let mut world = world(name);
    let twist = Twist { linear_mps: 0.5, angular_radps: 0.5 };
    bencher.bench_local(|| world.act(black_box(&twist)));
}

/// The curious robot's 720 beams.
#[divan::bench(args = WORLDS)]
fn sense(bencher: Bencher<'_, '_>, name: &str) {
    let spec = world(name).spec().clone();
    let new = || PhysicsWorld::new(&spec, 0);
    // A reading is kept until time advances; every sample therefore has a separate world.
    bencher.with_inputs(new).bench_local_refs(|world| black_box(world.sense()));
}

/// A whole tick of the world.
#[divan::bench(args = WORLDS)]
fn act_and_sense(bencher: Bencher<'_, '_>, name: &str) {
    let mut world = world(name);
    let twist = Twist { linear_mps: 0.5, angular_radps: 0.5 };
    bencher.bench_local(|| {
        world.act(black_box(&twist));
        black_box(world.sense())
    });
}

const BEAMS: usize = 360;

/// The four rooms with robots that wander, on a grid of places.
fn fleet(robots: usize) -> FleetSpec {
    let laser = format!("laser = {{ beams = {BEAMS}, range_max_m = 10.0, rate_hz = 10.0 }}");
    rooms(
        robots,
        (0.55, 0.57),
        &format!("radius_m = 0.15\n{laser}"),
        "kind = \"wander\", speed_mps = 0.4",
        "",
    )
}

/// The four rooms with driven robots that have polygonal footprints and rings of sonars, as in Stage's own benchmarks.
fn ring_fleet(robots: usize, corners: usize, sonars: usize) -> FleetSpec {
    let (radius_m, places) = if robots > 100 { (0.07, (0.4, 0.34)) } else { (0.19, (0.55, 0.57)) };
    let corner = |i: usize| {
        let (sin, cos) = (TAU * (i as f64 + 0.5) / corners as f64).sin_cos();
        [radius_m * cos, radius_m * sin]
    };
    let footprint = (0..corners).map(corner).collect::<Vec<_>>();
    let body = format!(
        "footprint_m = {footprint:?}\nlaser = {{ beams = 180, fov_deg = 180.0, range_max_m = 8.0, rate_hz = 10.0 }}"
    );
    let step_deg = 360.0 / sonars as f64;
    let sonar = |i: usize| {
        format!(
            "[[robot.sonar]]\ncone_deg = 15.0\nrange_max_m = 5.0\nrate_hz = 10.0\nmount_deg = {:?}\n",
            i as f64 * step_deg
        )
    };
    let ring: String = (0..sonars).map(sonar).collect();
    rooms(robots, places, &body, "kind = \"driven\"", &ring)
}

/// The four rooms with equal robots on a grid of places, with the first place on each axis and the distance between
/// two, m.
fn rooms(
    robots: usize,
    (first_m, apart_m): (f64, f64),
    keys: &str,
    behavior: &str,
    tables: &str,
) -> FleetSpec {
    let text = include_str!("../../worlds/four_rooms.toml");
    let mut text = text[..text.find("[[robot]]").unwrap_or(text.len())].to_owned();
    let columns = ((11.45 - first_m) / apart_m) as usize + 1;
    for robot in 0..robots {
        let at = [robot % columns, robot / columns].map(|place| first_m + apart_m * place as f64);
        text += &format!(
            "[[robot]]\nname = \"{robot}\"\npose_m = {at:?}\nheading_deg = {}\n{keys}\n\
             drive = {{ max_linear_mps = 0.5, max_angular_degps = 120.0, max_linear_acceleration_mps2 = 1.0, \
             max_angular_acceleration_degps2 = 360.0 }}\nbehavior = {{ {behavior} }}\n{tables}",
            robot * 77 % 360
        );
    }
    match worldfile::physics::parse_fleet("fleet", &text) {
        Ok(spec) => spec,
        Err(error) => panic!("{error}"),
    }
}

/// Turns toward the side with more space, by the sonars alone; or reads nothing.
struct Driver {
    reads: bool,
}

impl Controller for Driver {
    fn drive(&mut self, robot: &RobotView<'_>) -> Option<Velocity> {
        let count = if self.reads { robot.sonars().count() } else { 0 };
        let side = |(index, reading): (usize, Option<sim::physics::SonarReading>)| {
            f64::from(reading.map_or(0.0, |reading| reading.range_m).clamp(0.0, 5.0))
                * (TAU * index as f64 / count as f64).sin()
        };
        let left_m: f64 = robot.sonars().take(count).enumerate().map(side).sum();
        Some(Twist { linear_mps: 0.3, angular_radps: left_m.clamp(-1.0, 1.0) }.into())
    }
}

/// A tenth of a second of 100 robots with 20 corners and 16 sonars, and of 1000 with 4 and 12; the sonars are read, or
/// not. 0.1 s divided by the time is the real-time factor.
#[divan::bench(args = [(100, 20, 16), (1000, 4, 12)], consts = [false, true], sample_count = 20, sample_size = 5)]
fn tick_of_rings<const READS: bool>(
    bencher: Bencher<'_, '_>,
    (robots, corners, sonars): (usize, usize, usize),
) {
    let mut fleet = Fleet::new(&ring_fleet(robots, corners, sonars), 0);
    let mut driver = Driver { reads: READS };
    fleet.run_until(2.0, &mut driver);
    bencher.counter(ItemsCount::new(robots * sonars)).bench_local(|| {
        fleet.step(&mut driver);
        fleet.step(&mut driver);
    });
}

/// A tenth of a second of a fleet: two physics steps, a scan and a decision of every robot.
#[divan::bench(args = [1, 10, 100])]
fn tick_of_a_fleet(bencher: Bencher<'_, '_>, robots: usize) {
    let mut fleet = Fleet::new(&fleet(robots), 0);
    // The robots have left their starts.
    fleet.run_until(20.0, &mut ());
    bencher.counter(ItemsCount::new(robots * BEAMS)).bench_local(|| {
        fleet.step(&mut ());
        fleet.step(&mut ());
    });
}

/// A new fleet, a reset of one that ran, and a clone.
#[divan::bench(args = WORLDS)]
fn start_new(bencher: Bencher<'_, '_>, name: &str) {
    let spec = world(name).spec().fleet().clone();
    bencher.bench_local(|| black_box(Fleet::new(&spec, 1)));
}

/// See [`start_new`].
#[divan::bench(args = WORLDS)]
fn start_reset(bencher: Bencher<'_, '_>, name: &str) {
    let mut fleet = Fleet::new(world(name).spec(), 0);
    fleet.run_until(5.0, &mut ());
    let mut seed = 0;
    bencher.bench_local(|| {
        seed += 1;
        fleet.reset(black_box(seed));
    });
}

/// See [`start_new`].
#[divan::bench(args = WORLDS)]
fn start_clone(bencher: Bencher<'_, '_>, name: &str) {
    let fleet = Fleet::new(world(name).spec(), 0);
    bencher.bench_local(|| black_box(fleet.clone()));
}

/// Writing a fleet as bytes, and reading it.
#[divan::bench]
fn snapshot_of_100(bencher: Bencher<'_, '_>) {
    let fleet = Fleet::new(&fleet(100), 0);
    bencher.bench_local(|| black_box(fleet.snapshot()));
}
