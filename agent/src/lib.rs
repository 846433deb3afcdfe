//! Features → choice of a strategy → a goal → reward (paper, section 4).
//!
//! A [`Strategy`] says how much each cell is worth a visit, a [`Chooser`] which strategy to follow
//! next, and the [`Agent`] holds them together: it watches every reading, and each time the
//! controller hands back, it learns from the trajectory just driven and samples the next goal.
//!
//! To add a strategy or a chooser: one file under `strategies` or `choosers`, and a line in
//! [`StrategyChoice`].

mod agent;
mod choice;
mod choosers;
mod draw;
mod features;
mod goal;
mod knowledge;
mod settings;
mod situation;
mod strategies;
mod survey;
mod tile_coder;
mod travel;
#[allow(dead_code)] // until a strategy that looks ahead is here
mod view;

pub use agent::{Agent, Tally};
pub use choice::{StrategyChoice, UnknownStrategy};
pub use choosers::{Always, Chooser, Coin, Curious, Progress, Trajectory};
pub use features::Features;
pub use goal::Goal;
pub use settings::{AgentSettings, CuriousSettings, Reward, SettingsError};
pub use situation::Situation;
pub use strategies::{
    Frontier, InformationGain, OptimalRevisiting, Pick, Poisson, Random, Recency, Stay, Strategy,
};
pub use tile_coder::TileCoder;
pub use travel::{AsTheCrowFlies, Travel};
