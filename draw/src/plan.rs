//! A world from above, at its start.

use crate::canvas::{Drawn, ink, why};
use crate::legend::{self, Legend, Mark};
use crate::palette::{self, Rgb};
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
pub(crate) fn draw(panel: &Panel, area: &Sheet<impl DrawingBackend>, scene: &Scene) -> Drawn {
    let (chart, legend) = panel.axes(area, &scene.title)?;
    for robot in with_sensors(scene) {
        let mut sectors = robot.sectors.iter();
        sectors.try_for_each(|it| fill(&chart, &sector(robot, it), palette::SENSOR_AREA))?;
    }
    ground(&chart, scene)?;
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
) -> Drawn {
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
    [ground_entries(scene), robots].concat()
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

/// Writes the names: that of an obstacle in its middle if there is room, every other name beside its owner.
fn names(panel: &Panel, chart: &Chart<impl DrawingBackend>, scene: &Scene) -> Drawn {
    let obstacles = scene.obstacles.iter().filter_map(|obstacle| {
        let outline = if obstacle.outline.is_empty() { obstacle.reach.first()? } else { &obstacle.outline };
        Some((&obstacle.name, outline.clone(), true))
    });
    let robots = scene.robots.iter().map(|robot| (&robot.name, body(robot, &robot.pose), false));
    let plot = chart.plotting_area();
    let pixels = plot.use_screen_coord();
    let (mut beside, mut taken) = (Vec::new(), Vec::new());
    for (name, outline, is_light) in obstacles.chain(robots) {
        let [low, high] = span(&outline).map(|corner| plot.map_coordinate(&pair(&corner)));
        let owner = Plate { left: low.0, right: high.0, top: high.1, bottom: low.1 };
        let size = panel.text_size(&pixels, name)?;
        // A name may be a little wider than its obstacle.
        let has_room = is_light && 5 * owner.width() > 4 * size[0] && owner.height() > size[1];
        if has_room {
            panel.write(&pixels, owner.center(), HPos::Center, name)?;
            taken.push(Plate::around(owner.center(), size));
        } else {
            beside.push((name, owner, size));
        }
        if !is_light {
            taken.push(owner);
        }
    }
    write_beside(panel, chart, beside, taken)
}

/// Draws named lines, as the leaves of doors, with the names beside their middles.
pub(crate) fn lines(panel: &Panel, chart: &Chart<impl DrawingBackend>, lines: &[NamedLine]) -> Drawn {
    let plot = chart.plotting_area();
    let mut names = Vec::new();
    for NamedLine { ends, name } in lines {
        let style = panel.line(ink(palette::CURIOUS), 5);
        plot.draw(&PathElement::new(ends.map(|end| pair(&end)), style)).map_err(why)?;
        let middle = plot.map_coordinate(&pair(&nalgebra::center(&ends[0], &ends[1])));
        let size = panel.text_size(&plot.use_screen_coord(), name)?;
        names.push((name, Plate::around(middle, [panel.px(4); 2]), size));
    }
    write_beside(panel, chart, names, Vec::new())
}

/// Writes names of a size beside their owners, where nothing is `taken`.
fn write_beside(
    panel: &Panel,
    chart: &Chart<impl DrawingBackend>,
    names: Vec<(&String, Plate, [i32; 2])>,
    mut taken: Vec<Plate>,
) -> Drawn {
    let plot = chart.plotting_area();
    let ((columns, rows), pixels) = (plot.get_pixel_range(), plot.use_screen_coord());
    let area = Plate { left: columns.start, right: columns.end, top: rows.start, bottom: rows.end };
    for (name, owner, size) in names {
        let plate = owner.place_beside(size, panel.px(2), &area, &taken);
        // A light ground, because there may be a wall.
        let corners = [(plate.left, plate.top), (plate.right, plate.bottom)];
        pixels.draw(&Rectangle::new(corners, WHITE.mix(0.75).filled())).map_err(why)?;
        panel.write(&pixels, plate.center(), HPos::Center, name)?;
        taken.push(plate);
    }
    Ok(())
}

/// A rectangle of pixels; rows count from the top.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Plate {
    left: i32,
    right: i32,
    top: i32,
    bottom: i32,
}

impl Plate {
    /// The rectangle around `center` of a width and a height.
    fn around((x, y): (i32, i32), [width, height]: [i32; 2]) -> Self {
        let (left, top) = (x - width / 2, y - height / 2);
        Self { left, right: left + width, top, bottom: top + height }
    }

    fn width(&self) -> i32 {
        self.right - self.left
    }

    fn height(&self) -> i32 {
        self.bottom - self.top
    }

    fn center(&self) -> (i32, i32) {
        ((self.left + self.right) / 2, (self.top + self.bottom) / 2)
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn contains(&self, other: &Self) -> bool {
        self.left <= other.left
            && other.right <= self.right
            && self.top <= other.top
            && other.bottom <= self.bottom
    }

    /// A rectangle of `size` beside this one with a `gap`: below, above, at the right or at the left, the first that
    /// is inside `area` and overlaps nothing that is `taken`; below if there is none.
    fn place_beside(&self, size: [i32; 2], gap: i32, area: &Self, taken: &[Self]) -> Self {
        let ((x, y), [width, height]) = (self.center(), size);
        let below = Self::around((x, self.bottom + gap + height / 2), size);
        let others = [
            (x, self.top - gap - height / 2),
            (self.right + gap + width / 2, y),
            (self.left - gap - width / 2, y),
        ];
        let is_free = |plate: &Self| area.contains(plate) && !taken.iter().any(|other| plate.overlaps(other));
        let places = others.map(|center| Self::around(center, size));
        [below].into_iter().chain(places).find(is_free).unwrap_or(below)
    }
}

// The parts of a scene that every picture shows: walls, furniture, and what moves with the area it sweeps.

/// Draws everything except the robots.
pub(crate) fn ground(chart: &Chart<impl DrawingBackend>, scene: &Scene) -> Drawn {
    let swept = scene.obstacles.iter().flat_map(|obstacle| &obstacle.reach);
    swept.into_iter().try_for_each(|outline| fill(chart, outline, palette::SWEPT))?;
    scene.walls.iter().try_for_each(|wall| fill(chart, wall, palette::WALL))?;
    let present = scene.obstacles.iter().filter(|obstacle| !obstacle.outline.is_empty());
    present.into_iter().try_for_each(|obstacle| fill(chart, &obstacle.outline, obstacle.color()))
}

/// The entries of the legend for what [`ground`] draws.
pub(crate) fn ground_entries(scene: &Scene) -> Legend {
    let has_moving = scene.has_obstacle(false);
    legend::entries([
        (!scene.walls.is_empty(), Mark::Area(palette::WALL), "wall"),
        (scene.has_obstacle(true), Mark::Area(palette::FURNITURE), "furniture"),
        (has_moving, Mark::Area(palette::MOVING), "what moves"),
        (has_moving, Mark::Area(palette::SWEPT), "area it sweeps"),
    ])
}

/// Fills a polygon.
pub(crate) fn fill(chart: &Chart<impl DrawingBackend>, corners: &[Point2<f64>], color: Rgb) -> Drawn {
    let corners: Vec<(f64, f64)> = corners.iter().map(pair).collect();
    chart.plotting_area().draw(&Polygon::new(corners, ink(color).filled())).map_err(why)
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Plate = Plate { left: 0, right: 100, top: 0, bottom: 100 };

    #[test]
    fn names_give_way_to_each_other_and_to_the_border() {
        let owner = Plate::around((50, 50), [10, 10]);
        let mut taken = Vec::new();
        let centers = [(); 5].map(|()| {
            let plate = owner.place_beside([20, 10], 2, &AREA, &taken);
            taken.push(plate);
            plate.center()
        });
        // Below, above, right, left; then below again.
        assert_eq!(centers, [(50, 62), (50, 38), (67, 50), (33, 50), (50, 62)]);
        let at_the_bottom = Plate::around((50, 92), [10, 10]);
        assert_eq!(at_the_bottom.place_beside([20, 10], 2, &AREA, &[]).center(), (50, 80));
    }
}
