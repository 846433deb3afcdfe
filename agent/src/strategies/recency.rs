use crate::{Situation, Strategy};

/// Go where nobody looked for long: t_now − t_last (section 3, after Thrun). Zig-zags through the
/// whole place, which keeps the map complete.
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
