//! The trajectories of the robots, as the paper's Figure 4.

use crate::canvas::{Area, Drawn, ink, why};
use crate::layers::Layer;
use crate::legend::{Legend, Mark};
use crate::palette::{self, Rgb};
use crate::panel::{Chart, Panel, pair};
use crate::plan;
use crate::scene::{Scene, extent};
use crate::view::Trail;
use mapper::Mapper;
use nalgebra::Point2;
use plotters::prelude::*;
use results::thinned::Goals;

/// The trails of the robots.
#[derive(Clone, Copy)]
pub struct Trails<'a> {
    /// Where the robots were, in the order of the scene.
    pub true_poses: &'a [Trail],
    /// Where the curious robot believed to be; empty if its poses are exact.
    pub believed: &'a Trail,
}

/// Draws the scene, every trail with its start, and the goals. Below the scene is the map, where there is one.
pub(crate) fn draw(
    panel: &Panel,
    area: &Area,
    (scene, map): (&Scene, Option<&Mapper>),
    trails: &Trails,
    goals: &Goals,
) -> Drawn {
    let (chart, legend) = panel.axes(area, &format!("Trajectories in {}", scene.title))?;
    if let Some(map) = map {
        panel.cells(&chart, Layer::Occupancy, &Layer::Occupancy.classes(map))?;
    }
    plan::ground(&chart, scene)?;
    // The other robots' trails on top: the curious robot goes everywhere.
    let mut drawn: Vec<_> = scene.robots.iter().zip(trails.true_poses).collect();
    drawn.sort_by_key(|(robot, _)| !robot.is_driven);
    drawn.iter().try_for_each(|(robot, trail)| line(panel, &chart, trail.points(), (robot.color(), 3)))?;
    // Thin and on top, so that the true trail is seen on both sides. A robot that is off by meters leaves the picture.
    let (low, size) = extent(&scene.frame);
    let is_inside = |at: &Point2<f64>| at >= &low && at <= &(low + size);
    let believed = trails.believed.points();
    for step in believed.windows(2).filter(|step| step.iter().all(is_inside)) {
        line(panel, &chart, step, (palette::ESTIMATE, 1))?;
    }
    let plot = chart.plotting_area();
    for goal in goals.samples() {
        let cross = Cross::new(pair(goal), panel.px(3), panel.line(ink(palette::GOAL), 2));
        plot.draw(&cross).map_err(why)?;
    }
    for (robot, trail) in drawn {
        if let Some(first) = trail.points().first() {
            let at = plot.map_coordinate(&pair(first));
            panel.pen.dot(&plot.use_screen_coord(), at, robot.color())?;
        }
    }
    panel.frame(&chart)?;
    panel.legend(&legend, &entries(scene, trails.believed, goals))
}

/// The entries of the legend.
pub(crate) fn entries(scene: &Scene, believed: &Trail, goals: &Goals) -> Legend {
    let name = |is_driven: bool| {
        let robots = || scene.robots.iter().filter(|robot| robot.is_driven == is_driven);
        let first = robots().next()?;
        let name = match robots().count() {
            1 => first.name.clone(),
            several => format!("{several} other robots"),
        };
        Some((Mark::Line(first.color()), name))
    };
    let mut entries: Legend = [true, false].into_iter().filter_map(name).collect();
    if !believed.points().is_empty() {
        entries.push((Mark::Line(palette::ESTIMATE), "where it believed to be".into()));
    }
    entries.push((Mark::Dot(palette::CURIOUS), "start".into()));
    let (shown, all) = (goals.samples().len(), goals.count());
    if all > 0 {
        let of_all = if shown as u64 == all { String::new() } else { format!(" of {all}") };
        entries.push((Mark::Cross(palette::GOAL), format!("{shown}{of_all} goals chosen")));
    }
    entries.extend(plan::ground_entries(scene));
    entries
}

/// Draws a line step by step: the library's thick lines break where a line turns back on itself.
pub(crate) fn line(
    panel: &Panel,
    chart: &Chart<impl DrawingBackend>,
    points: &[Point2<f64>],
    (color, width): (Rgb, u32),
) -> Drawn {
    let style = panel.line(ink(color), width);
    points.windows(2).try_for_each(|step| {
        let step = PathElement::new(step.iter().map(pair).collect::<Vec<_>>(), style);
        chart.plotting_area().draw(&step).map_err(why)
    })
}
