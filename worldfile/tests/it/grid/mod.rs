//! Tests of the grid world as a whole.

mod chance;
mod contract;
mod golden;
mod robot;
mod schedule;
mod truth;

use interfaces::{Cell, GroundTruth, Step, World};
use sim::grid::{GenerateSettings, GridSpec, GridWorld};

/// The shipped grid worlds.
const SHIPPED: [(&str, &str); 5] = [
    ("two_blocks", include_str!("../../../../worlds/two_blocks.toml")),
    ("open_hall", include_str!("../../../../worlds/open_hall.toml")),
    ("corridor_with_doors", include_str!("../../../../worlds/corridor_with_doors.toml")),
    ("many_slow_blocks", include_str!("../../../../worlds/many_slow_blocks.toml")),
    ("one_fast_block", include_str!("../../../../worlds/one_fast_block.toml")),
];

/// A world from a drawing, rows from the top, and more of its file.
fn spec(drawing: &str, more: &str) -> GridSpec {
    let map = drawing.split_whitespace().collect::<Vec<_>>().join("\n");
    let text = format!("name = \"test\"\nsensor_radius = 4\nmap = \"\"\"\n{map}\n\"\"\"\n{more}");
    worldfile::grid::parse("test.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// A block as in the file.
fn block(name: &str, dwell: u32, course: &str, path: &str) -> String {
    format!("[[block]]\nname = \"{name}\"\ndwell = {dwell}\ncourse = \"{course}\"\npath = {path}\n")
}

/// A sequence of this number of steps that depends only on its number.
fn way(number: u64) -> impl Iterator<Item = Step> {
    // Knuth's MMIX generator; its high bits are good enough for a random walk.
    let mut state = number;
    std::iter::from_fn(move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        Some(Step::ALL[(state >> 33) as usize % Step::ALL.len()])
    })
}
