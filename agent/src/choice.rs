use crate::{
    AgentSettings, Always, Chooser, Coin, Curious, Frontier, InformationGain, OptimalRevisiting, Poisson,
    Progress, Random, Recency, Strategy,
};
use rand_chacha::ChaCha8Rng;
use std::num::NonZeroUsize;

/// How the robot decides where to go, as selected on the command line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StrategyChoice {
    /// The paper's learner over [`Recency`] and [`Poisson`].
    #[default]
    Curious,
    /// [`Recency`] alone.
    Recency,
    /// [`Poisson`] alone.
    Poisson,
    /// [`Random`] alone.
    Random,
    /// [`Recency`] or [`Poisson`] by a fair coin.
    Coin,
    /// [`Frontier`] alone.
    Frontier,
    /// [`OptimalRevisiting`] alone.
    OptimalRevisiting,
    /// [`InformationGain`] alone.
    InformationGain,
    /// [`Progress`] over [`Recency`], [`Poisson`], [`Frontier`], [`OptimalRevisiting`] and
    /// [`InformationGain`].
    Progress,
}

/// The strategies and the chooser over them.
pub(crate) type Parts = (Vec<Box<dyn Strategy>>, Box<dyn Chooser>);

impl StrategyChoice {
    /// Every choice.
    pub const ALL: [Self; 9] = [
        Self::Curious,
        Self::Recency,
        Self::Poisson,
        Self::Random,
        Self::Coin,
        Self::Frontier,
        Self::OptimalRevisiting,
        Self::InformationGain,
        Self::Progress,
    ];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Curious => "curious",
            Self::Recency => "recency",
            Self::Poisson => "poisson",
            Self::Random => "random",
            Self::Coin => "coin",
            Self::Frontier => "frontier",
            Self::OptimalRevisiting => "optimal-revisiting",
            Self::InformationGain => "information-gain",
            Self::Progress => "progress",
        }
    }

    /// Makes the parts of an agent. A learner draws its first numbers here.
    pub(crate) fn parts(self, settings: &AgentSettings, rng: &mut ChaCha8Rng) -> Parts {
        fn only(strategy: impl Strategy + 'static) -> Parts {
            (vec![Box::new(strategy)], Box::new(Always(0)))
        }
        let papers = || -> Vec<Box<dyn Strategy>> { vec![Box::new(Recency), Box::new(Poisson)] };
        match self {
            Self::Curious => {
                let strategies = papers();
                let chooser = Curious::new(&settings.curious, strategies.len(), rng);
                (strategies, Box::new(chooser))
            }
            Self::Recency => only(Recency),
            Self::Poisson => only(Poisson),
            Self::Random => only(Random),
            Self::Frontier => only(Frontier::new(settings.sensor_radius_m)),
            Self::OptimalRevisiting => only(OptimalRevisiting::new(settings.sensor_radius_m)),
            Self::InformationGain => only(InformationGain::new(settings.sensor_radius_m)),
            Self::Progress => {
                let mut strategies = papers();
                strategies.push(Box::new(Frontier::new(settings.sensor_radius_m)));
                strategies.push(Box::new(OptimalRevisiting::new(settings.sensor_radius_m)));
                strategies.push(Box::new(InformationGain::new(settings.sensor_radius_m)));
                let chooser = Progress::new(strategies.len());
                (strategies, Box::new(chooser))
            }
            Self::Coin => (papers(), Box::new(Coin(const { NonZeroUsize::new(2).unwrap() }))),
        }
    }
}

impl std::fmt::Display for StrategyChoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

impl std::str::FromStr for StrategyChoice {
    type Err = UnknownStrategy;

    fn from_str(name: &str) -> Result<Self, UnknownStrategy> {
        Self::ALL
            .into_iter()
            .find(|choice| choice.name() == name)
            .ok_or_else(|| UnknownStrategy { name: name.into() })
    }
}

/// A name that no strategy has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no strategy is called `{name}`; there are {}", StrategyChoice::ALL.map(StrategyChoice::name).join(", "))]
pub struct UnknownStrategy {
    /// What was asked for.
    pub name: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        #[derive(serde::Deserialize)]
        struct File {
            strategy: StrategyChoice,
        }
        for choice in StrategyChoice::ALL {
            assert_eq!(choice.name().parse(), Ok(choice));
            let file: File = toml::from_str(&format!("strategy = '{choice}'")).unwrap();
            assert_eq!(file.strategy, choice);
        }
    }

    #[test]
    fn an_unknown_name_is_answered_with_the_known_ones() {
        assert_eq!(
            "Curius".parse::<StrategyChoice>().unwrap_err().to_string(),
            "no strategy is called `Curius`; there are curious, recency, poisson, random, coin, frontier, \
             optimal-revisiting, information-gain, progress"
        );
    }
}
