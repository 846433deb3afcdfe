use super::Chooser;
use crate::situation::Situation;
use interfaces::RandomStream;
use rand::RngExt;

/// A fair coin, or die, over this number of strategies: the baseline of the learners.
#[derive(Clone, Copy, Debug)]
pub struct Coin(pub std::num::NonZeroUsize);

impl Chooser for Coin {
    fn choose(&mut self, _: &Situation, rng: &mut RandomStream) -> usize {
        rng.random_range(0..self.0.get())
    }
}
