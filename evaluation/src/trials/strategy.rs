use agent::Policy;

/// How the robot of a trial selects its goals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TrialStrategy {
    /// By an agent with this policy.
    Agent(Policy),
    /// Not at all: the robot stays where it starts, but observes the true state of every cell at every reading. A
    /// reference: it has the errors of the estimator alone.
    FullObservation,
}

impl TrialStrategy {
    /// All strategies.
    pub fn all() -> impl Iterator<Item = Self> {
        Policy::built_in().iter().cloned().map(Self::Agent).chain([Self::FullObservation])
    }

    /// The name on the command line and in files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Agent(policy) => policy.name(),
            Self::FullObservation => "full-observation",
        }
    }

    /// The description in lists: where the robot goes, in one line.
    pub fn description(&self) -> &'static str {
        match self {
            Self::Agent(policy) => policy.description(),
            Self::FullObservation => "nowhere: it sees every cell all the time, the bound of the estimator",
        }
    }
}
