//! The parts of a scene that every picture shows: walls, furniture, and what moves with the area it sweeps.

use crate::canvas::{ink, why};
use crate::legend::{self, Legend, Mark};
use crate::palette::{self, Rgb};
use crate::panel::{Chart, pair};
use crate::scene::Scene;
use nalgebra::Point2;
use plotters::prelude::*;

/// Draws everything except the robots.
pub(crate) fn draw(chart: &Chart<impl DrawingBackend>, scene: &Scene) -> Result<(), String> {
    let swept = scene.obstacles.iter().flat_map(|obstacle| &obstacle.reach);
    swept.into_iter().try_for_each(|outline| fill(chart, outline, palette::SWEPT))?;
    scene.walls.iter().try_for_each(|wall| fill(chart, wall, palette::WALL))?;
    let present = scene.obstacles.iter().filter(|obstacle| !obstacle.outline.is_empty());
    present.into_iter().try_for_each(|obstacle| fill(chart, &obstacle.outline, obstacle.color()))
}

/// The entries of the legend for what [`draw`] draws.
pub(crate) fn entries(scene: &Scene) -> Legend {
    let has_moving = scene.has_obstacle(false);
    legend::entries([
        (!scene.walls.is_empty(), Mark::Area(palette::WALL), "wall"),
        (scene.has_obstacle(true), Mark::Area(palette::FURNITURE), "furniture"),
        (has_moving, Mark::Area(palette::MOVING), "what moves"),
        (has_moving, Mark::Area(palette::SWEPT), "area it sweeps"),
    ])
}

/// Fills a polygon.
pub(crate) fn fill(
    chart: &Chart<impl DrawingBackend>,
    corners: &[Point2<f64>],
    color: Rgb,
) -> Result<(), String> {
    let corners: Vec<(f64, f64)> = corners.iter().map(pair).collect();
    chart.plotting_area().draw(&Polygon::new(corners, ink(color).filled())).map_err(why)
}
