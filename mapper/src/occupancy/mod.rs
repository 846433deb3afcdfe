//! Occupancy: from scans to the states of cells.
//!
//! Steps: [`projection`] of a scan into the map, segmentation of its hits into surfaces, the footprint of the cells
//! that beams passed, the [`inverse_sensor_model`] that turns beams into evidence about cells, and an
//! [`OccupancyModel`] that accumulates evidence until a cell changes its state.
//!
//! To add a model: write a file with a type that implements [`OccupancyModel`], add a constructor to
//! [`OccupancyChoice`], and add the constructor to [`OccupancyChoice::all`]. A model of another crate is set in
//! [`MapperSettings::occupancy`] with [`OccupancyChoice::new`].

mod footprint;
mod inverse_sensor_model;
mod log_odds_grid;
mod projection;
mod segmentation;
mod surface_grid;

use crate::change::CellMap;
use crate::{Growth, MapperSettings};
use interfaces::{Cell, Values};
use log_odds_grid::LogOddsGrid;
pub use projection::{BeamReturn, ProjectedScan};
use std::fmt;
use std::sync::Arc;
use surface_grid::SurfaceGrid;
pub use surface_grid::SurfaceGridSettings;

/// Accumulates evidence about the cells of one map, and decides when a cell changes its state.
pub trait OccupancyModel: CloneModel + fmt::Debug + Send + Sync {
    /// Processes a laser scan: writes the observed cells and the changed states to `cells`.
    fn update(&mut self, scan: &ProjectedScan, cells: &mut CellMap);

    /// Processes states of cells from a sensor without error; true means blocked. By default the states are written
    /// to the map as they are.
    fn update_cells(&mut self, states: &[(Cell, bool)], cells: &mut CellMap) {
        cells.observe_states(states);
    }

    /// Whether the last look at a known cell spoke against its state, too rarely so far to change it.
    fn is_doubted(&self, _index: usize, _cells: &CellMap) -> bool {
        false
    }

    /// The evidence about all cells, and everything else that an update changes and a later update needs: what a state
    /// file holds of the model.
    fn values(&mut self) -> Values<'_>;

    /// The memory of the evidence about all cells, bytes.
    fn bytes(&self) -> usize;

    /// Goes on in a larger map, which can be as large as before, with the range noise of `settings`.
    fn grow(&mut self, growth: &Growth, settings: &MapperSettings);
}

/// Clones a boxed model; implemented for every model that is `Clone`.
pub trait CloneModel {
    /// A boxed copy.
    fn clone_box(&self) -> Box<dyn OccupancyModel>;
}

impl<M: OccupancyModel + Clone + 'static> CloneModel for M {
    fn clone_box(&self) -> Box<dyn OccupancyModel> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn OccupancyModel> {
    fn clone(&self) -> Self {
        (**self).clone_box()
    }
}

type Build = dyn Fn(&MapperSettings, &mut CellMap) -> Box<dyn OccupancyModel> + Send + Sync;

/// A choice of an occupancy model, by its name. The default is `steady`.
#[derive(Clone)]
pub struct OccupancyChoice {
    name: &'static str,
    build: Arc<Build>,
}

interfaces::chosen_by_name!(OccupancyChoice, "occupancy model", OccupancyChoice::all());

impl OccupancyChoice {
    /// A model of another crate. `build` makes the model for a map that holds the prior. `name` is the name in
    /// files and reports.
    pub fn new(
        name: &'static str,
        build: impl Fn(&MapperSettings, &mut CellMap) -> Box<dyn OccupancyModel> + Send + Sync + 'static,
    ) -> Self {
        Self { name, build: Arc::new(build) }
    }

    /// All built-in models.
    pub fn all() -> Vec<Self> {
        vec![Self::steady(), Self::naive()]
    }

    /// `steady`: stores the position of surfaces within cells, and clears a cell only by beams that pass through
    /// its surface. Static walls then rarely change: 0 to 81 false changes on a tour of a static world, more where
    /// things move (`docs/flicker.md`, `docs/results.md`).
    pub fn steady() -> Self {
        Self::new("steady", |settings, cells| Box::new(SurfaceGrid::new(settings.steady, cells)))
    }

    /// `naive`: every beam adds evidence to every cell that it crosses, and a cell changes its state at even odds.
    /// Walls flicker, as in figure 5 of the paper.
    pub fn naive() -> Self {
        Self::new("naive", |_, cells| Box::new(LogOddsGrid::new(cells)))
    }

    /// The name on the command line, in files and in reports.
    pub fn name(&self) -> &'static str {
        self.name
    }

    pub(crate) fn build(&self, settings: &MapperSettings, cells: &mut CellMap) -> Box<dyn OccupancyModel> {
        (self.build)(settings, cells)
    }
}

impl Default for OccupancyChoice {
    fn default() -> Self {
        Self::steady()
    }
}
