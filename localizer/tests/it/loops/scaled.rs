//! An odometry whose distances have a scale, in corridors that do not show it before the end.

use super::*;
use localizer::DistanceScale;

/// The true distance per distance of the odometry; [`Odometry`] measures 5 % too much.
const TRUE_SCALE: f64 = 1.0 / 1.05;
/// A scan per 0.2 m.
const STRIDE: usize = 4;
/// The way from the corner behind, m: the laser sees neither end of the corridor.
const BARE_M: f64 = 11.0;

/// The readings along bare corridors and, at the end, along the one with niches and rooms; and the true poses.
fn readings(corridor: &mut Corridor, seed: u64) -> (Vec<LaserReading>, Vec<Isometry2<f64>>) {
    let start_m = 0.5 * corridor.round_m() + BARE_M;
    let start = corridor.at(start_m);
    let mut odometry = Odometry::new(start, seed);
    let steps = (0.76 * corridor.round_m() / (SPEED_MPS * PERIOD_S)) as usize;
    let (mut readings, mut truth) = (Vec::new(), Vec::new());
    for step in 0..steps {
        let pose = corridor.at(start_m + step as f64 * SPEED_MPS * PERIOD_S);
        let by_odometry = odometry.moved_to(&pose);
        if step % STRIDE == 0 {
            let reading = corridor.reading(step as f64 * PERIOD_S, pose);
            readings.push(LaserReading { pose: by_odometry, ..reading });
            truth.push(start.inv_mul(&pose));
        }
    }
    (readings, truth)
}

fn pass(readings: &[LaserReading], truth: &[Isometry2<f64>], scale: Option<&DistanceScale>) -> Trip {
    let mut finder = finder();
    if let Some(scale) = scale {
        finder = finder.with_distance_scale(scale);
    }
    let mut local = Vec::new();
    for reading in readings {
        finder.add(reading.clone());
        local.push(finder.local_pose());
    }
    Trip { trajectory: finder.finish(), local, truth: truth.to_vec(), drift_m: 0.0 }
}

#[test]
fn a_scale_that_is_seen_at_the_end_corrects_the_begin() {
    for seed in [120, 121] {
        let mut corridor = Corridor::new([50.0, 8.0], Plan::OneSide, seed);
        let (readings, truth) = readings(&mut corridor, seed);
        let first = pass(&readings, &truth, None);
        let before_m = first.error_m();
        let scale = first.trajectory.distance_scale.unwrap();
        let off = (scale.scale - TRUE_SCALE).abs();
        assert!(off < 0.015 && off < 4.0 * scale.std && scale.is_significant(), "{scale:?}");
        let after_m = pass(&readings, &truth, Some(&scale)).error_m();
        assert!(after_m < 0.6 * before_m, "{before_m} m, then {after_m} m");
    }
}
