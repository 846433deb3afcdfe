//! A world from above, at its start.

use super::canvas::{Area, INK, ink, px, text, why};
use super::panel::{self, Chart};
use super::trajectory::WALL;
use crate::inspection::{Content, Robot, Thing};
use crate::layer::{CURIOUS, OTHERS, Rgb};
use nalgebra::Point2;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

const THING: Rgb = [214, 110, 20];
const REACH: Rgb = [250, 226, 198];
/// The corners of the polygon that a robot is drawn as.
const CORNERS: usize = 48;
/// More things than this are drawn without their names.
const MOST_NAMES: usize = 40;

/// Draws the walls, what moves with where it can get to, and the robots.
pub(super) fn draw(area: &Area, content: &Content) -> Result<(), String> {
    let plan = &content.plan;
    let (chart, legend) = panel::axes_in(area, &content.name, &plan.frame, plan.unit)?;
    let fill = |corners: &[Point2<f64>], colour: Rgb| {
        let corners: Vec<(f64, f64)> = corners.iter().map(|corner| (corner.x, corner.y)).collect();
        chart.plotting_area().draw(&Polygon::new(corners, ink(colour).filled())).map_err(why)
    };
    for reach in plan.things.iter().flat_map(|thing| &thing.reach) {
        fill(reach, REACH)?;
    }
    for wall in &plan.walls {
        fill(wall, WALL)?;
    }
    for thing in plan.things.iter().filter(|thing| !thing.outline.is_empty()) {
        fill(&thing.outline, THING)?;
    }
    for robot in &plan.robots {
        fill(&circle(robot), colour(robot))?;
        let ahead = robot.pose * Point2::new(robot.radius, 0.0);
        let middle = robot.pose * Point2::origin();
        let line = PathElement::new(
            vec![(middle.x, middle.y), (ahead.x, ahead.y)],
            WHITE.stroke_width(px(2) as u32),
        );
        chart.plotting_area().draw(&line).map_err(why)?;
    }
    if plan.things.len() + plan.robots.len() <= MOST_NAMES {
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
    ];
    let mut top = px(13);
    for (_, colour, meaning) in lines.into_iter().filter(|(is_there, _, _)| *is_there) {
        panel::swatch(&legend, top, colour, meaning)?;
        top += px(26);
    }
    Ok(())
}

fn colour(robot: &Robot) -> Rgb {
    if robot.is_driven { CURIOUS } else { OTHERS }
}

fn circle(robot: &Robot) -> Vec<Point2<f64>> {
    let corner = |number: usize| {
        let angle = number as f64 / CORNERS as f64 * std::f64::consts::TAU;
        robot.pose * Point2::new(robot.radius * angle.cos(), robot.radius * angle.sin())
    };
    (0..CORNERS).map(corner).collect()
}

/// Writes the names below what they belong to.
fn names(chart: &Chart, things: &[Thing], robots: &[Robot]) -> Result<(), String> {
    let lowest = |corners: &[Point2<f64>]| {
        let middle = corners.iter().map(|corner| corner.x).sum::<f64>() / corners.len() as f64;
        let bottom = corners.iter().map(|corner| corner.y).fold(f64::INFINITY, f64::min);
        (middle, bottom)
    };
    let of_things = things.iter().filter_map(|thing| {
        let corners = if thing.outline.is_empty() { thing.reach.first()? } else { &thing.outline };
        Some((thing.name.clone(), lowest(corners)))
    });
    let of_robots = robots.iter().map(|robot| (robot.name.clone(), lowest(&circle(robot))));
    let plot = chart.plotting_area();
    for (name, at) in of_things.chain(of_robots) {
        let style = text(12).pos(Pos::new(HPos::Center, VPos::Top)).color(&INK);
        let name = EmptyElement::at(at) + Text::new(name, (0, px(2)), style);
        plot.draw(&name).map_err(why)?;
    }
    Ok(())
}
