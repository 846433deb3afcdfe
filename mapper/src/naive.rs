//! The occupancy grid of the textbooks, kept for comparison: every beam adds evidence to every
//! cell it crosses, and a cell flips at even odds. Cells on a wall that grazing beams cross are
//! hit and missed in turn, and flicker: the wall noise of the paper's figure 5.

use crate::footprint::cells_along;
use crate::ledger::Ledger;
use crate::projection::{PointCloud, Return};
use interfaces::CellState;

/// Log-odds for a hit, a miss, and the bounds of the sum.
const HIT: f32 = 0.85;
const MISS: f32 = -0.4;
const BOUNDS: (f32, f32) = (-2.0, 3.5);

#[derive(Clone, Debug)]
pub(crate) struct Naive {
    log_odds: Vec<f32>,
}

impl Naive {
    pub(crate) fn new(ledger: &Ledger) -> Self {
        let start = |state: &CellState| match state {
            CellState::Unknown => 0.0,
            CellState::Free => BOUNDS.0,
            CellState::Blocked => BOUNDS.1,
        };
        Self { log_odds: ledger.states().cells().iter().map(start).collect() }
    }

    pub(crate) fn update(&mut self, cloud: &PointCloud, ledger: &mut Ledger) {
        let frame = *ledger.frame();
        for beam in 0..cloud.len() {
            let end_m = match cloud.returns[beam] {
                Return::Nothing => continue,
                Return::Hit(range_m) | Return::Clear(range_m) => range_m,
            };
            let end = cloud.point(beam, end_m);
            let hit = matches!(cloud.returns[beam], Return::Hit(_)).then(|| frame.cell_at(&end));
            let hit = hit.and_then(|cell| frame.index(cell));
            cells_along(&frame, &cloud.origin, &end, |index| {
                self.add(index, if hit == Some(index) { HIT } else { MISS }, ledger);
            });
        }
    }

    fn add(&mut self, index: usize, evidence: f32, ledger: &mut Ledger) {
        let was_in_view = ledger.is_in_view(index);
        let log_odds = &mut self.log_odds[index];
        *log_odds = (*log_odds + evidence).clamp(BOUNDS.0, BOUNDS.1);
        let state = if *log_odds > 0.0 { CellState::Blocked } else { CellState::Free };
        if ledger.state(index) == state {
            ledger.see(index);
        } else {
            ledger.turn(index, state, ledger.now_index(), was_in_view);
        }
    }
}
