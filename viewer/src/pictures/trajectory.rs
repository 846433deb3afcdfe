//! Where the robots have been, as the paper's Figure 4.

use super::Pictures;
use super::panel::{self, Chart};
use crate::layer::{CURIOUS, OTHERS, Rgb};
use crate::view::Trail;
use evaluation::drawing::{Area, ink, px, why};
use nalgebra::Point2;
use plotters::prelude::*;

pub(super) const WALL: Rgb = [70, 74, 82];
const GOAL: Rgb = [214, 30, 60];

/// Draws the walls, every trail with its start, and the goals.
pub(super) fn draw(area: &Area, pictures: &Pictures) -> Result<(), String> {
    let map = pictures.mapper.frame();
    let title = format!("Trajectories in {}", pictures.scene.title);
    let (chart, legend) = panel::axes(area, &title, map)?;
    let plot = chart.plotting_area();
    for wall in &pictures.scene.walls {
        let corners: Vec<(f64, f64)> = wall.iter().map(pair).collect();
        plot.draw(&Polygon::new(corners, ink(WALL).filled())).map_err(why)?;
    }
    // The others' on top: the curious robot goes everywhere.
    let curious = pictures.trails.iter().filter(|trail| trail.is_curious).map(|trail| (trail, CURIOUS));
    let others = pictures.trails.iter().filter(|trail| !trail.is_curious).map(|trail| (trail, OTHERS));
    let trails: Vec<(&Trail, Rgb)> = curious.chain(others).collect();
    for (trail, colour) in &trails {
        line(&chart, trail, *colour)?;
    }
    for goal in pictures.goals {
        plot.draw(&Cross::new(pair(goal), px(4), ink(GOAL).stroke_width(px(1) as u32))).map_err(why)?;
    }
    for (trail, colour) in &trails {
        start(&chart, trail, *colour)?;
    }
    panel::frame(&chart, map)?;

    let mut lines: Vec<(Rgb, String)> =
        trails.iter().map(|(trail, colour)| (*colour, trail.name.clone())).collect();
    if !pictures.goals.is_empty() {
        lines.push((GOAL, format!("{} goals", pictures.goals.len())));
    }
    lines.push((WALL, "wall".into()));
    let mut top = px(13);
    for (colour, meaning) in &lines {
        panel::swatch(&legend, top, *colour, meaning)?;
        top += px(26);
    }
    let at = (px(26), top + px(8));
    dot(&legend, at, CURIOUS)?;
    panel::write(&legend, (at.0 + px(16), at.1), "start")
}

fn line(chart: &Chart, trail: &Trail, colour: Rgb) -> Result<(), String> {
    let style = ink(colour).stroke_width(px(2) as u32);
    // Step by step: the library's thick lines break where a line turns back on itself.
    trail.points().windows(2).try_for_each(|step| {
        let step = PathElement::new(step.iter().map(pair).collect::<Vec<_>>(), style);
        chart.plotting_area().draw(&step).map_err(why)
    })
}

/// Draws where a robot started.
fn start(chart: &Chart, trail: &Trail, colour: Rgb) -> Result<(), String> {
    let Some(first) = trail.points().first() else { return Ok(()) };
    let plot = chart.plotting_area();
    dot(&plot.use_screen_coord(), plot.map_coordinate(&pair(first)), colour)
}

/// Draws a filled circle with a white rim; `at` in pixels of `area`.
fn dot(area: &Area, at: (i32, i32), colour: Rgb) -> Result<(), String> {
    area.draw(&Circle::new(at, px(9), WHITE.filled())).map_err(why)?;
    area.draw(&Circle::new(at, px(7), ink(colour).filled())).map_err(why)
}

fn pair(point: &Point2<f64>) -> (f64, f64) {
    (point.x, point.y)
}
