//! Pictures of a run and of a world: the panels of the paper's Figure 5, the trajectories of its Figure 4, a
//! plan, and a moving picture.

pub use crate::plan::NamedLine;
pub use crate::trajectory::Trails;

use crate::canvas::{Area, Canvas, Drawn, PictureError};
use crate::layers::Layer;
use crate::panel::Panel;
use crate::pen::{Pen, Sheet};
use crate::scene::{Scene, extent};
use crate::{palette, plan, trajectory};
use interfaces::Grid;
use mapper::Mapper;
use nalgebra::{Point2, Translation2};
use plotters::prelude::DrawingBackend;
use results::thinned::Goals;
use std::f64::consts::TAU;
use std::path::Path;

/// The panels of Figure 5, in its order.
const FIGURE_5: [Layer; 3] = [Layer::Occupancy, Layer::Interval, Layer::ChangeProbability];

/// The name of the file with the panels of Figure 5.
pub const FIGURE_5_FILE: &str = "figure5.png";

/// Writes each of `layers` of the map as `<layer>.png`, the predicted maps side by side as `predicted.png`, `figure5.png` if its
/// layers are among them, and `trajectory.png` into `folder`, which is created if needed. `goals` are those of the curious robot.
///
/// # Errors
///
/// When a picture cannot be drawn or written.
pub fn write_all(
    folder: &Path,
    scene: &Scene,
    mapper: &Mapper,
    trails: &Trails,
    goals: &Goals,
    layers: &[Layer],
) -> Result<(), PictureError> {
    let file = |name: &str| folder.join(format!("{name}.png"));
    let panel = Panel::of_layer(mapper.frame());
    let mut panels = Vec::new();
    for &layer in layers {
        let picture = draw(layer.name(), panel.size(), |area| panel.layer(area, mapper, layer).map(drop))?;
        if !Layer::PREDICTED.contains(&layer) {
            picture.write(&file(layer.name()))?;
        }
        panels.push((layer, picture));
    }
    let of_layer = |layer: &Layer| panels.iter().find(|(of, _)| of == layer).map(|(_, picture)| picture);
    for (name, layers) in [(FIGURE_5_FILE, &FIGURE_5[..]), ("predicted.png", &Layer::PREDICTED)] {
        let beside: Vec<&Canvas> = layers.iter().filter_map(of_layer).collect();
        if beside.len() == layers.len() {
            Canvas::beside(&beside).write(&folder.join(name))?;
        }
    }
    let entries = trajectory::entries(scene, trails.believed, goals).len();
    let panel = Panel::of_scene(mapper.frame(), scene.is_grid, entries);
    let ground = scene.is_unknown().then_some(mapper);
    let draw_trails = |area: &Area| trajectory::draw(&panel, area, (scene, ground), trails, goals);
    Ok(draw("trajectory", panel.size(), draw_trails)?.write(&file("trajectory"))?)
}

/// Draws a world from above to the PNG file `path`.
///
/// # Errors
///
/// When the picture cannot be drawn or written.
pub fn draw_plan(path: &Path, scene: &Scene) -> Result<(), PictureError> {
    let panel = Panel::of_scene(&scene.frame, scene.is_grid, plan::entries(scene).len());
    let picture = draw(&scene.title, panel.size(), |area| plan::draw(&panel, area, scene))?;
    Ok(picture.write(path)?)
}

/// Draws a world from above into a part of a picture.
///
/// # Errors
/// As of the plotting library.
pub fn plan_on(sheet: &Sheet<impl DrawingBackend>, pen: Pen, scene: &Scene) -> Drawn {
    let (width, height) = sheet.dim_in_pixel();
    let size = [width, height].map(|length| length / pen.px(1) as u32);
    let panel = Panel::within(&scene.frame, scene.is_grid, size, pen, plan::entries(scene).len());
    plan::draw(&panel, sheet, scene)
}

/// A scene without words, with discs as goals: centers and radii, m. The longer side has `size` pixels.
///
/// # Errors
/// When the picture cannot be drawn.
pub fn bare(scene: &Scene, goals: &[(Point2<f64>, f64)], size: u32) -> Result<Canvas, PictureError> {
    let size_m = extent(&scene.frame).1;
    let pixels_per_m = f64::from(size.clamp(16, 4096)) / size_m.max();
    let size = [size_m.x, size_m.y].map(|length_m| (length_m * pixels_per_m).round().max(1.0) as u32);
    let panel = Panel::of_film(&scene.frame, false);
    draw(&scene.title, size, |area| {
        let chart = panel.bare(area)?;
        plan::ground(&chart, scene)?;
        for (center, radius_m) in goals {
            let disc = plan::arc(&Translation2::from(*center).into(), *radius_m, TAU);
            plan::fill(&chart, &disc, palette::GOAL)?;
        }
        let mut robots = scene.robots.iter();
        robots.try_for_each(|robot| plan::draw_robot(&panel, &chart, robot, &robot.pose, robot.radius_m))
    })
}

/// Draws a layer of the map with other values, and named lines on it, to the PNG file `path`; NaN is drawn as what does not change.
///
/// # Errors
///
/// When the picture cannot be drawn or written.
pub fn draw_values(
    path: &Path,
    (layer, title): (Layer, &str),
    mapper: &Mapper,
    values: &Grid<f64>,
    lines: &[NamedLine],
) -> Result<(), PictureError> {
    let panel = Panel::of_layer(mapper.frame());
    let classes =
        layer.classes_of(mapper, |index| Some(values.cells()[index]).filter(|value| !value.is_nan()));
    let picture = draw(layer.name(), panel.size(), |area| {
        let chart = panel.classes(area, (layer, title), &classes)?;
        plan::lines(&panel, &chart, lines)
    })?;
    Ok(picture.write(path)?)
}

fn draw(name: &str, size: [u32; 2], draw: impl FnOnce(&Area) -> Drawn) -> Result<Canvas, PictureError> {
    Canvas::draw(size, draw).map_err(|why| PictureError::Draw { name: name.to_owned(), why })
}

#[cfg(test)]
#[path = "tests/pictures.rs"]
mod tests;
