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
mod senses;
mod snapshot;
mod standstill;
mod sweep;
mod things;
mod truth;

use interfaces::{LaserReading, TrueState, Twist, World};
use sim::physics::*;

const FOUR_ROOMS: &str = include_str!("../../../../worlds/four_rooms.toml");

fn four_rooms() -> WorldSpec {
    parse(FOUR_ROOMS)
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

/// The smallest distance between the bodies of two robots, m.
fn bodies_apart_m(world: &PhysicsWorld) -> f64 {
    let robots: Vec<RobotView<'_>> = world.fleet().robots().collect();
    let pairs = (0..robots.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    let gap = |(a, b): (usize, usize)| {
        let between: f64 = (robots[a].pose.translation.vector - robots[b].pose.translation.vector).norm();
        between - robots[a].radius_m - robots[b].radius_m
    };
    pairs.map(gap).fold(f64::INFINITY, f64::min)
}
