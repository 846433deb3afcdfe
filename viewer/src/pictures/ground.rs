//! The parts of a scene that every picture shows: walls, furniture, and what moves with the area it sweeps.

use super::panel::{Chart, Mark, pair};
use crate::scene::{Robot, Scene};
use evaluation::drawing::{ink, why};
use evaluation::palette::{self, Rgb};
use nalgebra::Point2;
use plotters::prelude::*;

/// Draws everything that is no robot.
pub(super) fn draw(chart: &Chart, scene: &Scene) -> Result<(), String> {
    let swept = scene.obstacles.iter().flat_map(|obstacle| &obstacle.reach);
    swept.into_iter().try_for_each(|outline| fill(chart, outline, palette::SWEPT))?;
    scene.walls.iter().try_for_each(|wall| fill(chart, wall, palette::WALL))?;
    for obstacle in scene.obstacles.iter().filter(|obstacle| !obstacle.outline.is_empty()) {
        let color = if obstacle.is_fixed() { palette::FURNITURE } else { palette::MOVING };
        fill(chart, &obstacle.outline, color)?;
    }
    Ok(())
}

/// The entries of the legend for what [`draw`] draws.
pub(super) fn entries(scene: &Scene) -> impl Iterator<Item = (Mark, String)> {
    let has_fixed = scene.obstacles.iter().any(|obstacle| obstacle.is_fixed());
    let has_moving = scene.obstacles.iter().any(|obstacle| !obstacle.is_fixed());
    let entries = [
        (!scene.walls.is_empty(), palette::WALL, "wall"),
        (has_fixed, palette::FURNITURE, "furniture"),
        (has_moving, palette::MOVING, "what moves"),
        (has_moving, palette::SWEPT, "area it sweeps"),
    ];
    let entries = entries.into_iter().filter(|entry| entry.0);
    entries.map(|(_, color, text)| (Mark::Area(color), text.to_owned()))
}

/// Fills a polygon.
pub(super) fn fill(chart: &Chart, corners: &[Point2<f64>], color: Rgb) -> Result<(), String> {
    let corners: Vec<(f64, f64)> = corners.iter().map(pair).collect();
    chart.plotting_area().draw(&Polygon::new(corners, ink(color).filled())).map_err(why)
}

/// The color of a robot.
pub(super) fn robot_color(robot: &Robot) -> Rgb {
    if robot.is_driven { palette::CURIOUS } else { palette::OTHER_ROBOT }
}
