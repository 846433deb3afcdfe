use crate::{Chooser, Situation};
use rand_chacha::ChaCha8Rng;

/// Always the same strategy, by its place.
#[derive(Clone, Copy, Debug)]
pub struct Always(pub usize);

impl Chooser for Always {
    fn choose(&mut self, _: &Situation, _: &mut ChaCha8Rng) -> usize {
        self.0
    }
}
