//! Equation 1 of the paper (section 3): T = min(T_block, T_free), with
//! T_block = (t_last − t_unobserved − t_init) / n_block, and the same for T_free with n_free.
//!
//! The two processes are coupled and have one rate: the cycle time is the smaller interval, that of the process
//! with more events. The paper does not say whether a change that is found after a gap counts. Therefore there are
//! two estimators.

use super::Estimator;
use crate::change::CellStatistics;

/// Equation 1.
fn equation_1(seen: &CellStatistics, n_block: u32, n_free: u32) -> f64 {
    seen.observed() / f64::from(n_block.max(n_free))
}

/// `paper`: equation 1 with the changes in view.
#[derive(Clone, Copy, Debug)]
pub struct Paper;

impl Estimator for Paper {
    fn name(&self) -> &'static str {
        "paper"
    }

    fn interval(&self, seen: &CellStatistics) -> f64 {
        equation_1(seen, seen.block_events, seen.free_events)
    }
}

/// `paper-all`: equation 1 with all changes, including those found after a gap. The gaps are still subtracted from
/// the time, so that short visits bias the rate upward.
#[derive(Clone, Copy, Debug)]
pub struct PaperAll;

impl Estimator for PaperAll {
    fn name(&self) -> &'static str {
        "paper-all"
    }

    fn interval(&self, seen: &CellStatistics) -> f64 {
        let n_block = seen.block_events + seen.block_events_after_gap;
        let n_free = seen.free_events + seen.free_events_after_gap;
        equation_1(seen, n_block, n_free)
    }
}
