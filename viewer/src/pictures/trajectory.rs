//! The trajectories of the robots, as the paper's Figure 4.

use super::ground;
use super::panel::{Chart, Panel, pair};
use crate::legend::{Legend, Mark};
use crate::scene::Scene;
use crate::view::Trail;
use evaluation::drawing::{Area, ink, why};
use evaluation::observer::Goals;
use evaluation::palette::{self, Rgb};
use nalgebra::Point2;
use plotters::prelude::*;

/// Draws the scene, every trail with its start, and the goals.
pub(super) fn draw(
    panel: &Panel,
    area: &Area,
    scene: &Scene,
    trails: &[Trail],
    goals: &Goals,
) -> Result<(), String> {
    let (chart, legend) = panel.axes(area, &format!("Trajectories in {}", scene.title))?;
    ground::draw(&chart, scene)?;
    // The other robots' trails on top: the curious robot goes everywhere.
    let mut drawn: Vec<_> = scene.robots.iter().zip(trails).collect();
    drawn.sort_by_key(|(robot, _)| !robot.is_driven);
    drawn.iter().try_for_each(|(robot, trail)| line(panel, &chart, trail.points(), robot.color()))?;
    let plot = chart.plotting_area();
    for goal in goals.samples() {
        let cross = Cross::new(pair(goal), panel.px(3), panel.line(ink(palette::GOAL), 2));
        plot.draw(&cross).map_err(why)?;
    }
    for (robot, trail) in scene.robots.iter().zip(trails) {
        if let Some(first) = trail.points().first() {
            let at = plot.map_coordinate(&pair(first));
            panel.dot(&plot.use_screen_coord(), at, robot.color())?;
        }
    }
    panel.frame(&chart)?;
    panel.legend(&legend, &entries(scene, goals))
}

/// The entries of the legend.
pub(super) fn entries(scene: &Scene, goals: &Goals) -> Legend {
    let robots = scene.robots.iter().map(|robot| (Mark::Line(robot.color()), robot.name.clone()));
    let mut entries: Legend = robots.collect();
    entries.push((Mark::Dot(palette::CURIOUS), "start".into()));
    let (shown, all) = (goals.samples().len(), goals.count());
    if all > 0 {
        let of_all = if shown as u64 == all { String::new() } else { format!(" of {all}") };
        entries.push((Mark::Cross(palette::GOAL), format!("{shown}{of_all} goals")));
    }
    entries.extend(ground::entries(scene));
    entries
}

/// Draws a line step by step: the library's thick lines break where a line turns back on itself.
pub(super) fn line(panel: &Panel, chart: &Chart, points: &[Point2<f64>], color: Rgb) -> Result<(), String> {
    let style = panel.line(ink(color), 3);
    points.windows(2).try_for_each(|step| {
        let step = PathElement::new(step.iter().map(pair).collect::<Vec<_>>(), style);
        chart.plotting_area().draw(&step).map_err(why)
    })
}
