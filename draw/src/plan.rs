//! A world from above, at its start.

use crate::canvas::{ink, why};
use crate::ground::{self, fill};
use crate::legend::{self, Legend, Mark};
use crate::palette;
use crate::panel::{Chart, Panel, pair};
use crate::pen::Sheet;
use crate::scene::{Scene, SceneRobot, Sector, span};
use nalgebra::{Isometry2, Point2};
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;
use std::f64::consts::TAU;

/// The corners of the polygon that a circle is drawn as.
const CORNERS: usize = 48;
/// In a scene with more obstacles and robots than this, names and sensors are not drawn.
const MAX_NAMES: usize = 40;
/// The drawn part of the range of a sensor, as a multiple of the robot's radius: all of it would cover the
/// world.
const SECTOR_RADII: f64 = 2.5;

/// A line on a map with a name beside it, as the leaf of a door.
#[derive(Clone, Debug)]
pub struct NamedLine {
    /// Its ends, m.
    pub ends: [Point2<f64>; 2],
    /// The name.
    pub name: String,
}

/// Draws the scene, the robots with the directions of their sensors, and the names.
pub(crate) fn draw(panel: &Panel, area: &Sheet<impl DrawingBackend>, scene: &Scene) -> Result<(), String> {
    let (chart, legend) = panel.axes(area, &scene.title)?;
    for robot in with_sensors(scene) {
        let mut sectors = robot.sectors.iter();
        sectors.try_for_each(|it| fill(&chart, &sector(robot, it), palette::SENSOR_AREA))?;
    }
    ground::draw(&chart, scene)?;
    for robot in &scene.robots {
        let front = robot.corners.iter().map(|corner| corner.x).reduce(f64::max).unwrap_or(robot.radius_m);
        draw_robot(panel, &chart, robot, &robot.pose, front)?;
    }
    if !is_crowded(scene) {
        names(panel, &chart, scene)?;
    }
    panel.frame(&chart)?;
    panel.legend(&legend, &entries(scene))
}

/// Draws the body of a robot at a pose, with a line from its center to its front, m.
pub(crate) fn draw_robot(
    panel: &Panel,
    chart: &Chart<impl DrawingBackend>,
    robot: &SceneRobot,
    pose: &Isometry2<f64>,
    front_m: f64,
) -> Result<(), String> {
    fill(chart, &body(robot, pose), robot.color())?;
    let ends = [0.0, front_m].map(|x| pair(&(pose * Point2::new(x, 0.0))));
    chart.plotting_area().draw(&PathElement::new(ends, panel.line(WHITE, 3))).map_err(why)
}

/// The entries of the legend.
pub(crate) fn entries(scene: &Scene) -> Legend {
    let robots = legend::entries([
        (scene.has_robot(true), Mark::Area(palette::CURIOUS), "driven robot"),
        (scene.has_robot(false), Mark::Area(palette::OTHER_ROBOT), "other robot"),
        (with_sensors(scene).next().is_some(), Mark::Area(palette::SENSOR_AREA), "field of view (not range)"),
    ]);
    [ground::entries(scene), robots].concat()
}

fn is_crowded(scene: &Scene) -> bool {
    scene.obstacles.len() + scene.robots.len() > MAX_NAMES
}

/// The robots whose sensors are drawn.
fn with_sensors(scene: &Scene) -> impl Iterator<Item = &SceneRobot> {
    let is_shown = !is_crowded(scene);
    scene.robots.iter().filter(move |robot| is_shown && !scene.is_grid && !robot.sectors.is_empty())
}

/// The outline of a robot at a pose.
fn body(robot: &SceneRobot, pose: &Isometry2<f64>) -> Vec<Point2<f64>> {
    if robot.corners.is_empty() {
        return arc(pose, robot.radius_m, TAU);
    }
    robot.corners.iter().map(|corner| pose * corner).collect()
}

/// The drawn part of what a sensor covers.
fn sector(robot: &SceneRobot, sector: &Sector) -> Vec<Point2<f64>> {
    let mount = robot.pose * sector.mount;
    let mut corners = arc(&mount, sector.range_m.min(SECTOR_RADII * robot.radius_m), sector.angle_rad);
    if sector.angle_rad < TAU {
        corners.push(mount * Point2::origin());
    }
    corners
}

/// Points on a circle around a pose, half of the angle on either side of its direction.
pub(crate) fn arc(pose: &Isometry2<f64>, radius_m: f64, angle_rad: f64) -> Vec<Point2<f64>> {
    let point = |index: usize| {
        let angle = angle_rad * (index as f64 / CORNERS as f64 - 0.5);
        pose * Point2::new(radius_m * angle.cos(), radius_m * angle.sin())
    };
    (0..=CORNERS).map(point).collect()
}

/// Writes the names: that of an obstacle in its middle if there is room, every other name below its owner.
fn names(panel: &Panel, chart: &Chart<impl DrawingBackend>, scene: &Scene) -> Result<(), String> {
    for obstacle in &scene.obstacles {
        let outline =
            if obstacle.outline.is_empty() { obstacle.reach.first() } else { Some(&obstacle.outline) };
        outline.map_or(Ok(()), |outline| write_name(panel, chart, &obstacle.name, span(outline), true))?;
    }
    let mut robots = scene.robots.iter();
    robots.try_for_each(|robot| write_name(panel, chart, &robot.name, span(&body(robot, &robot.pose)), false))
}

/// Draws named lines, as the leaves of doors, with the names below their middles.
pub(crate) fn lines(
    panel: &Panel,
    chart: &Chart<impl DrawingBackend>,
    lines: &[NamedLine],
) -> Result<(), String> {
    for NamedLine { ends, name } in lines {
        let style = panel.line(ink(palette::CURIOUS), 5);
        let line = PathElement::new(ends.map(|end| pair(&end)), style);
        chart.plotting_area().draw(&line).map_err(why)?;
        write_name(panel, chart, name, [nalgebra::center(&ends[0], &ends[1]); 2], false)?;
    }
    Ok(())
}

/// Writes a name below the rectangle of its owner, m; at the lower border of the map above it. `may_cover`: in the rectangle, if
/// there is room.
fn write_name(
    panel: &Panel,
    chart: &Chart<impl DrawingBackend>,
    name: &str,
    [low, high]: [Point2<f64>; 2],
    may_cover: bool,
) -> Result<(), String> {
    let plot = chart.plotting_area();
    let (pixels, gap) = (plot.use_screen_coord(), panel.px(3));
    let [width, height] = panel.text_size(&pixels, name)?;
    let ((left, bottom), (right, top)) =
        (plot.map_coordinate(&pair(&low)), plot.map_coordinate(&pair(&high)));
    let (x, below) = ((left + right) / 2, bottom + gap + height / 2);
    // A name may be a little wider than its obstacle.
    if may_cover && 5 * (right - left) > 4 * width && bottom - top > height {
        return panel.write(&pixels, (x, (top + bottom) / 2), HPos::Center, name);
    }
    let has_room_below = below + height / 2 <= plot.get_pixel_range().1.end;
    let y = if has_room_below { below } else { top - gap - height / 2 };
    // A light ground, because there may be a wall.
    let corners = [(x - width / 2, y - height / 2), (x + width / 2, y + height / 2)];
    pixels.draw(&Rectangle::new(corners, WHITE.mix(0.75).filled())).map_err(why)?;
    panel.write(&pixels, (x, y), HPos::Center, name)
}
