//! Occupancy maps in the format of the ROS `map_server`: a gray picture and a YAML file.
//!
//! | key | meaning |
//! |---|---|
//! | `image` | the picture, relative to the YAML file; row 0 has the highest y |
//! | `resolution` | the side of a pixel, m |
//! | `origin` | `[x, y, yaw]` of the lower left corner, m and rad |
//! | `negate` | 0 (default): dark is blocked; 1: bright is |
//! | `occupied_thresh` | p above this is blocked, strictly |
//! | `free_thresh` | p below this is free, strictly; anything between is unknown |
//! | `mode` | `trinary` (default), `scale`, or `raw` |
//!
//! p = (255 − v)/255 for a pixel of brightness v, or v/255 with `negate`. In the mode `raw` the
//! pixel is p in percent, and above 100 unknown; in `scale` a transparent pixel is unknown.
//!
//! ROS ignores other keys. Here they cause a warning, since a misspelled key would change the map.

mod read;
#[cfg(test)]
mod tests;

pub use read::read;

use crate::files::Files;
use crate::findings::{Findings, Severity};
use crate::floor_plan::{Bitmap, FloorPlan};
use interfaces::{CellState, Grid, GridFrame};
use nalgebra::{Isometry2, Vector2};
use std::path::Path;
use std::sync::Arc;

const EXAMPLE: &str = "a map has e.g. `image: map.pgm`, `resolution: 0.05`, `origin: [-6.0, -6.0, 0.0]`, \
                       `negate: 0`, `occupied_thresh: 0.65`, `free_thresh: 0.196`";

/// A map with its pose in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct RosMap {
    /// The state of every pixel, in a frame whose lower left corner is the origin.
    pub cells: Grid<CellState>,
    /// The pose of this frame in the world, m and rad.
    pub origin: Isometry2<f64>,
}

impl RosMap {
    /// The state of the map at the center of every cell of `frame`; unknown outside of the map. The cells of the
    /// map may have another size and another orientation.
    pub fn onto(&self, frame: &GridFrame) -> Grid<CellState> {
        let to_map = self.origin.inverse();
        let mut grid = Grid::filled(*frame, CellState::Unknown);
        for index in 0..frame.len() {
            let at = to_map * frame.center(frame.cell(index));
            let state = self.cells.get(self.cells.frame().cell_at(&at)).copied();
            grid.cells_mut().set(index, state.unwrap_or_default());
        }
        grid
    }
}

/// Reads a `map.yaml` and its picture as a floor plan. Unknown pixels become free; a note counts them. If no plan
/// is returned, there are errors among the findings.
pub fn read_floor_plan(yaml: &Path, files: &dyn Files, findings: &mut Findings) -> Option<FloorPlan> {
    let map = read(yaml, files, findings)?;
    let states = map.cells.cells();
    let unknown = states.iter().filter(|state| **state == CellState::Unknown).count();
    if unknown > 0 {
        let what = format!("{unknown} of the {} pixels are unknown", states.len());
        let help = "they are taken as free: no walls, and lasers look through";
        findings.add_file(Severity::Note, yaml, &what, help);
    }
    let frame = map.cells.frame();
    let blocked: Vec<bool> = states.iter().map(|state| *state == CellState::Blocked).collect();
    let bitmap = Bitmap::new(frame.width() as u32, frame.height() as u32, &blocked).map_err(|error| {
        let what = format!("this map makes no walls: {error}");
        findings.add_file(Severity::Error, yaml, &what, "take a map with smoother walls");
    });
    let (bitmap, pixel_m) = (Arc::new(bitmap.ok()?), Vector2::repeat(frame.resolution_m()));
    Some(FloorPlan { bitmap, pixel_m, origin: map.origin })
}
