//! How often cells change: the map with its change statistics, and the estimators of rates.

mod cell_map;
mod chain;
mod estimators;
mod exposure;
mod gaps;
mod reading_times;
mod shared_cells;
mod shared_prior;
mod statistics;
mod transition_kernel;

pub use cell_map::CellMap;
pub(crate) use cell_map::Slot;
pub(crate) use chain::Fading;
pub use chain::{Evidence, Population, Posterior, Waiting};
pub use estimators::{Estimator, EstimatorChoice, Paper, PaperAll, SharedPrior, TwoState, TwoStateGaps};
pub(crate) use exposure::Exposure;
pub(crate) use gaps::Belief;
pub use reading_times::ReadingIndex;
pub use shared_prior::RateDistribution;
pub use statistics::{CellStatistics, GapWorth};
pub use transition_kernel::TransitionRates;
