//! The metrics: the quality of the map and of the learned rates, compared with the ground truth of a simulated
//! world. Each metric is defined once, over [`interfaces::GroundTruth`]. The robot has no access to metrics.
//!
//! A cell that solid bodies cover only partly is neither correct nor incorrect, and is ignored as long as it is
//! partly covered.

mod beams;
mod deviance;
mod freshness;
mod latency;
mod map;
mod pose;
mod prediction;
mod rates;
mod statistics;
mod true_chains;

#[cfg(test)]
mod tests;

pub use deviance::{DevianceScores, FrozenRates, poisson_deviance};
pub use freshness::{Freshness, FreshnessScores};
pub use latency::{Delays, Latency};
pub use map::{Age, ChangingAccuracy, ChangingScores, MapScores, age, map_scores};
pub use pose::{PoseErrors, PoseScores};
pub use prediction::{ForecastScores, Forecasts, Prediction, StateScores};
pub use rates::{
    IntervalScores, MAX_LOG_ERROR, PassageScores, RateScores, interval_scores, log_error, mean_log_error,
    mean_log_error_of_range, passage_scores, rate_scores,
};
pub(crate) use statistics::Mean;
pub use statistics::{ProbabilityScores, quantile};
pub use true_chains::TrueChains;
