//! A world from above, at its start.

use super::ground::{self, fill, robot_color};
use super::panel::{Chart, Mark, Panel};
use crate::scene::{Robot, Scene, Sector};
use evaluation::drawing::{Area, INK, px, text, why};
use evaluation::palette;
use nalgebra::{Isometry2, Point2};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::f64::consts::TAU;

/// The corners of the polygon that a circle is drawn as.
const CORNERS: usize = 48;
/// In a scene with more obstacles and robots than this, names and sensors are not drawn.
const MOST_NAMES: usize = 40;
/// The drawn part of the range of a sensor, as a multiple of the robot's radius: all of it would cover the
/// world.
const SECTOR_RADII: f64 = 2.5;

/// Draws the scene, the robots with the directions of their sensors, and the names.
pub(super) fn draw(panel: &Panel, area: &Area, scene: &Scene) -> Result<(), String> {
    let (chart, legend) = panel.axes(area, &scene.title)?;
    for robot in with_sensors(scene) {
        let mut sectors = robot.sectors.iter();
        sectors.try_for_each(|it| fill(&chart, &sector(robot, it), palette::SENSOR_AREA))?;
    }
    ground::draw(&chart, scene)?;
    for robot in &scene.robots {
        fill(&chart, &body(robot, &robot.pose), robot_color(robot))?;
        let front = robot.corners.iter().map(|corner| corner.x).reduce(f64::max).unwrap_or(robot.radius_m);
        let [center, ahead] = [0.0, front].map(|x| robot.pose * Point2::new(x, 0.0));
        let line = PathElement::new([(center.x, center.y), (ahead.x, ahead.y)], panel.line(WHITE, 4));
        chart.plotting_area().draw(&line).map_err(why)?;
    }
    if !is_crowded(scene) {
        names(&chart, scene)?;
    }
    panel.frame(&chart)?;
    panel.legend(&legend, &entries(scene))
}

/// The entries of the legend.
pub(super) fn entries(scene: &Scene) -> Vec<(Mark, String)> {
    let has = |is_driven: bool| scene.robots.iter().any(|robot| robot.is_driven == is_driven);
    let entries = [
        (has(true), palette::CURIOUS, "driven robot"),
        (has(false), palette::OTHER_ROBOT, "other robot"),
        (with_sensors(scene).next().is_some(), palette::SENSOR_AREA, "field of view"),
    ];
    let robots = entries.into_iter().filter(|entry| entry.0);
    let robots = robots.map(|(_, color, text)| (Mark::Area(color), text.to_owned()));
    ground::entries(scene).chain(robots).collect()
}

fn is_crowded(scene: &Scene) -> bool {
    scene.obstacles.len() + scene.robots.len() > MOST_NAMES
}

/// The robots whose sensors are drawn.
fn with_sensors(scene: &Scene) -> impl Iterator<Item = &Robot> {
    let is_shown = !is_crowded(scene);
    scene.robots.iter().filter(move |robot| is_shown && !robot.sectors.is_empty())
}

/// The outline of a robot at a pose.
pub(super) fn body(robot: &Robot, pose: &Isometry2<f64>) -> Vec<Point2<f64>> {
    if robot.corners.is_empty() {
        return arc(pose, robot.radius_m, TAU);
    }
    robot.corners.iter().map(|corner| pose * corner).collect()
}

/// The drawn part of what a sensor covers.
fn sector(robot: &Robot, sector: &Sector) -> Vec<Point2<f64>> {
    let mount = robot.pose * sector.mount;
    let mut corners = arc(&mount, sector.range_m.min(SECTOR_RADII * robot.radius_m), sector.angle_rad);
    if sector.angle_rad < TAU {
        corners.push(mount * Point2::origin());
    }
    corners
}

/// Points on a circle around a pose, half of the angle on either side of its direction.
fn arc(pose: &Isometry2<f64>, radius_m: f64, angle_rad: f64) -> Vec<Point2<f64>> {
    let point = |index: usize| {
        let angle = angle_rad * (index as f64 / CORNERS as f64 - 0.5);
        pose * Point2::new(radius_m * angle.cos(), radius_m * angle.sin())
    };
    (0..=CORNERS).map(point).collect()
}

/// Writes the names: in the middle of what is large enough, otherwise below.
fn names(chart: &Chart, scene: &Scene) -> Result<(), String> {
    let obstacles = scene.obstacles.iter().filter_map(|obstacle| {
        let outline = if obstacle.outline.is_empty() { obstacle.reach.first()? } else { &obstacle.outline };
        Some((obstacle.name.as_str(), outline.clone()))
    });
    let robots = scene.robots.iter().map(|robot| (robot.name.as_str(), body(robot, &robot.pose)));
    let plot = chart.plotting_area();
    for (name, outline) in obstacles.chain(robots) {
        let pixels: Vec<(i32, i32)> =
            outline.iter().map(|corner| plot.map_coordinate(&(corner.x, corner.y))).collect();
        let span = |values: Vec<i32>| {
            let (low, high) = (values.iter().min().copied(), values.iter().max().copied());
            (low.unwrap_or(0), high.unwrap_or(0))
        };
        let (left, right) = span(pixels.iter().map(|pixel| pixel.0).collect());
        let (top, bottom) = span(pixels.iter().map(|pixel| pixel.1).collect());
        let style = text(20).color(&INK);
        let (width, height) = plot.estimate_text_size(name, &style).map_err(why)?;
        let fits = right - left > width as i32 && bottom - top > height as i32;
        let y = if fits { (top + bottom) / 2 + px(5) } else { bottom + px(12) };
        let style = style.pos(Pos::new(HPos::Center, VPos::Center));
        let text = Text::new(name.to_owned(), ((left + right) / 2, y), style);
        plot.use_screen_coord().draw(&text).map_err(why)?;
    }
    Ok(())
}
