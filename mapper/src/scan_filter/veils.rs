//! Veils: hits between two surfaces, where nothing is. A beam that meets the edge of a near surface hits it in part, and
//! in part the surface behind: the laser reports a range between both.

use interfaces::Scan;

/// Marks veils as invalid: the hits within a jump of the range. The near edge of a jump stays, and its far end. A thing
/// that is one beam wide is a jump in and a jump out, and stays as well.
pub(super) fn remove(scan: &mut Scan, min_angle_rad: f64) {
    if min_angle_rad <= 0.0 {
        return;
    }
    let jumps = jumps(scan, min_angle_rad.tan());
    let beams = jumps.len();
    for beam in 0..beams {
        let (before, after) = (jumps[(beam + beams - 1) % beams], jumps[beam]);
        if before * after > 0 {
            scan.ranges_m[beam] = f32::NAN;
        }
    }
}

/// For each beam whether the range jumps between it and the next beam: 1 away, −1 back, 0 where it does not.
fn jumps(scan: &Scan, min_tangent: f64) -> Vec<i8> {
    let beams = scan.ranges_m.len();
    let step = interfaces::rotation(scan.angle_increment_rad.abs());
    let jump = |beam: usize| {
        if beam + 1 == beams && !scan.is_full_turn() {
            return 0;
        }
        let [first, second] = [beam, (beam + 1) % beams].map(|beam| f64::from(scan.ranges_m[beam]));
        let [near, far] = [first.min(second), first.max(second)];
        // The line between both hits has these components across and along the beam of the farther one.
        let is_jump = near * step.im < min_tangent * (far - near * step.re);
        match first.is_finite() && second.is_finite() && is_jump {
            true if second > first => 1,
            true => -1,
            false => 0,
        }
    };
    (0..beams).map(jump).collect()
}
