use super::spec::BumperSpec;
use nalgebra::{Isometry2, Point2};

/// The bumpers that a touch at a place (m) presses, of a robot at `pose`, as bits; none if the ring
/// does not reach there.
pub(super) fn pressed(spec: &BumperSpec, pose: &Isometry2<f64>, at: &Point2<f64>) -> u64 {
    let local = pose.inverse_transform_point(at);
    let share = libm::atan2(local.y, local.x) / spec.fov_rad + 0.5;
    if !(0.0..=1.0).contains(&share) {
        return 0;
    }
    // The left end of the ring belongs to the last bumper.
    1 << ((share * spec.sectors as f64) as usize).min(spec.sectors - 1)
}
