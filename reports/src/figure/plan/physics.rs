//! The plan of a physics world: walls, furniture, doors and what else moves, the rounds of the other robots, the start.

use super::{Entry, Mark, dot};
use crate::figure::pen::{Pen, Sheet};
use nalgebra::Point2;
use plotters::prelude::*;
use results::drawing::palette;
use results::drawing::{INK, ink, why};
use sim::physics::{BehaviorSpec, Repeat, WorldSpec};

const FURNITURE: RGBColor = ink(palette::FURNITURE);
const MOVING: RGBColor = ink(palette::MOVING);
const ROUND: RGBColor = ink(palette::OTHER_ROBOT);

/// The entries of the legend.
pub(super) fn legend(world: &WorldSpec) -> Vec<Entry> {
    let has_round = world.robots.iter().any(|robot| !round(&robot.behavior).is_empty());
    let entries = [
        (!world.walls.is_empty(), INK, "wall"),
        (world.obstacles.iter().any(|obstacle| !obstacle.is_mover()), FURNITURE, "furniture"),
        (world.obstacles.iter().any(|obstacle| obstacle.is_mover()), MOVING, "door, or what moves"),
        (has_round, ROUND, "way of a robot"),
    ];
    let shown = entries.into_iter().filter(|(is_shown, ..)| *is_shown);
    let shown = shown.map(|(_, color, text)| (Mark::Square(color), text.to_owned()));
    shown.chain([(Mark::Dot, "start of the robot".to_owned())]).collect()
}

/// Draws a world as large as it fits, from the upper left corner. Returns the right end of the plan.
pub(super) fn draw<DB: DrawingBackend>(
    sheet: &Sheet<DB>,
    pen: &Pen,
    world: &WorldSpec,
) -> Result<i32, String> {
    let cells = [world.frame.width(), world.frame.height()].map(|cells| cells as f64);
    let (width, height) = sheet.dim_in_pixel();
    let side = (f64::from(width) / cells[0]).min(f64::from(height) / cells[1]);
    let origin = world.frame.center(interfaces::Cell::new(0, 0));
    let at = |point: &Point2<f64>| {
        let cell = (point - origin) / world.frame.resolution_m();
        (((cell.x + 0.5) * side).round() as i32, ((cells[1] - cell.y - 0.5) * side).round() as i32)
    };
    let fill = |corners: [Point2<f64>; 4], color: RGBColor| {
        sheet.draw(&Polygon::new(corners.map(|corner| at(&corner)), color.filled())).map_err(why)
    };
    for robot in &world.robots {
        let way: Vec<(i32, i32)> = round(&robot.behavior).iter().map(at).collect();
        if way.len() > 1 {
            sheet.draw(&PathElement::new(way, pen.line(ROUND.mix(0.6), 1))).map_err(why)?;
        }
    }
    for wall in &world.walls {
        fill(wall.corners(), INK)?;
    }
    for obstacle in &world.obstacles {
        fill(obstacle.opened().corners(), if obstacle.is_mover() { MOVING } else { FURNITURE })?;
    }
    dot(sheet, pen, at(&world.driven().pose.translation.vector.into()), 4)?;
    Ok((cells[0] * side).round() as i32)
}

/// The points of the way of a robot; empty if it has none.
fn round(behavior: &BehaviorSpec) -> Vec<Point2<f64>> {
    match behavior {
        BehaviorSpec::Waypoints(way) if way.repeat == Repeat::Loop => {
            way.points.iter().chain(way.points.first()).copied().collect()
        }
        BehaviorSpec::Waypoints(way) => way.points.clone(),
        BehaviorSpec::WallPatrol(patrol) => vec![patrol.from, patrol.to],
        _ => Vec::new(),
    }
}
