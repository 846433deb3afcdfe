//! Tests of the physics world as a whole.

mod behaviors;
mod calendar;
mod contacts;
mod contract;
mod docs;
mod drives;
mod extreme;
mod fleet;
mod floor_plan;
mod footprint;
mod glass;
mod houses;
mod jams;
mod keys;
mod laser;
mod learning;
mod obstacles;
mod odometry;
mod patrol;
mod random;
mod rooms;
mod senses;
mod snapshot;
#[allow(dead_code)] // the tests of `sim` use all of them
#[path = "../../../../sim/src/physics/tests/specs.rs"]
mod specs;
mod standstill;
mod sweep;
mod things;
mod truth;
mod turned;

use interfaces::{GroundTruth, LaserReading, TrueState, Twist, World};
use nalgebra::Point2;
use sim::physics::*;

const FOUR_ROOMS: &str = include_str!("../../../../worlds/four_rooms.toml");

fn four_rooms() -> WorldSpec {
    parse(FOUR_ROOMS)
}

/// A fleet, from the text of its world.
fn parse_fleet(text: &str) -> FleetSpec {
    worldfile::physics::parse_fleet("test.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

/// A wall between two corners, in a file.
fn wall(min_m: [f64; 2], max_m: [f64; 2]) -> String {
    format!("[[wall]]\nmin_m = {min_m:?}\nmax_m = {max_m:?}\n")
}

/// A controller with one command for all robots.
fn always(linear_mps: f64, angular_radps: f64) -> impl FnMut(&RobotView<'_>, &LaserReading) -> Twist {
    move |_, _| Twist { linear_mps, angular_radps }
}

/// The state of the cell at a point.
fn state_at(world: &PhysicsWorld, x_m: f64, y_m: f64) -> TrueState {
    let frame = &world.spec().frame;
    world.truth().state(frame.index(frame.cell_at(&Point2::new(x_m, y_m))).unwrap())
}

/// The distance of a point to the nearest wall, m.
fn wall_m(spec: &FleetSpec, at: &Point2<f64>) -> f64 {
    spec.walls.iter().map(|wall| wall.distance_m(at)).fold(f64::INFINITY, f64::min)
}

fn parse(text: &str) -> WorldSpec {
    worldfile::physics::parse_world("test.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

/// The four rooms with parts of the file replaced.
fn four_rooms_but(replacements: &[(&str, &str)], more: &str) -> WorldSpec {
    let mut text = FOUR_ROOMS.to_owned();
    for (from, to) in replacements {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    parse(&format!("{text}\n{more}"))
}

/// Simulates the world under one command for some seconds, with a call at every reading. Returns the contacts.
fn drive(
    world: &mut PhysicsWorld,
    twist: Twist,
    seconds: f64,
    mut see: impl FnMut(&PhysicsWorld),
) -> Vec<Contact> {
    let mut contacts = Vec::new();
    for _ in 0..(seconds * 10.0).round() as usize {
        world.act(&twist);
        contacts.extend_from_slice(world.contacts());
        see(world);
    }
    contacts
}

/// The distance between the bodies of the two robots, m.
fn bodies_apart_m(world: &PhysicsWorld) -> f64 {
    let [one, other] = [0, 1].map(|index| world.fleet().robot(index).unwrap());
    let between_m: f64 = (one.pose.translation.vector - other.pose.translation.vector).norm();
    between_m - one.radius_m - other.radius_m
}
