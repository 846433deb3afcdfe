use super::Strategy;
use crate::situation::Situation;
use interfaces::CellState;

/// Goes to cells that are probably in another state than was last seen, by the predicted map: the paper's `poisson` asks
/// whether a cell changed at all (equation 2), also if it changed back since. Where the map has clocks, their hours count.
#[derive(Clone, Copy, Debug)]
pub struct PredictedChange;

impl Strategy for PredictedChange {
    fn name(&self) -> &'static str {
        "predicted-change"
    }

    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]) {
        let mapper = situation.mapper;
        for index in mapper.changed() {
            let blocked = mapper.blocked_probability(index);
            weights[index] = match mapper.states().cells()[index] {
                CellState::Blocked => 1.0 - blocked,
                CellState::Free => blocked,
                CellState::Unknown => 0.0,
            };
        }
    }
}
