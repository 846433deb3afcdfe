use super::Strategy;
use crate::situation::Situation;

/// Goes to cells with the longest time since they were last seen: t_now − t_last (section 3, after Thrun). The
/// robot zigzags through the whole environment, so that the map stays complete.
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
