//! `--state`: a run goes on from a file as if it had never ended.

use crate::run::{Ended, Run, Summary, wait_until};
use std::fs;

const SHORT: &str = "--quiet --no-rrd --state a.state --duration";

/// A run with a state after 4 s.
fn begun(arguments: &str) -> Run {
    let run = Run::new();
    run.goes_well(&format!("{SHORT} 4 {arguments}"));
    run
}

/// All results of a run that do not depend on how it was started.
fn results(run: &Run) -> (serde_json::Value, Vec<u8>) {
    let Summary(mut summary) = run.summary();
    for key in ["arguments", "wall_s", "real_time_factor"] {
        summary.as_object_mut().unwrap().remove(key);
    }
    (summary, fs::read(run.out("cell_statistics.csv")).unwrap())
}

#[test]
fn a_run_in_two_parts_equals_a_whole_one() {
    for arguments in
        ["--seed 100", "--world drifting_house --strategy coin --seed 101", "--drive tour --pose odometry"]
    {
        let parts = begun(arguments);
        assert_eq!(parts.summary().number("/simulated_s").round(), 4.0);
        parts.goes_well(&format!("{SHORT} 12 {arguments}"));
        let whole = Run::quiet(&format!("--duration 12 {arguments}"));
        assert!(results(&parts) == results(&whole), "{arguments}");
        // A state that has come so far already only writes its results again.
        let saved = fs::read(parts.path("a.state")).unwrap();
        parts.goes_well(&format!("{SHORT} 12 {arguments}"));
        assert!(results(&parts) == results(&whole) && fs::read(parts.path("a.state")).unwrap() == saved);
        assert_eq!(parts.names(), ["a.state", "a.state.earlier", "out"]);
    }
}

#[test]
fn a_state_of_something_else_is_refused_and_stays() {
    let run = begun("");
    let saved = fs::read(run.path("a.state")).unwrap();
    let refused = |arguments: &str| run.refuses(&format!("--state a.state {arguments}"));
    insta::assert_snapshot!(refused("--world house"), @"error: a.state: the state is of another run: `world` is `four rooms` there, and `house` here");
    insta::assert_snapshot!(refused("--seed 3"), @"error: a.state: the state is of another run: `seed` is `0` there, and `3` here");
    insta::assert_snapshot!(refused("--strategy recency"), @"error: a.state: the state is of another run: `--strategy` is `curious` there, and `recency` here");
    insta::assert_snapshot!(refused("--estimator paper"), @"error: a.state: the state is of another run: `mapper.estimator` is `shared-prior` there, and `paper` here");
    insta::assert_snapshot!(refused("--occupancy naive"), @"error: a.state: the state is of another run: `mapper.occupancy` is `steady` there, and `naive` here");
    insta::assert_snapshot!(refused("--pose localized"), @"error: a.state: the state is of another run: `pose` is `exact` there, and `localized` here");
    insta::assert_snapshot!(refused("--drive tour"), @"error: a.state: the state is of another run: `--drive` is `agent` there, and `tour` here");
    assert_eq!(fs::read(run.path("a.state")).unwrap(), saved);
    let half = &saved[..saved.len() / 2];
    fs::write(run.path("a.state"), half).unwrap();
    insta::assert_snapshot!(refused(""), @"error: a.state: the state file is damaged: its checksum does not fit");
    assert_eq!(fs::read(run.path("a.state")).unwrap(), half);
}

#[test]
fn states_and_bags_that_cannot_be_written_end_before_the_run() {
    let run = Run::new();
    insta::assert_snapshot!(run.refuses("--state missing/a.state"), @"error: missing/a.state: cannot use it: No such file or directory (os error 2)");
    insta::assert_snapshot!(run.refuses("--mcap no/such/run.mcap"), @"error: cannot write the bag of --mcap: cannot write no/such/run.mcap: No such file or directory (os error 2)");
    run.refuses("--state-every 5");
}

/// Killed again and again at any point, even while it saves: the file is complete, and the run comes to its end.
#[test]
#[cfg(unix)]
fn a_killed_run_goes_on() {
    use crate::ending::send;
    use nix::sys::signal::Signal;

    let run = Run::new();
    let slow = "--no-rrd --state a.state --state-every 0.05 --duration 1h --speed 40";
    let modified = || fs::metadata(run.path("a.state")).and_then(|file| file.modified()).ok();
    let mut last_s = 0.0;
    for round in 0..6_u64 {
        let (before, child) = (modified(), run.starts(slow));
        // Until it has saved, and a little longer.
        wait_until(|| modified() != before);
        std::thread::sleep(std::time::Duration::from_millis(37 * round));
        send(if round < 5 { Signal::SIGKILL } else { Signal::SIGINT }, &child);
        let ended = Ended::of(child);
        assert_eq!(ended.code, (round == 5).then_some(130), "{ended:?}");
        // The first line says where it began.
        let began = ended.stderr.lines().find_map(|line| line.strip_prefix("the run goes on from "));
        let began_s: f64 = began.map_or(0.0, |text| text.trim_end_matches(" s").parse().unwrap());
        // On a busy machine a round can be killed before it gets anywhere.
        assert!(began_s >= last_s, "{began_s} after {last_s}");
        last_s = began_s;
    }
    assert!(last_s > 0.0 && run.summary().number("/simulated_s") > last_s);
    // A complete state whose run was killed before it had its name stays: somebody could have named it so.
    let mut names = run.names();
    names.retain(|name| !name.contains(".unfinished"));
    assert_eq!(names, ["a.state", "a.state.earlier", "out"]);
}
