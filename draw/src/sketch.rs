//! A small plan of a world, beside curves.

use crate::canvas::{ink, why};
use crate::legend::{self, Legend, Mark};
use crate::palette::{self, CURIOUS, Rgb};
use crate::pen::{Pen, Sheet};
use crate::scene::{Obstacle, Scene, TimeUnit, extent};
use nalgebra::Point2;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;
use std::f64::consts::TAU;

/// The width of the legend beside a plan, in pixels of the finished picture.
const LEGEND: i32 = 190;
const ROW: i32 = 24;
const SWATCH: i32 = 14;
/// The maximum number of named blocks of a grid world.
const BLOCKS: usize = 8;
const GRID: RGBColor = RGBColor(232, 234, 238);

/// Draws a world with a legend beside it.
///
/// # Errors
///
/// As of the plotting library.
pub fn world<DB: DrawingBackend>(sheet: &Sheet<DB>, pen: &Pen, scene: &Scene) -> Result<(), String> {
    pen.write(sheet, (pen.px(16), pen.px(18)), HPos::Left, 17, "The world")?;
    let (width, _) = sheet.dim_in_pixel();
    let below = sheet.margin(pen.px(34), pen.px(14), pen.px(16), 0);
    let (left, _) = below.split_horizontally(width as i32 - pen.px(LEGEND + 16));
    let right = draw(&left, pen, scene)?;
    let (_, legend) = below.split_horizontally(right + pen.px(14));
    (0..).zip(&entries(scene)).try_for_each(|(row, (mark, text))| {
        let middle = pen.px(12 + row * ROW);
        pen.mark(&legend, *mark, (pen.px(4), middle), SWATCH)?;
        pen.write(&legend, (pen.px(26), middle), HPos::Left, 15, text)
    })
}

/// The entries of the legend.
fn entries(scene: &Scene) -> Legend {
    let blocks = &scene.obstacles;
    let wall = (!scene.walls.is_empty(), Mark::Area(palette::INK), "wall");
    let start = (Mark::Dot(CURIOUS), "start of the robot".to_owned());
    if scene.unit == TimeUnit::Second {
        let has_route = scene.robots.iter().any(|robot| !robot.route.is_empty());
        let mut entries = legend::entries([
            wall,
            (scene.has_obstacle(true), Mark::Area(palette::FURNITURE), "furniture"),
            (scene.has_obstacle(false), Mark::Area(palette::MOVING), "door, or what moves"),
            (has_route, Mark::Area(palette::OTHER_ROBOT), "way of a robot"),
        ]);
        entries.push(start);
        return entries;
    }
    let mut entries = legend::entries([wall]);
    let named = blocks.iter().take(BLOCKS).enumerate();
    entries.extend(named.map(|(index, block)| (Mark::Area(palette::thing(index)), block.name.clone())));
    if blocks.len() > BLOCKS {
        entries.push((Mark::Nothing, format!("and {} more blocks", blocks.len() - BLOCKS)));
    }
    entries.push(start);
    let range = scene.robots.iter().flat_map(|robot| &robot.sectors).map(|sector| sector.range_m).next();
    entries.extend(range.map(|range| (Mark::Ring, format!("range of its sensor: {range}"))));
    entries
}

/// Draws a scene as large as it fits, from the upper left corner. Returns its right end.
fn draw<DB: DrawingBackend>(sheet: &Sheet<DB>, pen: &Pen, scene: &Scene) -> Result<i32, String> {
    let ((width, height), (from, size)) = (sheet.dim_in_pixel(), extent(&scene.frame));
    let side = (f64::from(width) / size.x).min(f64::from(height) / size.y);
    let x = |x: f64| ((x - from.x) * side).round() as i32;
    let y = |y: f64| ((size.y - (y - from.y)) * side).round() as i32;
    let at = |point: &Point2<f64>| (x(point.x), y(point.y));
    let line = |points: Vec<(i32, i32)>, style: ShapeStyle| {
        sheet.draw(&PathElement::new(points, style)).map_err(why)
    };
    let fill = |outline: &[Point2<f64>], color: Rgb| {
        let corners: Vec<(i32, i32)> = outline.iter().map(at).collect();
        sheet.draw(&Polygon::new(corners, ink(color).filled())).map_err(why)
    };
    let is_grid = scene.unit == TimeUnit::Step;
    let (right, bottom) = (x(from.x + size.x), y(from.y));
    for robot in scene.robots.iter().filter(|robot| robot.route.len() > 1) {
        line(robot.route.iter().map(at).collect(), pen.line(ink(palette::OTHER_ROBOT).mix(0.6), 1))?;
    }
    for (index, Obstacle { reach, .. }) in scene.obstacles.iter().enumerate().filter(|_| is_grid) {
        reach.iter().try_for_each(|cell| fill(cell, palette::thing(index)))?;
    }
    let cell_m = scene.frame.resolution_m();
    if is_grid && side * cell_m >= f64::from(pen.px(7)) {
        let thin = pen.line(GRID, 1);
        (0..=scene.frame.width())
            .map(|column| x(from.x + column as f64 * cell_m))
            .try_for_each(|x| line(vec![(x, 0), (x, bottom)], thin))?;
        (0..=scene.frame.height())
            .map(|row| y(from.y + row as f64 * cell_m))
            .try_for_each(|y| line(vec![(0, y), (right, y)], thin))?;
    }
    scene.walls.iter().try_for_each(|wall| fill(wall, palette::INK))?;
    for obstacle in scene.obstacles.iter().filter(|_| !is_grid) {
        // A door is drawn open.
        fill(obstacle.reach.last().unwrap_or(&obstacle.outline), obstacle.color())?;
    }
    for robot in scene.robots.iter().filter(|robot| robot.is_driven) {
        let start = Point2::from(robot.pose.translation.vector);
        for sector in robot.sectors.iter().filter(|_| is_grid) {
            let ring: Vec<Point2<f64>> = (0..=180)
                .map(|part| libm::sincos(TAU * f64::from(part) / 180.0))
                .map(|(sin, cos)| start + nalgebra::Vector2::new(cos, sin) * sector.range_m)
                .collect();
            let is_in = |at: &Point2<f64>| at >= &from && at <= &(from + size);
            let arcs = ring.chunk_by(|a, b| is_in(a) == is_in(b)).filter(|arc| is_in(&arc[0]));
            arcs.into_iter()
                .try_for_each(|arc| line(arc.iter().map(at).collect(), pen.line(ink(CURIOUS), 2)))?;
        }
        let radius = if is_grid {
            (0.35 * cell_m * side / f64::from(pen.px(1))).round().clamp(2.0, 6.0) as i32
        } else {
            4
        };
        pen.dot(sheet, at(&start), radius, CURIOUS)?;
    }
    Ok(right)
}
