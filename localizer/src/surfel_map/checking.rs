//! Surfels that are no longer there are removed.

use super::SurfelMap;
use crate::beams::ranges_around;
use crate::constants::{CHECK_TURNS, CLEARANCE_M, FAR_M, MIN_INCIDENCE, SURFEL_M, THICK_M};
use interfaces::LaserReading;
use nalgebra::{Isometry2, Point2};

/// A beam that passes a surfel counts as this many of what may stand in front.
const PASSED_COUNTS: u32 = 4;
/// Scans that made a surfel for each scan that is needed to remove it.
const SCANS_PER_MISS: u32 = 20;

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
        self.turn = (self.turn + 1) % CHECK_TURNS;
        for index in (self.turn..map.surfels.len()).step_by(CHECK_TURNS) {
            let surfel = &map.surfels[index];
            let to = surfel.at - origin;
            let distance_m = to.norm();
            if surfel.is_removed()
                || distance_m > scan.range_max_m.min(FAR_M)
                || -surfel.normal.dot(&to) < MIN_INCIDENCE * distance_m
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
            let is_passed = nearest_m > distance_m + THICK_M;
            let is_displaced =
                farthest_m < distance_m - SURFEL_M / 2.0 && nearest_m > distance_m - CLEARANCE_M;
            // A displaced surface can also be something in front, and counts a quarter.
            let surfel = &mut map.surfels[index];
            surfel.misses += if is_passed { PASSED_COUNTS } else { u32::from(is_displaced) };
            if surfel.misses > PASSED_COUNTS * (2 + surfel.scans / SCANS_PER_MISS) {
                map.remove(index as u32);
            }
        }
    }
}
