use crate::physics::spec::BumperSpec;
use nalgebra::{Isometry2, Point2};
use std::f64::consts::TAU;

/// The bumpers, as bits, of a robot at `pose` that a contact presses. `ends` are the ends of the line of contact, m.
pub(crate) fn pressed(spec: &BumperSpec, pose: &Isometry2<f64>, ends: &[Point2<f64>; 2]) -> u64 {
    let [a, b] = ends.map(|end| pose.inverse_transform_point(&end).coords);
    let turn_rad = libm::atan2(a.perp(&b), a.dot(&b));
    let right = if turn_rad < 0.0 { b } else { a };
    let right_rad = libm::atan2(right.y, right.x);
    let sector_rad = spec.fov_rad / spec.sectors as f64;
    let is_pressed = |sector: usize| {
        let begin_rad = sector as f64 * sector_rad - spec.fov_rad / 2.0;
        // Two angular ranges overlap where one of them begins within the other.
        (right_rad - begin_rad).rem_euclid(TAU) < sector_rad
            || (begin_rad - right_rad).rem_euclid(TAU) < turn_rad.abs()
    };
    (0..spec.sectors).filter(|sector| is_pressed(*sector)).fold(0, |pressed, sector| pressed | 1 << sector)
}
