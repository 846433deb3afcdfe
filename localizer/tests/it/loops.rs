//! Trajectories around loops, with a known truth and hard drift.

mod online;
mod scaled;
mod sparse;
mod world;

use crate::robot::{Odometry, PERIOD_S};
use interfaces::LaserReading;
use localizer::{LocalizerSettings, PoseState, Trajectory, TrajectoryFinder};
use nalgebra::{Isometry2, Vector2};
use std::f64::consts::TAU;
use world::{Corridor, Plan};

/// The speed of the robot, m/s.
const SPEED_MPS: f64 = 0.5;

/// The same corridor with 181 beams ahead, as the lasers of many logs.
fn ahead(corridor: Corridor) -> Corridor {
    corridor.with_laser(181, 181_f64.to_radians())
}

/// The result of a trip.
struct Trip {
    trajectory: Trajectory,
    /// The poses by matching with local submaps alone.
    local: Vec<Isometry2<f64>>,
    truth: Vec<Isometry2<f64>>,
    /// The error of the odometry at the end, m.
    drift_m: f64,
}

fn finder() -> TrajectoryFinder {
    TrajectoryFinder::new(&LocalizerSettings::of_logs()).unwrap()
}

/// A drive along the corridor.
struct Drive {
    from_m: f64,
    /// Its length, in rounds.
    rounds: f64,
    seed: u64,
    /// A scan per this number of steps of [`PERIOD_S`].
    stride: usize,
    /// A turn that the odometry misses halfway, rad.
    missed_rad: f64,
}

/// What was measured on a drive, and the true poses.
struct Driven {
    readings: Vec<LaserReading>,
    truth: Vec<Isometry2<f64>>,
    drift_m: f64,
}

impl Drive {
    /// A scan per step, from the begin of the corridor on.
    fn new(rounds: f64, seed: u64) -> Self {
        Self { from_m: 0.0, rounds, seed, stride: 1, missed_rad: 0.0 }
    }

    fn along(&self, corridor: &mut Corridor) -> Driven {
        let steps = (self.rounds * corridor.round_m() / (SPEED_MPS * PERIOD_S)) as usize;
        let at = |corridor: &Corridor, step| corridor.at(self.from_m + step as f64 * SPEED_MPS * PERIOD_S);
        let start = at(corridor, 0);
        let mut odometry = Odometry::new(start, self.seed);
        let (mut readings, mut truth) = (Vec::new(), Vec::new());
        for step in 0..steps {
            let true_pose = at(corridor, step);
            let pose = odometry.moved_to(&true_pose);
            if step == steps / 2 && self.missed_rad != 0.0 {
                odometry.jump(&interfaces::pose(0.0, 0.0, self.missed_rad));
            }
            if step % self.stride == 0 {
                let reading = corridor.reading(step as f64 * PERIOD_S, true_pose);
                readings.push(LaserReading { pose, ..reading });
                truth.push(start.inv_mul(&true_pose));
            }
        }
        let off = odometry.pose.translation.vector - at(corridor, steps - 1).translation.vector;
        Driven { readings, truth, drift_m: off.norm() }
    }
}

impl Driven {
    /// The trajectory that a finder finds, with a fault of the sensors.
    fn found(&self, mut finder: TrajectoryFinder, fault: impl Fn(&mut LaserReading)) -> Trip {
        let mut local = Vec::new();
        for mut reading in self.readings.iter().cloned() {
            fault(&mut reading);
            finder.add(reading);
            local.push(finder.local_pose());
        }
        Trip { trajectory: finder.finish(), local, truth: self.truth.clone(), drift_m: self.drift_m }
    }
}

/// A trip around a corridor, and on past the start.
fn trip(corridor: &mut Corridor, rounds: f64, seed: u64) -> Trip {
    trip_with(corridor, rounds, seed, |_| {})
}

/// The same, with a fault of the sensors.
fn trip_with(corridor: &mut Corridor, rounds: f64, seed: u64, fault: impl Fn(&mut LaserReading)) -> Trip {
    Drive::new(rounds, seed).along(corridor).found(finder(), fault)
}

impl Trip {
    /// The same trip, by matching with local submaps alone.
    fn without_loops(mut self) -> Self {
        for (found, local) in self.trajectory.poses.iter_mut().zip(&self.local) {
            found.pose = *local;
        }
        self
    }

    /// The errors of the positions, after a rigid alignment or from the first pose, the least first, m.
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

    /// The errors that these shares of the positions do not exceed, m.
    fn quantiles_m<const N: usize>(&self, is_aligned: bool, shares: [f64; N]) -> [f64; N] {
        let errors_m = self.errors_m(is_aligned);
        shares.map(|share| errors_m[(share * (errors_m.len() - 1) as f64) as usize])
    }

    /// The error that 95 % of the positions do not exceed, m.
    fn error_m(&self) -> f64 {
        self.quantiles_m(true, [0.95])[0]
    }

    /// The number of readings whose scan supports their pose.
    fn tracked(&self) -> usize {
        self.trajectory.poses.iter().filter(|pose| pose.state == PoseState::Tracking).count()
    }
}

#[test]
fn a_loop_of_50_m_is_closed() {
    let mut corridor = Corridor::new([15.0, 11.0], Plan::Varied, 100);
    let trip = trip(&mut corridor, 1.15, 100);
    let error_m = trip.error_m();
    assert!(trip.drift_m > 1.0 && trip.trajectory.loops > 0);
    assert!(error_m < 0.02, "{error_m} m");
    assert_eq!(trip.tracked(), trip.truth.len());
}

#[test]
fn the_sweep_of_scans_is_undone_on_the_way() {
    let errors_m = [false, true].map(|sweeps| {
        let corridor = ahead(Corridor::new([15.0, 11.0], Plan::Varied, 107));
        let mut corridor = if sweeps { corridor.sweeping() } else { corridor };
        let trip = trip(&mut corridor, 1.0, 107).without_loops();
        trip.error_m()
    });
    assert!(errors_m[1] < 0.1 && errors_m[1] < 2.0 * errors_m[0], "{errors_m:?}");
}

#[test]
fn corridors_that_look_the_same_are_not_confused() {
    // The same niche every 4 m: a place is recognized by the corners only.
    let mut corridor = ahead(Corridor::new([31.0, 20.0], Plan::Repeated, 105));
    let trip = trip(&mut corridor, 1.2, 105);
    let error_m = trip.error_m();
    assert!(error_m < 0.2, "{error_m} m");
}

#[test]
fn the_same_readings_give_the_same_bits() {
    let run = || {
        let mut corridor = Corridor::new([8.0, 5.0], Plan::Varied, 101).with_laser(120, TAU);
        let trip = trip(&mut corridor, 1.3, 101);
        format!("{:?}", trip.trajectory)
    };
    assert_eq!(run(), run());
}

/// A reading with something wrong.
fn broken(mut reading: LaserReading, fault: usize, step: usize) -> LaserReading {
    match fault {
        0 => reading.scan.ranges_m.fill(f32::NAN),
        1 => reading.scan.ranges_m.fill(0.2),
        2 => reading.pose.translation.x = f64::NAN,
        3 => reading.time_s = -100.0,
        4 => reading.scan.ranges_m.truncate(step % 3),
        5 => reading.pose.translation.x += 1e5,
        6 => reading.scan.angle_increment_rad = f64::INFINITY,
        7 => reading.scan.sweep_s = f64::NAN,
        _ => reading.scan.ranges_m.reverse(),
    }
    reading
}

#[test]
fn faults_of_the_sensors_have_a_pose_and_end() {
    for fault in 0..9 {
        let mut corridor = Corridor::new([15.0, 11.0], Plan::Varied, 102).with_laser(180, TAU);
        let mut finder = finder();
        let start = corridor.at(0.0);
        let mut last = Isometry2::identity();
        for step in 0..300 {
            let pose = corridor.at(step as f64 * SPEED_MPS * PERIOD_S);
            let reading = corridor.reading(step as f64 * PERIOD_S, pose);
            let is_broken = step == 0 || (100..110).contains(&step);
            finder.add(if is_broken { broken(reading, fault, step) } else { reading });
            last = start.inv_mul(&pose);
        }
        let trajectory = finder.finish();
        assert_eq!(trajectory.poses.len(), 300);
        assert!(trajectory.poses.iter().all(|pose| interfaces::is_valid_pose(&pose.pose)), "fault {fault}");
        let end = trajectory.poses[299];
        assert_eq!(end.state, PoseState::Tracking, "fault {fault}");
        // Other faults move the origin.
        if [0, 1, 3].contains(&fault) {
            let error_m = (end.pose.translation.vector - last.translation.vector).norm();
            assert!(error_m < 0.3, "fault {fault}: {error_m} m");
        }
    }
}

#[test]
fn without_odometry_the_scans_are_enough() {
    let mut corridor = Corridor::new([15.0, 11.0], Plan::Varied, 106);
    let trip = trip_with(&mut corridor, 1.15, 106, |reading| reading.pose = Isometry2::identity());
    let error_m = trip.error_m();
    assert!(error_m < 0.05, "{error_m} m");
}

/// Some lasers see nothing while they start.
#[test]
fn a_trip_begins_with_the_first_scan_that_shows_something() {
    for has_odometry in [false, true] {
        let mut corridor = Corridor::new([15.0, 11.0], Plan::Varied, 106);
        let trip = trip_with(&mut corridor, 0.3, 106, |reading| {
            if reading.time_s < 5.0 * PERIOD_S {
                reading.scan.ranges_m.fill(f32::NAN);
            }
            if !has_odometry {
                reading.pose = Isometry2::identity();
            }
        });
        assert_eq!(trip.tracked(), trip.truth.len(), "odometry: {has_odometry}");
        let [worst_m] = trip.quantiles_m(true, [1.0]);
        // Without odometry, nothing shows how far the robot moved before.
        let unseen_m = 5.0 * SPEED_MPS * PERIOD_S;
        assert!(worst_m < 0.05 + if has_odometry { 0.0 } else { unseen_m }, "{worst_m} m");
    }
}

#[test]
fn no_reading_has_no_trajectory() {
    assert!(finder().finish().poses.is_empty());
    let settings = LocalizerSettings { range_noise_std_m: f64::NAN, ..LocalizerSettings::of_logs() };
    assert_eq!(TrajectoryFinder::new(&settings).unwrap_err().key, "range_noise_std_m");
}

/// ```text
/// cargo test -p curious-localizer --test it loops::long -- --ignored --nocapture
/// ```
#[test]
#[ignore = "takes minutes"]
fn long_loops_are_closed() {
    let loops = [([30.0, 23.0], 1.1), ([62.0, 41.0], 1.05), ([85.0, 18.0], 1.05), ([62.0, 41.0], 2.0)];
    let mut worst_m: f64 = 0.0;
    for (plan, seeds) in [(Plan::Varied, 100..103), (Plan::Repeated, 103..105)] {
        for ((sides_m, rounds), seed) in
            loops.iter().flat_map(|case| seeds.clone().map(move |seed| (*case, seed)))
        {
            for looks_ahead in [false, true] {
                let corridor = Corridor::new(sides_m, plan, seed);
                let mut corridor = if looks_ahead { ahead(corridor) } else { corridor };
                let laser = if looks_ahead { "181 beams ahead" } else { "360 beams" };
                let name =
                    format!("{:.0} m, {rounds} rounds, {plan:?}, seed {seed}, {laser}", corridor.round_m());
                let trip = trip(&mut corridor, rounds, seed);
                let [aligned_m, from_start_m] =
                    [true, false].map(|is_aligned| trip.quantiles_m(is_aligned, [0.5, 0.95, 1.0]));
                println!(
                    "{name}: drift {:.1} m, aligned {aligned_m:.3?} m, from the start {from_start_m:.3?} m",
                    trip.drift_m
                );
                worst_m = worst_m.max(trip.error_m());
            }
        }
    }
    assert!(worst_m < 0.15, "{worst_m} m");
}
