//! Grid worlds.

use super::Content;
use sim::grid::{BlockSpec, Course, GridSpec};

pub(super) fn content(world: &GridSpec) -> Content {
    let frame = *world.frame();
    let free = world.walls.cells().iter().filter(|is_wall| !**is_wall).count();
    let chance = |what: &str, chance: f64| format!("{what} moves with probability {chance}");
    let mut lines = vec![
        ("size", format!("{} × {} cells, {free} of them free", frame.width(), frame.height())),
        (
            "robot",
            format!(
                "starts at [{}, {}], sees {} cells far",
                world.start.x, world.start.y, world.sensor_radius
            ),
        ),
    ];
    if world.block_probability < 1.0 || world.robot_probability < 1.0 {
        let both = [chance("a block", world.block_probability), chance("the robot", world.robot_probability)];
        lines.push(("chance", both.join(", ")));
    }
    lines.extend(world.blocks.iter().map(|block| ("block", describe(block))));
    Content {
        kind: "grid world",
        name: world.name.to_owned(),
        description: world.description.to_owned(),
        lines,
        scene: world.into(),
    }
}

/// A block's name, way and rhythm.
fn describe(block: &BlockSpec) -> String {
    let course = match block.course {
        Course::Loop => "round and round",
        Course::BackAndForth => "back and forth",
    };
    let (name, cells, dwell) = (&block.name, block.path.len(), block.dwell);
    format!("`{name}` on {cells} cells, {course}, {dwell} steps on each")
}
