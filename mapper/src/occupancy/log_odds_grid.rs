//! The textbook occupancy grid (`naive`), for comparison: every beam adds evidence to every cell that it crosses,
//! and a cell changes its state at even odds. Cells of a wall that grazing beams cross are hit and missed in turn,
//! and flicker: the wall noise of figure 5 of the paper.

use super::OccupancyModel;
use super::footprint::cells_along;
use super::inverse_sensor_model::{HIT_LOG_ODDS, MISS_LOG_ODDS};
use super::projection::{BeamReturn, ProjectedScan};
use crate::change::CellMap;
use crate::{Growth, MapperSettings};
use interfaces::{CellState, SparseCells, Values, cell_runs};

/// The bounds of the sum of log-odds.
const BOUNDS: (f32, f32) = (-2.0, 3.5);

#[derive(Clone, Debug)]
pub(super) struct LogOddsGrid {
    log_odds: SparseCells<f32>,
}

impl LogOddsGrid {
    pub(super) fn new(cells: &CellMap) -> Self {
        let start = |state: &CellState| match state {
            CellState::Unknown => 0.0,
            CellState::Free => BOUNDS.0,
            CellState::Blocked => BOUNDS.1,
        };
        Self { log_odds: cells.states().cells().map(start) }
    }

    fn add(&mut self, index: usize, evidence: f32, cells: &mut CellMap) {
        if !cells.covers(index) {
            return;
        }
        let was_in_view = cells.is_in_view(index);
        let log_odds = &mut self.log_odds[index];
        *log_odds = (*log_odds + evidence).clamp(BOUNDS.0, BOUNDS.1);
        let state = if *log_odds > 0.0 { CellState::Blocked } else { CellState::Free };
        if cells.state(index) == state {
            cells.observe(index);
        } else {
            cells.set_state(index, state, cells.reading(), was_in_view);
        }
    }
}

impl OccupancyModel for LogOddsGrid {
    fn update(&mut self, scan: &ProjectedScan, cells: &mut CellMap) {
        let frame = *cells.frame();
        for beam in 0..scan.len() {
            let result = scan.returns[beam];
            if result == BeamReturn::Nothing {
                continue;
            }
            let end = scan.point(beam, result.clear_m());
            let hit = scan.hit(beam).and_then(|end| frame.index(frame.cell_at(&end)));
            cells_along(&frame, &scan.origin, &end, |index| {
                self.add(index, if hit == Some(index) { HIT_LOG_ODDS } else { MISS_LOG_ODDS }, cells);
            });
        }
    }

    fn values(&mut self) -> Values<'_> {
        vec![cell_runs(&mut self.log_odds, usize::MAX)]
    }

    fn bytes(&self) -> usize {
        self.log_odds.bytes()
    }

    fn grow(&mut self, growth: &Growth, _: &MapperSettings) {
        growth.sparse(&mut self.log_odds);
    }
}
