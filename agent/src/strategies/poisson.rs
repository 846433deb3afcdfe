use super::Strategy;
use crate::situation::Situation;

/// Goes to cells that probably changed since they were last seen: P(E > 0) (equation 2). The goal is random until
/// the first change is found; then goals are always in areas of known changes.
#[derive(Clone, Copy, Debug)]
pub struct Poisson;

impl Strategy for Poisson {
    fn name(&self) -> &'static str {
        "poisson"
    }

    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]) {
        // A cell that never changed has rate 0 and therefore probability 0.
        for index in situation.mapper.changed() {
            weights[index] = situation.mapper.change_probability(index);
        }
    }
}
