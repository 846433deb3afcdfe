//! Scans that are far from each other, as in many public logs.

use super::*;

/// A scan per meter, and per some tens of degrees in the corners.
const STRIDE: usize = 20;

/// A trip with a scan per meter, and a turn that the odometry misses halfway, rad.
fn sparse_trip(corridor: &mut Corridor, rounds: f64, seed: u64, missed_rad: f64) -> Trip {
    sparse_trip_in(&Isometry2::identity(), corridor, rounds, seed, missed_rad)
}

/// The same, with the odometry in a frame with this pose, rounded to micrometers as in a CARMEN log.
fn sparse_trip_in(
    frame: &Isometry2<f64>,
    corridor: &mut Corridor,
    rounds: f64,
    seed: u64,
    missed_rad: f64,
) -> Trip {
    let start = corridor.at(0.0);
    let mut odometry = Odometry::new(start, seed);
    let mut finder = finder();
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
            reading.pose = rounded(&(frame * by_odometry));
            finder.add(reading);
            truth.push(start.inv_mul(&pose));
            local.push(finder.local_pose());
        }
    }
    let drift_m = (odometry.pose.translation.vector - corridor.at(0.0).translation.vector).norm();
    Trip { trajectory: finder.finish(), local, truth, drift_m }
}

fn rounded(pose: &Isometry2<f64>) -> Isometry2<f64> {
    let round = |value: f64| (value * 1e6).round() / 1e6;
    let at = pose.translation.vector;
    interfaces::pose(round(at.x), round(at.y), round(interfaces::heading_rad(pose)))
}

#[test]
fn the_heading_of_the_frame_does_not_matter() {
    let trips = [0.0, 0.2, 0.4, 0.8].map(|heading_rad| {
        let mut corridor = ahead(Corridor::new([15.0, 11.0], Plan::Varied, 110));
        let frame = interfaces::pose(30.0, -20.0, heading_rad);
        sparse_trip_in(&frame, &mut corridor, 2.2, 110, 0.0)
    });
    let errors_m = trips.each_ref().map(|trip| trip.error_m());
    assert!(errors_m.iter().all(|error_m| *error_m < 0.1), "{errors_m:?}");
    for other in &trips[1..] {
        assert_eq!(other.trajectory.loops, trips[0].trajectory.loops);
        for (a, b) in trips[0].trajectory.poses.iter().zip(&other.trajectory.poses) {
            let off_m = (a.pose.translation.vector - b.pose.translation.vector).norm();
            assert!(off_m < 0.01, "{off_m} m");
        }
    }
}

#[test]
fn a_turn_that_the_odometry_misses_is_found() {
    let mut corridor = Corridor::new([15.0, 11.0], Plan::Varied, 109);
    let error_m = sparse_trip(&mut corridor, 1.2, 109, 1.4).error_m();
    assert!(error_m < 0.1, "{error_m} m");
}
