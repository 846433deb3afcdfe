//! An odometry whose distances have a scale, in corridors that do not show it before the end.

use super::*;

/// The true distance per distance of the odometry; [`Odometry`] measures 5 % too much.
const TRUE_SCALE: f64 = 1.0 / 1.05;
/// A scan per 0.2 m.
const STRIDE: usize = 4;
/// The way from the corner behind, m: the laser sees neither end of the corridor.
const BARE_M: f64 = 11.0;

#[test]
fn a_scale_that_is_seen_at_the_end_corrects_the_begin() {
    for seed in [120, 121] {
        let mut corridor = Corridor::new([50.0, 8.0], Plan::OneSide, seed);
        // Along bare corridors and, at the end, along the one with niches and rooms.
        let from_m = 0.5 * corridor.round_m() + BARE_M;
        let driven = Drive { from_m, stride: STRIDE, ..Drive::new(0.76, seed) }.along(&mut corridor);
        let first = driven.found(finder(), |_| {});
        let before_m = first.error_m();
        let scale = first.trajectory.distance_scale.unwrap();
        let off = (scale.scale - TRUE_SCALE).abs();
        assert!(off < 0.015 && off < 4.0 * scale.std && scale.is_significant(), "{scale:?}");
        let after_m = driven.found(finder().with_distance_scale(&scale), |_| {}).error_m();
        assert!(after_m < 0.6 * before_m, "{before_m} m, then {after_m} m");
    }
}
