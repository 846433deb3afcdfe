use super::Strategy;
use crate::situation::Situation;

/// Goes anywhere: the baseline that the paper lacks.
#[derive(Clone, Copy, Debug)]
pub struct Random;

impl Strategy for Random {
    fn name(&self) -> &'static str {
        "random"
    }

    /// Leaves every weight at zero, which makes the goal uniform over the candidates. Equal weights
    /// would make it uniform over the patches, and so prefer cells in patches of few candidates.
    fn weigh(&mut self, _: &Situation, _: &mut [f64]) {}
}
