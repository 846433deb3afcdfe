//! How the robot knows its pose: `--pose`.

use crate::run::Run;

/// The error of the position that 95 % of the readings do not exceed, m, and how poses were known.
fn p95_m(run: &Run) -> (f64, String) {
    let summary = run.summary();
    (summary.number("/pose/p95_m"), summary.text("/pose/mode").to_owned())
}

#[test]
fn a_localizer_corrects_odometry_that_drifts() {
    let [localized, odometry, exact] = ["", "--pose odometry", "--pose exact"].map(|pose| {
        let run = Run::new();
        run.goes_well(&format!("--quiet --no-rrd --world drifting_house --duration 60 {pose}"));
        let lines = |name| std::fs::read_to_string(run.out(name)).unwrap().lines().count();
        assert_eq!([lines("trajectory.tum"), lines("trajectory_true.tum")], [601, 601]);
        p95_m(&run)
    });
    assert_eq!(exact, (0.0, "exact".to_owned()));
    assert!(localized.0 < 0.02 && localized.1 == "localized", "{localized:?}");
    assert!(odometry.0 > 0.1 && odometry.1 == "odometry", "{odometry:?}");
}

/// A localized robot has its own frame: walls are turned by any angle in it.
#[test]
fn every_shipped_world_runs_however_the_pose_is_known() {
    for (name, _) in worldfile::shipped::PHYSICS {
        for pose in ["exact", "odometry", "localized"] {
            let arguments = format!("--quiet --no-rrd --world {name} --duration 1 --pose {pose} --seed 2");
            Run::new().goes_well(&arguments);
        }
    }
}
