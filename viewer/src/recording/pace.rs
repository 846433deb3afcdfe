//! How often each part of a run is logged.

use crate::scene::TimeUnit;
use interfaces::GridFrame;

/// Where time is counted in steps, images with more cells than this are logged less often: a viewer holds
/// 20,000 images of this size in 50 MB.
const STEP_CELLS: usize = 2500;

/// Times between two rows, in the unit of the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    unit: TimeUnit,
    /// Of fields of view.
    pub(super) sight: f64,
    /// Of occupancy maps.
    pub(super) occupancy: f64,
    /// Of the other maps.
    pub(super) maps: f64,
    /// Of points of a curve.
    pub(super) curves: f64,
    /// Of sending: maps at hundreds of times real time fill the memory.
    pub(super) flush: f64,
}

impl Pace {
    pub(super) fn of(unit: TimeUnit) -> Self {
        match unit {
            TimeUnit::Second => {
                Self { unit, sight: 0.2, occupancy: 1.0, maps: 10.0, curves: 1.0, flush: 60.0 }
            }
            // Single steps are of interest, and a run has thousands.
            TimeUnit::Step => {
                Self { unit, sight: 1.0, occupancy: 1.0, maps: 20.0, curves: 10.0, flush: 2000.0 }
            }
        }
    }

    /// The time between two images of the cells of `frame`.
    pub(super) fn picture(&self, period: f64, frame: &GridFrame) -> f64 {
        match self.unit {
            TimeUnit::Second => period,
            TimeUnit::Step => period * frame.len().div_ceil(STEP_CELLS) as f64,
        }
    }
}
