//! Pictures of a run and of a world: the panels of the paper's Figure 5, the trajectories of its Figure 4, a
//! plan, and a moving picture.

mod film;
mod ground;
mod panel;
mod plan;
mod plate;
mod trajectory;

pub use film::Film;

use crate::layers::Layer;
use crate::scene::Scene;
use crate::view::Trail;
use evaluation::drawing::{Area, Canvas, PictureError};
use evaluation::observer::Goals;
use evaluation::output::make_folder;
use mapper::Mapper;
use panel::Panel;
use std::path::Path;

/// The panels of Figure 5, in its order.
const FIGURE_5: [Layer; 3] = [Layer::Occupancy, Layer::Interval, Layer::ChangeProbability];

/// Writes `figure5.png`, each of its panels and the recency as `<layer>.png`, and `trajectory.png` into
/// `folder`, which is created if needed. `trails` are in the order of the robots of the scene; `goals` are
/// those of the curious robot.
///
/// # Errors
///
/// When a picture cannot be drawn or written.
pub fn write_all(
    folder: &Path,
    scene: &Scene,
    mapper: &Mapper,
    trails: &[Trail],
    goals: &Goals,
) -> Result<(), PictureError> {
    make_folder(folder)?;
    let file = |name: &str| folder.join(format!("{name}.png"));
    let panel = Panel::of_layer(mapper.frame(), scene.unit);
    let [width, height] = panel.size();
    for layer in Layer::ALL {
        let draw = |area: &Area| panel.layer(area, mapper, layer, scene.unit);
        save(&file(layer.name()), panel.size(), draw)?;
    }
    save(&file("figure5"), [width * FIGURE_5.len() as u32, height], |area| {
        let areas = area.split_evenly((1, FIGURE_5.len()));
        areas.iter().zip(FIGURE_5).try_for_each(|(area, layer)| panel.layer(area, mapper, layer, scene.unit))
    })?;
    let panel = Panel::of_scene(mapper.frame(), scene.unit, trajectory::entries(scene, goals).len());
    save(&file("trajectory"), panel.size(), |area| trajectory::draw(&panel, area, scene, trails, goals))
}

/// Draws a world from above to the PNG file `path`.
///
/// # Errors
///
/// When the picture cannot be drawn or written.
pub fn draw_plan(path: &Path, scene: &Scene) -> Result<(), PictureError> {
    let panel = Panel::of_scene(&scene.frame, scene.unit, plan::entries(scene).len());
    save(path, panel.size(), |area| plan::draw(&panel, area, scene))
}

fn save(
    path: &Path,
    size: [u32; 2],
    draw: impl FnOnce(&Area) -> Result<(), String>,
) -> Result<(), PictureError> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let canvas = Canvas::draw(size, draw).map_err(|why| PictureError::Draw { name, why })?;
    Ok(canvas.write(path)?)
}

#[cfg(test)]
mod tests;
