//! Surfels whose surface has moved.
//!
//! A surface that is seen a little off its place, scan after scan, at certain poses, has moved: its surfel follows it, and
//! counts little from then on. What has moved once will move again, and must not move the robot with it.

use super::{Surfel, SurfelMap};
use crate::beams::ranges_around;
use crate::constants::{
    CHECK_TURNS, CLEARANCE_M, CONFIRM_SCANS, FAR_M, MIN_INCIDENCE, MOVED_M, SAME_NORMAL, SURFEL_M,
    SUSPECT_WEIGHT, THICK_M, TRUSTED_SCANS, USABLE_SCANS,
};
use crate::scan_points::{ScanPoint, means};
use interfaces::LaserReading;
use nalgebra::{Isometry2, Point2};

impl Surfel {
    /// The weight of the surfel in matching, from 0 to 1. What was seen only a few times may be a passer-by.
    pub(crate) fn weight(&self) -> f64 {
        if self.scans < USABLE_SCANS {
            return 0.0;
        }
        let seen = (f64::from(self.scans) / f64::from(TRUSTED_SCANS)).min(1.0);
        if self.is_suspect() { SUSPECT_WEIGHT * seen } else { seen }
    }

    /// Whether the surface has moved, or may have moved.
    pub(crate) fn is_suspect(&self) -> bool {
        self.has_moved || self.is_doubted
    }

    /// Whether the surface is known well, and was never seen to move.
    pub(crate) fn is_permanent(&self) -> bool {
        !self.is_suspect() && self.scans >= TRUSTED_SCANS / 2
    }
}

impl SurfelMap {
    /// Counts a point that lies `off_m` off its surfel.
    pub(super) fn displace(&mut self, index: u32, off_m: f64) {
        let scan = self.scan;
        let surfel = &mut self.surfels[index as usize];
        if off_m.abs() > MOVED_M || surfel.last_displaced == scan {
            return;
        }
        let is_next = surfel.last_displaced.wrapping_add(1) == scan;
        surfel.displaced = if is_next { surfel.displaced + 1 } else { 1 };
        surfel.last_displaced = scan;
        if surfel.has_moved || surfel.displaced >= CONFIRM_SCANS {
            self.follow(index, off_m);
        }
    }

    /// Much of the view has moved at once, as the pose `follower` of a robot that follows it shows: surfaces that are seen off
    /// their place by more than `min_m`, and lie better there, have moved. All others out of view may have moved.
    pub(crate) fn displace_all(
        &mut self,
        points: &[ScanPoint],
        pose: &Isometry2<f64>,
        follower: &Isometry2<f64>,
        min_m: f64,
    ) {
        let offsets_m = |pose: &Isometry2<f64>| {
            let off_m = |point: &ScanPoint| {
                let nearest = self.nearest(&(pose * point.at), &(pose.rotation * point.normal), MOVED_M);
                nearest.map(|(_, off_m)| off_m)
            };
            means(points, &points.iter().map(off_m).collect::<Vec<_>>())
        };
        let offsets_m = offsets_m(pose).into_iter().zip(offsets_m(follower));
        let mut moves: Vec<(u32, f64)> = Vec::new();
        for (point, offsets_m) in points.iter().zip(offsets_m) {
            let (Some(off_m), Some(follower_m)) = offsets_m else { continue };
            if off_m.abs() <= min_m || follower_m.abs() >= off_m.abs() {
                continue;
            }
            let (at, normal) = (pose * point.at, pose.rotation * point.normal);
            self.around(&at, THICK_M, |index, surfel| {
                let to = at - surfel.at;
                let is_near = to.norm() <= THICK_M && surfel.normal.dot(&to).abs() <= MOVED_M;
                if is_near && surfel.normal.dot(&normal) >= SAME_NORMAL {
                    moves.push((index, off_m));
                }
            });
        }
        moves.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.abs().total_cmp(&b.1.abs())));
        moves.dedup_by_key(|(index, _)| *index);
        for surfel in &mut self.surfels {
            surfel.is_doubted = true; // until it is hit
        }
        for (index, off_m) in moves {
            self.follow(index, off_m);
        }
    }

    /// Moves a surfel with its surface, across it.
    fn follow(&mut self, index: u32, off_m: f64) {
        let Surfel { at, normal, .. } = self.surfels[index as usize];
        self.remove(index);
        if let Some(index) = self.add(at + normal * off_m, normal, USABLE_SCANS) {
            self.surfels[index as usize].has_moved = true;
        }
    }
}

// Surfels that are no longer there are removed.

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
