use crate::{Chooser, Situation};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// A fair coin, or die, over so many strategies: what a learner must beat.
#[derive(Clone, Copy, Debug)]
pub struct Coin(pub std::num::NonZeroUsize);

impl Chooser for Coin {
    fn choose(&mut self, _: &Situation, rng: &mut ChaCha8Rng) -> usize {
        rng.random_range(0..self.0.get())
    }
}
