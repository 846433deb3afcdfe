//! Trajectories around loops, with a known truth and hard drift.

mod world;

use crate::robot::{Odometry, PERIOD_S};
use localizer::{Trajectory, TrajectoryFinder, TrajectorySettings};
use nalgebra::{Isometry2, Vector2};
use world::{Corridor, Plan};

/// The speed of the robot, m/s.
const SPEED_MPS: f64 = 0.5;

/// The result of a trip.
struct Trip {
    trajectory: Trajectory,
    truth: Vec<Isometry2<f64>>,
    /// The error of the odometry at the end, m.
    drift_m: f64,
    per_scan_ms: f64,
}

/// A trip around a corridor, and on past the start.
fn trip(corridor: &mut Corridor, rounds: f64, settings: &TrajectorySettings, seed: u64) -> Trip {
    let start = corridor.at(0.0);
    let mut odometry = Odometry::new(start, seed);
    let mut finder = TrajectoryFinder::new(settings).unwrap();
    let end_m = rounds * corridor.round_m();
    let steps = (end_m / (SPEED_MPS * PERIOD_S)) as usize;
    let (mut truth, mut elapsed) = (Vec::new(), std::time::Duration::ZERO);
    for step in 0..steps {
        let pose = corridor.at(step as f64 * SPEED_MPS * PERIOD_S);
        let mut reading = corridor.reading(step as f64 * PERIOD_S, pose);
        reading.pose = odometry.moved_to(&pose);
        truth.push(start.inv_mul(&pose));
        let begin = std::time::Instant::now();
        finder.add(reading);
        elapsed += begin.elapsed();
    }
    let begin = std::time::Instant::now();
    let trajectory = finder.finish();
    elapsed += begin.elapsed();
    let last = start * truth[steps - 1];
    let drift_m = (odometry.pose.translation.vector - last.translation.vector).norm();
    Trip { trajectory, truth, drift_m, per_scan_ms: elapsed.as_secs_f64() * 1e3 / steps as f64 }
}

impl Trip {
    /// The errors of the positions after a rigid alignment, the least first, m.
    fn errors_m(&self, is_aligned: bool) -> Vec<f64> {
        let found: Vec<Vector2<f64>> =
            self.trajectory.poses.iter().map(|pose| pose.pose.translation.vector).collect();
        let truth: Vec<Vector2<f64>> = self.truth.iter().map(|pose| pose.translation.vector).collect();
        let mean = |of: &[Vector2<f64>]| of.iter().sum::<Vector2<f64>>() / of.len() as f64;
        let (from, to) = (mean(&found), mean(&truth));
        let (mut dot, mut cross) = (0.0, 0.0);
        for (a, b) in found.iter().zip(&truth) {
            dot += (a - from).dot(&(b - to));
            cross += (a - from).perp(&(b - to));
        }
        let rotation = interfaces::rotation(cross.atan2(dot));
        let error = |(a, b): (&Vector2<f64>, &Vector2<f64>)| match is_aligned {
            true => (rotation * (a - from) - (b - to)).norm(),
            false => (a - b).norm(),
        };
        let mut errors_m: Vec<f64> = found.iter().zip(&truth).map(error).collect();
        errors_m.sort_by(f64::total_cmp);
        errors_m
    }

    fn report(&self, name: &str) -> f64 {
        let [raw_m, aligned_m] = [false, true].map(|is_aligned| self.errors_m(is_aligned));
        let at =
            |errors_m: &[f64], share: f64| errors_m[(share * (errors_m.len() - 1) as f64) as usize] * 100.0;
        println!(
            "{name}: odometry off by {:.1} m at the end; {} loops; median / 95 % / max {:.1} / {:.1} / {:.1} cm from the \
             start, {:.1} / {:.1} / {:.1} cm aligned; {:.2} ms per scan",
            self.drift_m,
            self.trajectory.loops,
            at(&raw_m, 0.5),
            at(&raw_m, 0.95),
            at(&raw_m, 1.0),
            at(&aligned_m, 0.5),
            at(&aligned_m, 0.95),
            at(&aligned_m, 1.0),
            self.per_scan_ms
        );
        at(&aligned_m, 0.95) / 100.0
    }
}

#[test]
fn a_loop_of_50_m_is_closed() {
    let mut corridor = Corridor::new([15.0, 11.0], Plan::Varied, 100);
    let trip = trip(&mut corridor, 1.15, &TrajectorySettings::default(), 100);
    let error_m = trip.report("50 m");
    assert!(trip.drift_m > 1.0 && trip.trajectory.loops > 0);
    assert!(error_m < 0.1, "{error_m} m");
}

/// ```text
/// cargo test -p localizer --test it loops:: -- --ignored --nocapture
/// ```
#[test]
#[ignore = "takes minutes"]
fn long_loops_are_closed() {
    for (sides_m, rounds) in
        [([30.0, 23.0], 1.1), ([62.0, 41.0], 1.05), ([85.0, 18.0], 1.05), ([62.0, 41.0], 2.0)]
    {
        for seed in 100..103 {
            for (beams, fov_deg) in [(360, 360.0_f64), (181, 181.0)] {
                let mut corridor =
                    Corridor::new(sides_m, Plan::Varied, seed).with_laser(beams, fov_deg.to_radians());
                let name =
                    format!("{:.0} m, {rounds} rounds, seed {seed}, {beams} beams", corridor.round_m());
                let trip = trip(&mut corridor, rounds, &TrajectorySettings::default(), seed);
                trip.report(&name);
            }
        }
    }
}

#[test]
#[ignore = "scratch"]
fn scratch() {
    for seed in 100..104 {
        for beams in [360, 181] {
            for sides_m in [[62.0, 41.0], [31.0, 31.0]] {
                for close_loops in [false, true] {
                    let fov_rad = if beams == 360 { std::f64::consts::TAU } else { 181_f64.to_radians() };
                    let mut corridor =
                        Corridor::new(sides_m, Plan::Repeated, seed).with_laser(beams, fov_rad);
                    let settings = TrajectorySettings { close_loops, ..TrajectorySettings::default() };
                    let trip = trip(&mut corridor, 1.3, &settings, seed);
                    trip.report(&format!("seed {seed} beams {beams} {sides_m:?} {close_loops}"));
                }
            }
        }
    }
}
