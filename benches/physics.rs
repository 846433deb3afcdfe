//! The time of a tick of the shipped worlds, and of a step of fleets: `cargo bench -p benches --bench physics`.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use interfaces::{Twist, World};
use sim::physics::{Fleet, FleetSpec, PhysicsWorld};

const WORLDS: [&str; 2] = ["four_rooms", "turned_house"];

fn main() {
    divan::main();
}

fn world(name: &str) -> PhysicsWorld {
    let text = match name {
        "four_rooms" => include_str!("../worlds/four_rooms.toml"),
        _ => include_str!("../worlds/turned_house.toml"),
    };
    match worldfile::physics::parse_world(name, text) {
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
    let text = include_str!("../worlds/four_rooms.toml");
    let mut text = text[..text.find("[[robot]]").unwrap_or(text.len())].to_owned();
    for robot in 0..robots {
        let at = [robot % 20, robot / 20].map(|place| 0.55 + 0.57 * place as f64);
        text += &format!(
            "[[robot]]\nname = \"{robot}\"\nradius_m = 0.15\npose_m = {at:?}\nheading_deg = {}\n\
             drive = {{ max_linear_mps = 0.5, max_angular_degps = 120.0, max_linear_acceleration_mps2 = 1.0, \
             max_angular_acceleration_degps2 = 360.0 }}\n\
             laser = {{ beams = {BEAMS}, range_max_m = 10.0, rate_hz = 10.0 }}\n\
             behaviour = {{ kind = \"wander\", speed_mps = 0.4 }}\n",
            robot * 77 % 360
        );
    }
    match worldfile::physics::parse_fleet("fleet", &text) {
        Ok(spec) => spec,
        Err(error) => panic!("{error}"),
    }
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

/// Writing a fleet as bytes, and reading it.
#[divan::bench]
fn snapshot_of_100(bencher: Bencher<'_, '_>) {
    let fleet = Fleet::new(&fleet(100), 0);
    bencher.bench_local(|| black_box(fleet.snapshot()));
}
