//! Grid worlds.

use super::{Content, Plan, Robot, Thing};
use geometry::Cell;
use nalgebra::{Isometry2, Point2};
use sim::grid::{BlockSpec, Course, GridSpec};

pub(super) fn content(world: &GridSpec) -> Content {
    let frame = *world.frame();
    let walls: Vec<usize> = (0..frame.len()).filter(|&cell| world.walls().cells()[cell]).collect();
    let chance = |what: &str, chance: f64| format!("{what} moves with probability {chance}");
    let mut lines = vec![
        (
            "size",
            format!(
                "{} × {} cells, {} of them free",
                frame.width(),
                frame.height(),
                frame.len() - walls.len()
            ),
        ),
        (
            "robot",
            format!(
                "starts at [{}, {}], sees {} cells far",
                world.start().x,
                world.start().y,
                world.sensor_radius()
            ),
        ),
    ];
    if world.block_chance() < 1.0 || world.robot_chance() < 1.0 {
        let both = [chance("a block", world.block_chance()), chance("the robot", world.robot_chance())];
        lines.push(("chance", both.join(", ")));
    }
    lines.extend(world.blocks().iter().map(|block| ("block", describe(block))));
    let square = |cell: Cell| {
        let middle = frame.center(cell);
        [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
            .map(|(x, y)| {
                Point2::new(middle.x + x * frame.resolution_m(), middle.y + y * frame.resolution_m())
            })
            .to_vec()
    };
    let thing = |block: &BlockSpec| Thing {
        name: block.name.clone(),
        outline: block.path.first().map_or(Vec::new(), |&cell| square(cell)),
        reach: block.path.iter().map(|&cell| square(cell)).collect(),
    };
    Content {
        kind: "grid world",
        name: world.name().to_owned(),
        description: world.description().to_owned(),
        lines,
        plan: Plan {
            unit: "cells",
            frame,
            walls: walls.iter().map(|&cell| square(frame.cell(cell))).collect(),
            things: world.blocks().iter().map(thing).collect(),
            robots: vec![Robot {
                name: "robot".to_owned(),
                pose: Isometry2::translation(frame.center(world.start()).x, frame.center(world.start()).y),
                radius: 0.4 * frame.resolution_m(),
                is_driven: true,
            }],
        },
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
