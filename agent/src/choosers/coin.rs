use crate::{Chooser, Situation};
use interfaces::RandomStream;
use rand::RngExt;

/// A fair coin, or die, over so many strategies: what a learner must beat.
#[derive(Clone, Copy, Debug)]
pub struct Coin(pub std::num::NonZeroUsize);

impl Chooser for Coin {
    fn choose(&mut self, _: &Situation, rng: &mut RandomStream) -> usize {
        rng.random_range(0..self.0.get())
    }
}
