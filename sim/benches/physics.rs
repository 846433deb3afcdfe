//! What a tick of the shipped worlds costs: `cargo bench -p sim`.

use divan::{Bencher, black_box};
use geometry::{Twist, World};
use sim::physics::{PhysicsWorld, WorldSpec};

const WORLDS: [&str; 2] = ["four_rooms", "turned_house"];

fn main() {
    divan::main();
}

fn world(name: &str) -> PhysicsWorld {
    let text = match name {
        "four_rooms" => include_str!("../../worlds/four_rooms.toml"),
        _ => include_str!("../../worlds/turned_house.toml"),
    };
    match WorldSpec::parse(name, text) {
        Ok(spec) => PhysicsWorld::new(&spec, 0),
        Err(error) => panic!("{error}"),
    }
}

/// A tick without a look: two physics steps, the dummy's scan and mind, the truth.
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
    // A look is kept until time goes on, so every sample has a world of its own.
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
