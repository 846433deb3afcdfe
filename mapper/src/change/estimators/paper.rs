//! Equation 1 of the paper (section 3): T = min(T_block, T_free), with
//! T_block = (t_last − t_unobserved − t_init) / n_block, and the same for T_free with n_free.
//!
//! The two processes are coupled and have one rate: the cycle time is the smaller interval, that of the process
//! with more events. A change that is found after a gap does not count: the gap is no part of the time.

use super::Estimator;
use crate::change::CellStatistics;

/// `paper`: equation 1 with the changes in view.
#[derive(Clone, Copy, Debug)]
pub struct Paper;

impl Estimator for Paper {
    fn name(&self) -> &'static str {
        "paper"
    }

    fn interval(&self, seen: &CellStatistics) -> f64 {
        seen.observed() / f64::from(seen.cycles())
    }
}
