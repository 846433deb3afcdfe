//! The readings of a laser: its limits, and other robots.

use super::*;

#[test]
fn limits_follow_rep_117() {
    let limits = "range_min_m = 2.0\nrange_max_m = 3.0";
    let spec = four_rooms_but(&[("range_min_m = 0.0 ", ""), ("range_max_m = 10.0", limits)], "");
    let text = spec.driven().laser;
    assert_eq!((text.range_min_m, text.range_max_m), (2.0, 3.0));
    let scan = PhysicsWorld::new(&spec, 0).sense().scan;
    // At [2, 2]: walls 1.9 m to the left and 3.95 m to the right.
    assert_eq!(scan.ranges_m[0], f32::NEG_INFINITY);
    assert_eq!(scan.ranges_m[360], f32::INFINITY);
    assert!((scan.ranges_m[90] - 1.9 * 2.0_f32.sqrt()).abs() < 1e-5);
}
