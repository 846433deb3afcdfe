//! How surfels are learned from scans with a certain pose.

use super::SurfelMap;
use crate::changing_map::ChangingMap;
use crate::constants::{
    CLEARANCE_M, FROZEN_SCANS, MIN_NOISE_M, SETTLED_SCANS, STDS, SURFEL_M, TRUSTED_SCANS,
};
use crate::scan_points::ScanPoint;
use nalgebra::Isometry2;

impl SurfelMap {
    /// Updates the map with a scan, whose new surfels count as seen in a number of scans: those of a keyframe, which represents all
    /// scans around it, take part in matching at once. If `follows`, surfels follow surfaces that have moved; else, what seems to
    /// have moved stays where it is.
    pub(crate) fn learn(
        &mut self,
        points: &[ScanPoint],
        pose: &Isometry2<f64>,
        range_noise_std_m: f64,
        scans: u32,
        follows: bool,
    ) {
        let gate_m = STDS * range_noise_std_m.max(MIN_NOISE_M);
        self.scan = self.scan.wrapping_add(1);
        for point in points {
            let (at, normal) = (pose * point.at, pose.rotation * point.normal);
            match self.nearest(&at, &normal, gate_m) {
                Some((index, _)) => self.hit(index, &at, &normal),
                None => match self.nearest(&at, &normal, CLEARANCE_M) {
                    None => {
                        self.add(at, normal, scans);
                    }
                    Some((index, off_m)) if follows => self.displace(index, off_m),
                    Some(_) => {}
                },
            }
        }
    }

    fn hit(&mut self, index: u32, at: &nalgebra::Point2<f64>, normal: &nalgebra::Vector2<f64>) {
        let surfel = &mut self.surfels[index as usize];
        (surfel.misses, surfel.displaced, surfel.is_doubted) = (0, 0, false);
        if surfel.has_moved && surfel.scans >= SETTLED_SCANS {
            surfel.has_moved = false;
        }
        if surfel.scans >= FROZEN_SCANS && !surfel.has_moved {
            return;
        }
        surfel.scans += u32::from(surfel.last_scan != self.scan);
        surfel.last_scan = self.scan;
        surfel.hits += 1;
        let share =
            1.0 / f64::from(if surfel.has_moved { surfel.hits.min(TRUSTED_SCANS) } else { surfel.hits });
        surfel.at += (at - surfel.at) * share;
        let mean = surfel.normal + (normal - surfel.normal) * share;
        let length = mean.norm();
        if length > 0.0 {
            surfel.normal = mean / length;
        }
    }

    /// Takes over the learned rates of change as weights.
    pub(crate) fn weigh_by_rates(&mut self, map: &dyn ChangingMap, horizon_s: f64) {
        let states = map.states();
        for surfel in self.surfels.iter_mut().filter(|surfel| !surfel.is_removed()) {
            // The map counts a hit a little behind the surface.
            let behind = surfel.at - surfel.normal * (0.2 * SURFEL_M);
            let cell = states.frame().index(states.frame().cell_at(&behind));
            let rate = cell.map_or(0.0, |index| map.rate(index));
            surfel.steadiness = libm::exp(-rate * horizon_s).clamp(0.0, 1.0);
        }
    }
}
