use super::Chooser;
use crate::situation::Situation;
use interfaces::RandomStream;

/// Always chooses the strategy with this index.
#[derive(Clone, Copy, Debug)]
pub struct Always(pub usize);

impl Chooser for Always {
    fn choose(&mut self, _: &Situation, _: &mut RandomStream) -> usize {
        self.0
    }
}
