//! Points between two surfaces. A beam that meets the edge of a near surface hits it in part, and in part the surface
//! behind: the laser reports a range between both, where nothing is.

use interfaces::Scan;

/// Removes the hits whose line to the hit beside them is nearly parallel to the beam: both are marked as invalid. A
/// wall that is seen at such an angle is removed as well; it is seen again from elsewhere.
///
/// The rule, and the customary angle of 10°, are those of the shadow filter of the ROS package `laser_filters`.
pub fn remove_shadows(scan: &mut Scan, min_angle_rad: f64) {
    if min_angle_rad <= 0.0 {
        return;
    }
    let beams = scan.ranges_m.len();
    let step = interfaces::rotation(scan.angle_increment_rad.abs());
    let (sin, cos) = (step.im, step.re);
    let least_tangent = min_angle_rad.tan();
    // The pairs of neighbours: around the turn, where there is one.
    let last = if scan.is_full_turn() { beams } else { beams.saturating_sub(1) };
    let is_shadow = |scan: &Scan, beam: usize| {
        let [first, second] = [beam, (beam + 1) % beams].map(|beam| f64::from(scan.ranges_m[beam]));
        let is_hit = first.is_finite() && second.is_finite();
        // The line between both hits has these components across and along a beam. The angle is below the limit at the
        // farther hit if it is at either.
        let at = |near: f64, far: f64| (near * sin).abs() < least_tangent * (far - near * cos).abs();
        is_hit && (at(first, second) || at(second, first))
    };
    let shadows: Vec<usize> = (0..last).filter(|beam| is_shadow(scan, *beam)).collect();
    for beam in shadows {
        scan.ranges_m[beam] = f32::NAN;
        scan.ranges_m[(beam + 1) % beams] = f32::NAN;
    }
}
