use agent::StrategyChoice;

/// How the robot of a trial chooses its goals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrialStrategy {
    /// By what it knows.
    Agent(StrategyChoice),
    /// By the truth: the reference that no robot can be.
    Oracle,
}

impl TrialStrategy {
    /// Every one.
    pub fn all() -> impl Iterator<Item = Self> {
        StrategyChoice::ALL.into_iter().map(Self::Agent).chain([Self::Oracle])
    }

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Agent(choice) => choice.name(),
            Self::Oracle => "oracle",
        }
    }
}
