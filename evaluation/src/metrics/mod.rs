//! The metrics: how good the map and the learned rates are, compared with the ground truth of a simulated
//! world. Each metric is defined once, over [`interfaces::GroundTruth`]. The robot never sees any of this.
//!
//! A cell that solids cover only in part is neither correct nor incorrect, and is left out at that moment.

mod auc;
mod beams;
mod changing;
mod latency;
mod log_error;
mod map;
mod mean;
mod prediction;
mod rates;
mod things;

pub use changing::{ChangingAccuracy, ChangingScores};
pub use latency::{Delays, Latency};
pub use log_error::{log_error, mean_log_error};
pub use map::{Age, MapScores, age, map_scores};
pub use prediction::{BrierScores, Prediction};
pub use rates::{RateErrors, RateScores, rate_scores};
pub use things::{ThingReport, Things};

#[cfg(test)]
mod tests;
