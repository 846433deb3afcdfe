use crate::{Chooser, Situation};
use interfaces::RandomStream;

/// Always the same strategy, by its place.
#[derive(Clone, Copy, Debug)]
pub struct Always(pub usize);

impl Chooser for Always {
    fn choose(&mut self, _: &Situation, _: &mut RandomStream) -> usize {
        self.0
    }
}
