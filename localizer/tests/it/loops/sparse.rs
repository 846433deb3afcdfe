//! Scans that are far from each other, as in many public logs.

use super::*;

/// A scan per meter, and per some tens of degrees in the corners.
const STRIDE: usize = 20;

/// A trip with a scan per meter, and a turn that the odometry misses halfway, rad.
fn sparse_trip(corridor: &mut Corridor, rounds: f64, seed: u64, missed_rad: f64) -> Trip {
    let start = corridor.at(0.0);
    let mut odometry = Odometry::new(start, seed);
    let mut finder = TrajectoryFinder::new(&TrajectorySettings::default()).unwrap();
    let steps = (rounds * corridor.round_m() / (SPEED_MPS * PERIOD_S)) as usize;
    let (mut truth, mut local) = (Vec::new(), Vec::new());
    for step in 0..steps {
        let pose = corridor.at(step as f64 * SPEED_MPS * PERIOD_S);
        let by_odometry = odometry.moved_to(&pose);
        if step == steps / 2 {
            odometry.jump(&interfaces::pose(0.0, 0.0, missed_rad));
        }
        if step % STRIDE == 0 {
            let mut reading = corridor.reading(step as f64 * PERIOD_S, pose);
            reading.pose = by_odometry;
            finder.add(reading);
            truth.push(start.inv_mul(&pose));
            local.push(finder.local_pose());
        }
    }
    let drift_m = (odometry.pose.translation.vector - corridor.at(0.0).translation.vector).norm();
    Trip { trajectory: finder.finish(), local, truth, drift_m, per_scan_ms: 0.0 }
}

#[test]
fn a_scan_per_meter_is_enough() {
    let mut corridor = ahead(Corridor::new([15.0, 11.0], Plan::Varied, 108));
    let error_m = sparse_trip(&mut corridor, 1.2, 108, 0.0).report("50 m, a scan per meter");
    assert!(error_m < 0.1, "{error_m} m");
}

#[test]
fn a_turn_that_the_odometry_misses_is_found() {
    let mut corridor = Corridor::new([15.0, 11.0], Plan::Varied, 109);
    let error_m = sparse_trip(&mut corridor, 1.2, 109, 1.4).report("50 m, a turn of 80° is missed");
    assert!(error_m < 0.1, "{error_m} m");
}
