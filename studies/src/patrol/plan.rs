use super::coverage::Coverage;
use super::curious::CuriousViewpoints;
use super::duty::Duty;
use super::fixed_length::FixedLength;
use super::gain::Gain;
use super::round::Round;
use super::view::{Choice, Strategy, View};
use crate::building::Building;
use interfaces::RandomStream;

/// A strategy by its name. A length is that of a patrol, in steps; robots that need not charge ignore it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plan {
    /// Never looks.
    Never,
    /// Goes round all viewpoints, as long as this.
    Round(usize),
    /// The paper's robot, as long as this.
    Curious(usize),
    /// Even coverage, as long as this.
    Coverage(usize),
    /// The largest expected fall of the Brier score per time; it chooses when to leave the dock, and when to return.
    Gain,
}

impl Plan {
    /// The strategy for a building.
    pub fn strategy(self, building: &Building, duty: Duty) -> Box<dyn Strategy> {
        match self {
            Self::Never => Box::new(Never),
            Self::Round(length) => Box::new(FixedLength { next: Round::new(building), length, end: None }),
            Self::Curious(length) => {
                Box::new(FixedLength { next: CuriousViewpoints::new(), length, end: None })
            }
            Self::Coverage(length) => Box::new(FixedLength { next: Coverage, length, end: None }),
            Self::Gain => Box::new(Gain::new(building, duty)),
        }
    }
}

struct Never;

impl Strategy for Never {
    fn choose(&mut self, _: &View<'_>, _: &mut RandomStream) -> Choice {
        Choice::Rest(360)
    }
}
