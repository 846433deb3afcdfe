//! Surfels that are no longer there are removed.

use super::{CELL_M, SurfelMap};
use crate::beams::ranges_around;
use interfaces::LaserReading;
use nalgebra::{Isometry2, Point2};

/// One of this many surfels is checked per scan.
const TURNS: usize = 10;
/// A beam passes a surfel if it ends at least this far behind, m.
const PASSED_M: f64 = 0.15;
/// A surfel whose surface is seen displaced by less than this, m, moved.
const DISPLACED_M: f64 = 0.25;
/// Beams that graze a surfel say nothing: the least cosine of the angle of incidence.
const LEAST_INCIDENCE: f64 = 0.3;

/// Checks the surfels against scans, a few per scan.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct Checker {
    turn: usize,
}

impl Checker {
    /// Checks some surfels against a scan at a certain pose: a surfel that beams pass, again and again, is removed; the
    /// more often it was hit before, the later.
    pub(crate) fn check(&mut self, map: &mut SurfelMap, reading: &LaserReading, pose: &Isometry2<f64>) {
        let laser = pose * reading.mount;
        let origin = Point2::from(laser.translation.vector);
        let to_laser = laser.rotation.inverse();
        let scan = &reading.scan;
        if scan.ranges_m.len() < 3 {
            return;
        }
        self.turn = (self.turn + 1) % TURNS;
        for index in (self.turn..map.surfels.len()).step_by(TURNS) {
            let surfel = &map.surfels[index];
            let to = surfel.at - origin;
            let distance_m = to.norm();
            if surfel.is_removed()
                || distance_m > scan.range_max_m.min(8.0)
                || -surfel.normal.dot(&to) < LEAST_INCIDENCE * distance_m
            {
                continue;
            }
            let Some(ranges) = ranges_around(scan, &(to_laser * to)) else { continue };
            // A missing range says nothing; no return means that the beam passed.
            if ranges.iter().any(|range_m| range_m.is_nan() || *range_m < scan.range_min_m) {
                continue;
            }
            let nearest_m = ranges.iter().fold(f64::INFINITY, |least, range_m| least.min(*range_m));
            let farthest_m = ranges.iter().fold(0.0, |most: f64, range_m| most.max(*range_m));
            let is_passed = nearest_m > distance_m + PASSED_M;
            let is_displaced = farthest_m < distance_m - CELL_M / 2.0 && nearest_m > distance_m - DISPLACED_M;
            map.contradict(index as u32, is_passed, is_displaced);
        }
    }
}

impl SurfelMap {
    /// Counts a contradiction: a displaced surface can also be something in front, and counts a quarter.
    fn contradict(&mut self, index: u32, is_passed: bool, is_displaced: bool) {
        let surfel = &mut self.surfels[index as usize];
        surfel.misses += if is_passed { 4 } else { u32::from(is_displaced) };
        if surfel.misses > 4 * (2 + surfel.scans / 20) {
            self.remove(index);
        }
    }
}
