//! Features → choice of a strategy → a goal → reward (paper, section 4). It must not know a simulator, a
//! controller or the true rates of change.
//!
//! A [`Strategy`] gives each cell a weight: how much a visit of the cell is worth. A [`Chooser`] selects the
//! strategy for the next goal. The [`Agent`] combines both: it processes every reading, and when the controller has
//! finished a goal, the agent learns from the trajectory and samples the next goal. If the settings say so, the agent
//! looks into unseen space before its strategies decide.
//!
//! A [`Policy`] names strategies and a chooser. A new policy in this crate is one file under `strategies` or
//! `choosers`, and a line in the list of [`Policy::built_in`]; `docs/extending.md` lists the rest. A policy of another crate is made with
//! [`Policy::new`].

mod agent;
mod choosers;
mod goal_sampler;
mod policy;
mod settings;
mod situation;
mod strategies;
mod travel;
mod trips;
mod unseen;
mod visibility;

pub use agent::{Agent, GoalSelector, StrategyState};
pub use choosers::{Always, Chooser, Coin, Curious, Trajectory};
pub use goal_sampler::Goal;
pub use policy::{Parts, Policy};
pub use settings::AgentSettings;
pub use situation::{Features, Situation, Travel};
pub use strategies::{
    Age, BestTrip, Brier, Elapsed, InformationGain, Pick, Poisson, Random, Recency, Stay, Strategy, Worth,
};
