use super::Chooser;
use crate::situation::Situation;
use interfaces::RandomStream;
use rand::RngExt;

/// Chooses among this number of strategies at random, all with the same probability: the baseline for learners.
#[derive(Clone, Copy, Debug)]
pub struct Coin(pub std::num::NonZeroUsize);

impl Chooser for Coin {
    fn choose(&mut self, _: &Situation, rng: &mut RandomStream) -> usize {
        rng.random_range(0..self.0.get())
    }
}
