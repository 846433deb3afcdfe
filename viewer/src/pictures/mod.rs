//! Pictures of what was learned, without a viewer: the panels of the paper's Figure 5, and the
//! trajectories of its Figure 4.

mod panel;
mod plan;
mod trajectory;

use crate::layer::Layer;
use crate::view::{Scene, Trail};
use evaluation::drawing::{Canvas, PictureError};
use evaluation::output::make_folder;
use mapper::Mapper;
use nalgebra::Point2;
use std::path::Path;

pub use plan::{Plan, PlanRobot, PlanThing, SensorView};

/// What there is to be drawn.
#[derive(Clone, Copy)]
pub struct Pictures<'a> {
    /// The house.
    pub scene: &'a Scene,
    /// The maps.
    pub mapper: &'a Mapper,
    /// Where the robots have been.
    pub trails: &'a [Trail],
    /// The curious robot's goals, m.
    pub goals: &'a [Point2<f64>],
}

/// The panels of Figure 5, in its order.
const FIGURE_5: [Layer; 3] = [Layer::Occupancy, Layer::Interval, Layer::ChangeProbability];

/// Writes `figure5.png`, each of its panels and the recency as `<layer>.png`, and
/// `trajectory.png` into `folder`, which is made unless it exists.
///
/// # Errors
///
/// When a picture cannot be drawn or written.
pub fn write_all(folder: &Path, pictures: &Pictures) -> Result<(), PictureError> {
    make_folder(folder)?;
    let (mapper, unit) = (pictures.mapper, pictures.scene.unit);
    let panel_size = panel::size(mapper.frame());
    let save = |name: &str, canvas: Result<Canvas, String>| {
        let canvas = canvas.map_err(|why| PictureError::Draw { name: name.into(), why })?;
        Ok::<_, PictureError>(canvas.write(&folder.join(format!("{name}.png")))?)
    };
    for layer in Layer::ALL {
        save(layer.name(), Canvas::draw(panel_size, |area| panel::draw(area, mapper, layer, unit)))?;
    }
    let row_size = [panel_size[0] * FIGURE_5.len() as u32, panel_size[1]];
    let row = Canvas::draw(row_size, |area| {
        let panels = area.split_evenly((1, FIGURE_5.len()));
        panels.iter().zip(FIGURE_5).try_for_each(|(area, layer)| panel::draw(area, mapper, layer, unit))
    });
    save("figure5", row)?;
    save("trajectory", Canvas::draw(panel_size, |area| trajectory::draw(area, pictures)))
}

/// Draws a world from above to the PNG file `path`; `name` is its title.
///
/// # Errors
///
/// When the picture cannot be drawn or written.
pub fn draw_plan(path: &Path, name: &str, plan: &Plan) -> Result<(), PictureError> {
    let canvas = Canvas::draw(panel::size(&plan.frame), |area| plan::draw(area, name, plan));
    let canvas = canvas.map_err(|why| PictureError::Draw { name: name.to_owned(), why })?;
    Ok(canvas.write(path)?)
}

#[cfg(test)]
mod tests;
