use crate::choosers::{Always, Chooser, Coin, Curious};
use crate::settings::AgentSettings;
use crate::strategies::{Age, BestTrip, Brier, InformationGain, Poisson, Random, Recency, Strategy};
use interfaces::RandomStream;
use std::num::NonZeroUsize;
use std::sync::{Arc, LazyLock};

/// The strategies of an agent, and the chooser that selects among them.
pub type Parts = (Vec<Box<dyn Strategy>>, Box<dyn Chooser>);

/// A policy: how an agent selects goals. A policy has a name, and makes its strategies and its chooser.
///
/// [`Policy::built_in`] lists the policies of this crate. A policy of any other crate is made with
/// [`Policy::new`] or [`Policy::single`], and runs wherever a built-in one does:
///
/// ```
/// use agent::{Policy, Situation, Strategy};
///
/// /// Go to what lies in the east.
/// #[derive(Debug)]
/// struct East;
///
/// impl Strategy for East {
///     fn name(&self) -> &'static str {
///         "east"
///     }
///
///     fn weigh(&mut self, situation: &Situation, weights: &mut [f64]) {
///         for (index, weight) in weights.iter_mut().enumerate() {
///             *weight = f64::from(situation.mapper.frame().cell(index).x);
///         }
///     }
/// }
///
/// let east = Policy::single("east", "what lies in the east", |_| East);
/// ```
///
/// Two policies are equal if they have the same name. Serde, `Display` and `FromStr` use the name; only built-in
/// policies can be read.
#[derive(Clone)]
pub struct Policy {
    name: &'static str,
    description: &'static str,
    build: Arc<Build>,
}

/// Makes the strategies and the chooser.
type Build = dyn Fn(&AgentSettings, &mut RandomStream) -> Parts + Send + Sync;

/// The built-in policies, the default first: the name, where the robot goes, and the constructor.
static BUILT_IN: LazyLock<Vec<Policy>> = LazyLock::new(|| {
    vec![
        Policy::new("curious", "recency or poisson, chosen by the paper's learner", curious),
        Policy::single("recency", "cells not seen for long (paper)", |_| Recency),
        Policy::single("poisson", "cells that probably changed (paper)", |_| Poisson),
        Policy::single("random", "any cell: a baseline", |_| Random),
        Policy::new("coin", "recency or poisson by a fair coin: the baseline of learners", coin),
        Policy::single("coverage", "most area not seen for long, per time", |settings| {
            BestTrip::new(Age, settings)
        }),
        Policy::single("fresh-map", "least error of the predicted map, per time", |settings| {
            BestTrip::new(Brier, settings)
        }),
        Policy::single("information-gain", "least error of the rates, per time", InformationGain::new),
    ]
});

fn papers() -> Vec<Box<dyn Strategy>> {
    vec![Box::new(Recency), Box::new(Poisson)]
}

fn curious(settings: &AgentSettings, rng: &mut RandomStream) -> Parts {
    let strategies = papers();
    let chooser = Curious::new(settings.temperature, strategies.len(), rng);
    (strategies, Box::new(chooser))
}

fn coin(_: &AgentSettings, _: &mut RandomStream) -> Parts {
    (papers(), Box::new(Coin(const { NonZeroUsize::new(2).unwrap() })))
}

impl Policy {
    /// A policy with any strategies and any chooser. `build` is called once per run; strategies and choosers that
    /// need random numbers at construction draw them from the agent's stream. `name` is the name on the command
    /// line and in files; `description` completes the sentence "goes to ...".
    pub fn new(
        name: &'static str,
        description: &'static str,
        build: impl Fn(&AgentSettings, &mut RandomStream) -> Parts + Send + Sync + 'static,
    ) -> Self {
        Self { name, description, build: Arc::new(build) }
    }

    /// A policy with one strategy. The strategy should have the same name as the policy.
    pub fn single<S: Strategy + 'static>(
        name: &'static str,
        description: &'static str,
        strategy: impl Fn(&AgentSettings) -> S + Send + Sync + 'static,
    ) -> Self {
        Self::new(name, description, move |settings, _| {
            (vec![Box::new(strategy(settings))], Box::new(Always(0)))
        })
    }

    /// The policies of this crate, the default first.
    pub fn built_in() -> &'static [Self] {
        &BUILT_IN
    }

    /// The name on the command line and in files.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The description in lists: where the robot goes, in one line.
    pub fn description(&self) -> &'static str {
        self.description
    }

    /// Makes the strategies and the chooser of one run.
    pub fn build(&self, settings: &AgentSettings, rng: &mut RandomStream) -> Parts {
        (self.build)(settings, rng)
    }
}

impl Default for Policy {
    fn default() -> Self {
        BUILT_IN[0].clone()
    }
}

interfaces::chosen_by_name!(Policy, "strategy", Policy::built_in());

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;
    use serde::de::value::{Error, MapDeserializer};

    #[test]
    fn names_are_read_back() {
        #[derive(Deserialize)]
        struct File {
            strategy: Policy,
        }
        for policy in Policy::built_in() {
            assert_eq!(policy.name().parse::<Policy>().unwrap(), *policy);
            let keys = MapDeserializer::<_, Error>::new([("strategy", policy.name())].into_iter());
            let file = File::deserialize(keys).unwrap();
            assert_eq!(file.strategy, *policy);
        }
        assert_eq!(Policy::default().name(), "curious");
    }

    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        assert_eq!(
            "Curius".parse::<Policy>().unwrap_err().to_string(),
            "no strategy is called `Curius`; there are curious, recency, poisson, random, coin, coverage, \
             fresh-map, information-gain"
        );
    }
}
