//! The metrics: how good the map and the learned rates are, compared with the ground truth of a simulated
//! world. Each metric is defined once, over [`interfaces::GroundTruth`]. The robot never sees any of this.
//!
//! A cell that solids cover only in part is neither correct nor incorrect, and is left out at that moment.

mod beams;
mod changing;
mod latency;
mod map;
mod mean;
mod rates;
mod things;

pub use changing::{BrierScores, ChangingAccuracy, ChangingScores, Prediction};
pub use latency::{Delays, Latency};
pub use map::{Age, MapScores, age, map_scores};
pub use rates::{RateErrors, RateScores, log_error, mean_log_error, rate_scores};
pub use things::{ThingReport, Things};

#[cfg(test)]
mod tests;
