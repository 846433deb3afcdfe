//! Features → choice of a strategy → a goal → reward (paper, section 4).
//!
//! A [`Strategy`] says how much each cell is worth a visit, a [`Chooser`] which strategy to follow
//! next, and the [`Agent`] holds them together: it watches every reading, and each time the
//! controller hands back, it learns from the trajectory just driven and samples the next goal.
//!
//! A [`Policy`] names strategies and a chooser. To add one to this crate: one file under `strategies` or
//! `choosers`, and a line in the list of [`Policy::built_in`]. To add one from another crate: [`Policy::new`].

mod agent;
mod choosers;
mod draw;
mod features;
mod goal;
mod knowledge;
mod policy;
mod settings;
mod situation;
mod strategies;
mod survey;
mod tile_coder;
mod travel;
mod view;

pub use agent::{Agent, Tally};
pub use choosers::{Always, Chooser, Coin, Curious, Progress, Trajectory};
pub use features::Features;
pub use goal::Goal;
pub use policy::{Parts, Policy, UnknownPolicy};
pub use settings::{AgentSettings, CuriousSettings, Reward};
pub use situation::Situation;
pub use strategies::{
    Frontier, InformationGain, OptimalRevisiting, Pick, Poisson, Random, Recency, Stay, Strategy,
};
pub use tile_coder::TileCoder;
pub use travel::{AsTheCrowFlies, Travel};
