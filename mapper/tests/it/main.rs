//! Tests of the mapper through its public interface.

#[path = "../house/mod.rs"]
mod house;

mod bad_readings;
mod bodies;
mod bookkeeping;
mod chains;
mod doors;
mod estimators;
mod fast;
mod observed;
mod prior;
mod saved;
mod scan_filter;
mod skipped;
mod things;
mod tiles;
mod walls;

use interfaces::{Cell, CellReading};
use nalgebra::Isometry2;

/// A reading of cells.
fn cells(time: f64, cells: impl IntoIterator<Item = (Cell, bool)>) -> CellReading {
    CellReading { time, pose: Isometry2::identity(), cells: cells.into_iter().collect() }
}
