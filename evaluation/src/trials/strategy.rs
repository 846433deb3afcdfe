use agent::Policy;

/// How the robot of a trial chooses its goals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TrialStrategy {
    /// By what it knows.
    Agent(Policy),
    /// By the truth: the reference that no robot can be.
    Oracle,
}

impl TrialStrategy {
    /// Every one.
    pub fn all() -> impl Iterator<Item = Self> {
        Policy::built_in().iter().cloned().map(Self::Agent).chain([Self::Oracle])
    }

    /// The name on the command line and in files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Agent(policy) => policy.name(),
            Self::Oracle => "oracle",
        }
    }

    /// Where the robot goes, in one line for a list.
    pub fn description(&self) -> &'static str {
        match self {
            Self::Agent(policy) => policy.description(),
            Self::Oracle => "what the true rates promise most of: the reference, no robot knows them",
        }
    }
}
