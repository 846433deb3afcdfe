//! A world from above, at its start.

use super::panel::{self, Chart};
use super::trajectory::WALL;
use crate::layer::{CURIOUS, OTHERS, Rgb};
use evaluation::drawing::{Area, INK, ink, px, text, why};
use interfaces::GridFrame;
use nalgebra::{Isometry2, Point2};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::f64::consts::TAU;

const THING: Rgb = [214, 110, 20];
const REACH: Rgb = [250, 226, 198];
const VIEW: Rgb = [222, 235, 222];
/// The sides of the polygon that a circle is drawn as.
const CORNERS: usize = 48;
/// More things than this are drawn without their names, and without what they look around with.
const MOST_NAMES: usize = 40;
/// How far views are drawn, as a multiple of the robot's radius: whole ones would cover the house.
const VIEW_RADII: f64 = 2.5;

/// A world from above, at its start.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What lengths are counted in.
    pub unit: &'static str,
    /// The rectangle that is drawn.
    pub frame: GridFrame,
    /// Corners of what stands for good.
    pub walls: Vec<Vec<Point2<f64>>>,
    /// What can move, come or go.
    pub things: Vec<PlanThing>,
    /// Who lives there.
    pub robots: Vec<PlanRobot>,
}

/// Something that is no wall and no robot.
#[derive(Clone, Debug)]
pub struct PlanThing {
    /// What it is called.
    pub name: String,
    /// Where it is at the start; empty if it is not there yet.
    pub outline: Vec<Point2<f64>>,
    /// Where it can get to, as far as that is known beforehand.
    pub reach: Vec<Vec<Point2<f64>>>,
}

/// A robot at its start.
#[derive(Clone, Debug)]
pub struct PlanRobot {
    /// What it is called.
    pub name: String,
    /// Where it stands.
    pub pose: Isometry2<f64>,
    /// The radius of the circle about it.
    pub radius: f64,
    /// The corners of its body, in its own frame; none: it is that circle.
    pub corners: Vec<Point2<f64>>,
    /// What it looks around with.
    pub views: Vec<SensorView>,
    /// Whether it obeys commands.
    pub is_driven: bool,
}

/// Where a laser or a sonar looks.
#[derive(Clone, Copy, Debug)]
pub struct SensorView {
    /// Where it is mounted, in the frame of the robot.
    pub mount: Isometry2<f64>,
    /// The angle that it takes in, about its direction, rad.
    pub angle_rad: f64,
    /// How far it reaches.
    pub range: f64,
}

/// Draws the walls, what moves with where it can get to, and the robots with where they look.
pub(super) fn draw(area: &Area, name: &str, plan: &Plan) -> Result<(), String> {
    let (chart, legend) = panel::axes_in(area, name, &plan.frame, plan.unit)?;
    let fill = |corners: &[Point2<f64>], colour: Rgb| {
        let corners: Vec<(f64, f64)> = corners.iter().map(|corner| (corner.x, corner.y)).collect();
        chart.plotting_area().draw(&Polygon::new(corners, ink(colour).filled())).map_err(why)
    };
    for reach in plan.things.iter().flat_map(|thing| &thing.reach) {
        fill(reach, REACH)?;
    }
    let is_crowded = plan.things.len() + plan.robots.len() > MOST_NAMES;
    let watchful = plan.robots.iter().filter(|robot| !is_crowded && !robot.views.is_empty());
    for robot in watchful.clone() {
        robot.views.iter().try_for_each(|view| fill(&sector(robot, view), VIEW))?;
    }
    for wall in &plan.walls {
        fill(wall, WALL)?;
    }
    for thing in plan.things.iter().filter(|thing| !thing.outline.is_empty()) {
        fill(&thing.outline, THING)?;
    }
    for robot in &plan.robots {
        fill(&body(robot), colour(robot))?;
        let front = robot.corners.iter().map(|corner| corner.x).reduce(f64::max).unwrap_or(robot.radius);
        let ahead = robot.pose * Point2::new(front, 0.0);
        let middle = robot.pose * Point2::origin();
        let line = PathElement::new(
            vec![(middle.x, middle.y), (ahead.x, ahead.y)],
            WHITE.stroke_width(px(2) as u32),
        );
        chart.plotting_area().draw(&line).map_err(why)?;
    }
    if !is_crowded {
        names(&chart, &plan.things, &plan.robots)?;
    }
    panel::frame(&chart, &plan.frame)?;

    let is = |is_driven: bool| plan.robots.iter().any(|robot| robot.is_driven == is_driven);
    let lines = [
        (true, WALL, "wall"),
        (!plan.things.is_empty(), THING, "thing"),
        (plan.things.iter().any(|thing| !thing.reach.is_empty()), REACH, "its way"),
        (is(true), CURIOUS, "driven robot"),
        (is(false), OTHERS, "other robot"),
        (watchful.count() > 0, VIEW, "where it looks"),
    ];
    let mut top = px(13);
    for (_, colour, meaning) in lines.into_iter().filter(|(is_there, _, _)| *is_there) {
        panel::swatch(&legend, top, colour, meaning)?;
        top += px(26);
    }
    Ok(())
}

fn colour(robot: &PlanRobot) -> Rgb {
    if robot.is_driven { CURIOUS } else { OTHERS }
}

fn body(robot: &PlanRobot) -> Vec<Point2<f64>> {
    if robot.corners.is_empty() {
        return arc(&robot.pose, robot.radius, TAU);
    }
    robot.corners.iter().map(|corner| robot.pose * corner).collect()
}

/// What of a view is drawn.
fn sector(robot: &PlanRobot, view: &SensorView) -> Vec<Point2<f64>> {
    let mount = robot.pose * view.mount;
    let mut corners = arc(&mount, view.range.min(VIEW_RADII * robot.radius), view.angle_rad);
    if view.angle_rad < TAU {
        corners.push(mount * Point2::origin());
    }
    corners
}

/// Points on a circle about a middle, over an angle about its direction.
fn arc(middle: &Isometry2<f64>, radius: f64, angle_rad: f64) -> Vec<Point2<f64>> {
    let point = |number: usize| {
        let angle = angle_rad * (number as f64 / CORNERS as f64 - 0.5);
        middle * Point2::new(radius * angle.cos(), radius * angle.sin())
    };
    (0..=CORNERS).map(point).collect()
}

/// Writes the names below what they belong to.
fn names(chart: &Chart, things: &[PlanThing], robots: &[PlanRobot]) -> Result<(), String> {
    let lowest = |corners: &[Point2<f64>]| {
        let middle = corners.iter().map(|corner| corner.x).sum::<f64>() / corners.len() as f64;
        let bottom = corners.iter().map(|corner| corner.y).fold(f64::INFINITY, f64::min);
        (middle, bottom)
    };
    let of_things = things.iter().filter_map(|thing| {
        let corners = if thing.outline.is_empty() { thing.reach.first()? } else { &thing.outline };
        Some((thing.name.clone(), lowest(corners)))
    });
    let of_robots = robots.iter().map(|robot| (robot.name.clone(), lowest(&body(robot))));
    let plot = chart.plotting_area();
    for (name, at) in of_things.chain(of_robots) {
        let style = text(12).pos(Pos::new(HPos::Center, VPos::Top)).color(&INK);
        let name = EmptyElement::at(at) + Text::new(name, (0, px(2)), style);
        plot.draw(&name).map_err(why)?;
    }
    Ok(())
}
