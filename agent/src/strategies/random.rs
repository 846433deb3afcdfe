use super::Strategy;
use crate::situation::Situation;

/// Goes to any cell: a baseline that the paper does not have.
#[derive(Clone, Copy, Debug)]
pub struct Random;

impl Strategy for Random {
    fn name(&self) -> &'static str {
        "random"
    }

    /// Leaves every weight at zero, so that the goal is uniform over the candidates. Equal weights would make the
    /// goal uniform over the patches, and would prefer cells in patches with few candidates.
    fn weigh(&mut self, _: &Situation, _: &mut [f64]) {}
}
