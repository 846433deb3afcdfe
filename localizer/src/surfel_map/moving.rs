//! Surfels whose surface has moved.
//!
//! A surface that is seen a little off its place, scan after scan, at certain poses, has moved: its surfel follows it, and
//! counts little from then on. What has moved once will move again, and must not move the robot with it.

use super::{Surfel, SurfelMap};
use crate::constants::{
    CONFIRM_SCANS, MOVED_M, SAME_NORMAL, SUSPECT_WEIGHT, THICK_M, TRUSTED_SCANS, USABLE_SCANS,
};
use crate::scan_points::{ScanPoint, means};
use nalgebra::Isometry2;

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
