//! Readings that tell the state of cells outright, as the grid world's sensor does: no evidence
//! to weigh.

use crate::{Evidence, Mapper, ReadingError};
use interfaces::CellReading;

impl Evidence for CellReading {
    fn enter(&self, mapper: &mut Mapper) -> Result<(), ReadingError> {
        mapper.points.clear();
        mapper.ledger.open(self.time);
        mapper.ledger.see_states(&self.cells);
        Ok(())
    }
}
