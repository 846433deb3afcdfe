use super::Strategy;
use crate::situation::Situation;

/// Goes to the cells that were not seen for longest: t_now − t_last (section 3, after Thrun). The robot
/// zig-zags through the whole environment, which keeps the map complete.
#[derive(Clone, Copy, Debug)]
pub struct Recency;

impl Strategy for Recency {
    fn name(&self) -> &'static str {
        "recency"
    }

    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]) {
        for (index, weight) in weights.iter_mut().enumerate() {
            *weight = situation.mapper.recency(index);
        }
    }
}
