//! The description of a grid world.

use super::Content;
use calendar::moment;
use evaluation::scenes::Displayed;
use sim::grid::{BlockSpec, Course, GridSpec};

pub(super) fn content(world: &GridSpec) -> Content {
    let frame = *world.frame();
    let free = world.walls.cells().iter().filter(|is_wall| !**is_wall).count();
    let moves = |what: &str, probability: f64| format!("{what} moves with probability {probability}");
    let mut lines = vec![
        ("size", format!("{} × {} cells, {free} of them free", frame.width(), frame.height())),
        (
            "robot",
            format!(
                "starts at [{}, {}], sensor range {} cells",
                world.start.x, world.start.y, world.sensor_radius
            ),
        ),
    ];
    if world.block_probability < 1.0 || world.robot_probability < 1.0 {
        // A block with a schedule keeps to its calendar.
        let (scheduled, others): (Vec<_>, Vec<_>) =
            world.blocks.iter().partition(|block| block.schedule.is_some());
        let block = if scheduled.is_empty() { "a block" } else { "a block without a schedule" };
        let block = moves(block, world.block_probability);
        let block = (scheduled.is_empty() || !others.is_empty()).then_some(block);
        let both = block.into_iter().chain([moves("the robot", world.robot_probability)]);
        lines.push(("chance", both.collect::<Vec<_>>().join(", ")));
    }
    lines.extend(world.calendar.map(|steps| {
        let starts = moment(steps.starts_s);
        ("calendar", format!("the world starts on {starts}, steps of {} s", steps.step_s))
    }));
    lines.extend(world.blocks.iter().map(|block| ("block", describe(block))));
    Content { kind: "grid world", description: world.description.to_owned(), lines, scene: world.scene() }
}

/// The name, the path and the dwell time of a block.
fn describe(block: &BlockSpec) -> String {
    if block.schedule.is_some() {
        let (first, last) = (block.path[0], block.path[block.path.len() - 1]);
        return format!(
            "`{}` is at [{}, {}], else at [{}, {}], by a schedule",
            block.name, first.x, first.y, last.x, last.y
        );
    }
    let course = match block.course {
        Course::Loop => "in a loop",
        Course::BackAndForth => "back and forth",
    };
    let (name, cells, dwell) = (&block.name, block.path.len(), block.dwell);
    format!("`{name}` moves along {cells} cells, {course}, {dwell} steps on each")
}
