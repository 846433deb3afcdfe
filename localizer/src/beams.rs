use interfaces::{Scan, approximate_atan2};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// The ranges (m) of the beam that is nearest to a direction, given by a vector in the frame of the laser, and of the
/// beams before and after it; `None` if the scan does not have all three.
pub(crate) fn ranges_around(scan: &Scan, toward: &Vector2<f64>) -> Option<[f64; 3]> {
    let turn = (approximate_atan2(toward.y, toward.x) - scan.angle_min_rad) / scan.angle_increment_rad;
    let turns = TAU / scan.angle_increment_rad.abs();
    let beam = (turn - turns * (turn / turns).floor()).round() as usize;
    if beam == 0 || beam >= scan.ranges_m.len().saturating_sub(1) {
        return None;
    }
    Some([beam - 1, beam, beam + 1].map(|beam| f64::from(scan.ranges_m[beam])))
}
