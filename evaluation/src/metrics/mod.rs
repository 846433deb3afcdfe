//! The metrics: the quality of the map and of the learned rates, compared with the ground truth of a simulated
//! world. Each metric is defined once, over [`interfaces::GroundTruth`]. The robot has no access to metrics.
//!
//! A cell that solid bodies cover only partly is neither correct nor incorrect, and is ignored as long as it is
//! partly covered.

mod alignment;
mod beams;
mod changing;
mod counts;
mod deviance;
mod forecasts;
mod freshness;
mod latency;
mod map;
mod mean;
mod passages;
mod pose;
mod prediction;
mod probability;
mod quantile;
mod rates;
mod things;
mod true_chains;

pub use alignment::alignment;
pub use changing::{ChangingAccuracy, ChangingScores};
pub use deviance::{DevianceScores, FrozenRates, poisson_deviance};
pub use forecasts::{ForecastScores, Forecasts};
pub use freshness::{Freshness, FreshnessScores};
pub use latency::{Delays, Latency};
pub use map::{Age, MapScores, ReachableScores, age, map_scores, reachable_scores};
pub use passages::{PassageScores, passage_scores};
pub use pose::{PoseErrors, PoseScores};
pub use prediction::{Prediction, StateScores};
pub use probability::ProbabilityScores;
pub use quantile::quantile;
pub use rates::{
    IntervalScores, MAX_LOG_ERROR, RateScores, interval_scores, log_error, mean_log_error,
    mean_log_error_of_range, rate_scores,
};
pub use things::{ThingReport, Things};
pub use true_chains::TrueChains;

#[cfg(test)]
mod tests;
