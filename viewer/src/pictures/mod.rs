//! Pictures of what was learned, without a viewer: the panels of the paper's Figure 5, and the
//! trajectories of its Figure 4.

pub(crate) mod canvas;
mod panel;
mod plan;
mod trajectory;

use crate::inspection::Content;
use crate::layer::Layer;
use crate::output::{OutputError, make_folder};
use crate::view::{Scene, Trail};
use canvas::Canvas;
use mapper::Mapper;
use nalgebra::Point2;
use std::path::Path;

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

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The drawing failed.
    #[error("cannot draw {name}: {why}")]
    Draw {
        /// The picture.
        name: String,
        /// What the plotting library says.
        why: String,
    },
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

/// Draws what is in a world, from above, to the PNG file `path`.
///
/// # Errors
///
/// When the picture cannot be drawn or written.
pub fn draw_plan(path: &Path, content: &Content) -> Result<(), PictureError> {
    let canvas = Canvas::draw(panel::size(&content.plan.frame), |area| plan::draw(area, content));
    let canvas = canvas.map_err(|why| PictureError::Draw { name: content.name.clone(), why })?;
    Ok(canvas.write(path)?)
}

#[cfg(test)]
mod tests;
