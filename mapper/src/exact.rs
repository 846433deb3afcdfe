//! Readings that tell the state of cells outright, as the grid world's sensor does: no evidence
//! to weigh.

use crate::{Evidence, Mapper, ReadingError};
use geometry::{CellReading, CellState};

impl Evidence for CellReading {
    fn enter(&self, mapper: &mut Mapper) -> Result<(), ReadingError> {
        let ledger = &mut mapper.ledger;
        mapper.points.clear();
        let now = ledger.open(self.time);
        for &(cell, is_blocked) in &self.cells {
            let Some(index) = ledger.frame().index(cell) else { continue };
            let state = if is_blocked { CellState::Blocked } else { CellState::Free };
            let in_view = ledger.is_in_view(index);
            if ledger.state(index) == state {
                ledger.see(index);
            } else {
                ledger.turn(index, state, now, in_view);
            }
        }
        ledger.infer_moves();
        Ok(())
    }
}
