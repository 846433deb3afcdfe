//! What is known of cells that are things of their own.

use crate::change::{Posterior, ReadingIndex};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// The number of cells of which it is kept: 30 MB.
const MAX_CELLS: usize = 1 << 12;

/// What is known of cells that are things of their own, kept until the next reading: a resting robot has none, and is asked often.
#[derive(Debug, Default)]
pub(crate) struct Alone(Mutex<(ReadingIndex, Cells)>);

/// By their indices; `None` of a cell that is no thing of its own.
type Cells = BTreeMap<usize, Option<Arc<Posterior>>>;

impl Clone for Alone {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Alone {
    /// What is known of a cell after a reading.
    pub(super) fn of(
        &self,
        index: usize,
        reading: ReadingIndex,
        make: impl FnOnce() -> Option<Posterior>,
    ) -> Option<Arc<Posterior>> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (of_reading, cells) = &mut *kept;
        if std::mem::replace(of_reading, reading) != reading {
            cells.clear();
        }
        if let Some(known) = cells.get(&index) {
            return known.clone();
        }
        let known = make().map(Arc::new);
        if cells.len() < MAX_CELLS {
            cells.insert(index, known.clone());
        }
        known
    }
}
