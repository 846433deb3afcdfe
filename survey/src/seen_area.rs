//! How much of a place is seen: whether its map will fit into the memory is known before it is made.

use crate::error::SurveyError;
use crate::extent::enough_m;
use crate::settings::SurveySettings;
use interfaces::{LaserReading, heading_rad};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};
use std::collections::HashSet;

/// The side of the squares that are counted, m.
const SIDE_M: f64 = 0.5;
/// Along a beam, a square is looked for after each of these steps, m.
const STEP_M: f64 = 0.25;
/// A reading counts when the robot has moved by this since the last one that did, m and rad.
const COUNTED_M: f64 = 1.0;
const COUNTED_RAD: f64 = 0.8;
/// The number of beams of a reading that count: 0.4 m apart at 20 m over half a turn.
const BEAMS: usize = 180;

/// The squares that a beam has crossed on the way to its hit. Those at the border count as a whole: thin places seem larger.
#[derive(Clone, Debug, Default)]
pub(crate) struct SeenArea {
    /// Only their number counts.
    squares: HashSet<(i32, i32)>,
    last: Option<Isometry2<f64>>,
}

impl SeenArea {
    /// Adds a reading that was filtered, with its pose in the map.
    pub(crate) fn add(&mut self, reading: &LaserReading, pose: &Isometry2<f64>) {
        if let Some(last) = &self.last {
            let since = last.inv_mul(pose);
            if since.translation.vector.norm() < COUNTED_M && heading_rad(&since).abs() < COUNTED_RAD {
                return;
            }
        }
        self.last = Some(*pose);
        let laser = pose * reading.mount * Point2::origin();
        let every = reading.scan.ranges_m.len().div_ceil(BEAMS);
        for hit in reading.hits().step_by(every.max(1)).map(|hit| pose * hit) {
            let mut last = None;
            let steps = ((hit - laser).norm() / STEP_M).ceil().max(1.0);
            for step in 0..=steps as u32 {
                let at = laser.lerp(&hit, f64::from(step) / steps) / SIDE_M;
                let square = (at.x.floor() as i32, at.y.floor() as i32);
                if last.replace(square) != Some(square) {
                    self.squares.insert(square);
                }
            }
        }
    }

    /// The area, m².
    pub(crate) fn m2(&self) -> f64 {
        self.squares.len() as f64 * SIDE_M * SIDE_M
    }
}

/// While a trajectory drifts, it sees places twice: this share of the area counts.
const SURE_SHARE: f64 = 0.5;

/// Checks whether the map of an area fits into the memory.
pub(crate) fn check(seen_m2: f64, settings: &SurveySettings) -> Result<(), SurveyError> {
    match bytes(seen_m2 * SURE_SHARE, settings) <= settings.mapper.max_bytes as f64 {
        true => Ok(()),
        false => Err(too_much(seen_m2, 0.0, settings)),
    }
}

fn bytes(seen_m2: f64, settings: &SurveySettings) -> f64 {
    seen_m2 / settings.resolution_m.powi(2) * Mapper::BYTES_PER_SEEN_CELL as f64
}

/// The error for an area whose map does not fit; `taken`: what the map takes, as far as that is known, bytes.
pub(crate) fn too_much(seen_m2: f64, taken: f64, settings: &SurveySettings) -> SurveyError {
    /// Cells that changed take more, and larger blocks follow the border of what was seen less closely.
    const MARGIN: f64 = 1.3;
    let (resolution_m, max_bytes) = (settings.resolution_m, settings.mapper.max_bytes);
    let share = MARGIN * bytes(seen_m2, settings).max(taken) / max_bytes as f64;
    SurveyError::TooMuchSeen { seen_m2, resolution_m, max_bytes, enough_m: enough_m(resolution_m, share) }
}
