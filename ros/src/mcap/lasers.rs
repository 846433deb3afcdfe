//! Which scans come from one laser.

use interfaces::{LaserReading, heading_rad};
use nalgebra::Isometry2;

/// A laser that pans or tilts moves by less than this between two scans, m and rad. Two lasers with beams of the same number
/// and angles are farther apart.
const NEAR_M: f64 = 0.25;
const NEAR_RAD: f64 = 0.8;
/// A laser that moves faster is not counted again after this number of lasers.
const MAX_LASERS: usize = 8;

/// A laser: where it is mounted, and the number and the angles of its beams.
pub(super) struct Laser {
    pub(super) mount: Isometry2<f64>,
    beams: (usize, f64, f64),
}

impl Laser {
    pub(super) fn of(reading: &LaserReading) -> Self {
        let scan = &reading.scan;
        let beams = (scan.ranges_m.len(), scan.angle_min_rad, scan.angle_increment_rad);
        Self { mount: reading.mount, beams }
    }

    /// The number of the laser that was near, with the same beams.
    pub(super) fn moved_from(&self, known: &[Self]) -> Option<usize> {
        let step = |laser: &Self| laser.mount.inv_mul(&self.mount);
        let is_same = |laser: &Self| {
            let (step, is_full) = (step(laser), known.len() >= MAX_LASERS);
            let is_near = step.translation.vector.norm() < NEAR_M && heading_rad(&step).abs() < NEAR_RAD;
            laser.beams == self.beams && (is_near || is_full)
        };
        let away = |laser: &Self| step(laser).translation.vector.norm() + heading_rad(&step(laser)).abs();
        let same = known.iter().enumerate().filter(|(_, laser)| is_same(laser));
        same.min_by(|(_, a), (_, b)| away(a).total_cmp(&away(b))).map(|(number, _)| number)
    }
}
