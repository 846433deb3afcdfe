//! `map_log --state`: what was learned from logs stays, and later logs add to it.

use crate::map_log::standing_log;
use crate::run::{Ended, Run, Summary, names, wait_until};
use std::collections::BTreeMap;
use std::fs;

const QUIET: &str = "--quiet --no-rrd";
const SAVED: &str = "--quiet --no-rrd --state a.state";
/// 2023-11-14 22:13:20 UTC.
const MONDAY_S: f64 = 1.7e9;
const TUESDAY_S: f64 = MONDAY_S + 86_400.0;

/// All results but the recording, by name; of the summary, what does not depend on how the run was started.
fn results(run: &Run) -> BTreeMap<String, Vec<u8>> {
    let Summary(mut summary) = run.summary();
    for key in ["arguments", "wall_s", "files"] {
        summary.as_object_mut().unwrap().remove(key);
    }
    let names =
        names(&run.path("out")).into_iter().filter(|name| name != "summary.json" && run.out(name).is_file());
    let file = |name: String| (name.clone(), fs::read(run.out(&name)).unwrap());
    let mut files: BTreeMap<_, _> = names.map(file).collect();
    files.insert("summary.json".to_owned(), summary.to_string().into_bytes());
    files
}

/// The names of the results that differ.
fn differing(one: &BTreeMap<String, Vec<u8>>, other: &BTreeMap<String, Vec<u8>>) -> Vec<String> {
    let names: std::collections::BTreeSet<&String> = one.keys().chain(other.keys()).collect();
    names.into_iter().filter(|name| one.get(*name) != other.get(*name)).cloned().collect()
}

/// A folder with the logs `a.log` and `b.log` of a laser that stands, a day apart.
fn with_logs() -> Run {
    let run = Run::of("map_log");
    run.write("a.log", &standing_log(MONDAY_S, 120));
    run.write("b.log", &standing_log(TUESDAY_S, 90));
    run
}

#[test]
fn a_log_of_the_next_day_adds_to_the_state() {
    let run = with_logs();
    run.goes_well(&format!("a.log b.log {QUIET}"));
    let whole = results(&run);
    run.goes_well(&format!("a.log {SAVED}"));
    assert_eq!(run.summary().number("/scans"), 120.0);
    run.goes_well(&format!("b.log {SAVED}"));
    // The trajectory is that of the run.
    assert_eq!(differing(&results(&run), &whole), ["trajectory.tum"]);
    assert_eq!(fs::read_to_string(run.out("trajectory.tum")).unwrap().lines().count(), 90);

    // What is learned already only writes the results again, whatever its name is, and with whatever logs it comes.
    fs::rename(run.path("a.log"), run.path("other.log")).unwrap();
    assert_eq!(run.goes_well(&format!("b.log other.log {SAVED}")).stderr, "", "no note if quiet");
    run.goes_well("b.log other.log --no-rrd --state a.state").says(&[
        "note: other.log is learned already\nnote: b.log is learned already\nnote: nothing is added; the results show what was learned before, without a trajectory\n"
    ]);
    assert_eq!(differing(&results(&run), &whole), ["trajectory.png", "trajectory.tum"]);
    assert_eq!(run.names(), ["a.state", "a.state.earlier", "b.log", "other.log", "out"]);
}

#[test]
fn drives_of_one_place_add_up_and_a_robot_with_drifting_odometry_finds_its_place_in_the_state() {
    let run = Run::new();
    for (name, seed) in [("a", 100), ("b", 101)] {
        let world = format!("--world drifting_house --seed {seed} --duration 40 --mcap {name}.mcap");
        run.goes_well(&format!("{QUIET} {world}"));
    }
    let run = run.with("map_log");
    run.goes_well(&format!("a.mcap {SAVED}"));
    let once = run.summary();
    run.goes_well(&format!("b.mcap {SAVED}"));
    let parts = results(&run);
    let ended = run.goes_well("a.mcap b.mcap --no-rrd");
    assert_eq!(differing(&parts, &results(&run)), ["trajectory.png", "trajectory.tum"]);
    let both = run.summary();
    assert_eq!(both.number("/scans"), 2.0 * once.number("/scans"));
    assert!(both.number("/seen_m2") > 0.95 * once.number("/seen_m2"));
    // Both begin at 0. The hour between them counts as not observed.
    let note = "the time between a.mcap and b.mcap is not known and counts as an hour";
    ended.says(&[note]);
    assert!(both.at("/notes").as_array().unwrap().contains(&serde_json::json!(note)));
    assert!(run.cells().iter().all(|cell| cell.watched_s() <= 80.0 + 1e-6), "of 80 s of logs");

    // The same log under another name, and the same scans in other bytes, would count twice.
    fs::copy(run.path("a.mcap"), run.path("c.mcap")).unwrap();
    let twice = "error: c.mcap is given twice: it has the content of a.mcap\n";
    assert_eq!(run.refuses(&format!("a.mcap c.mcap {QUIET}")), twice);
    fs::remove_file(run.path("c.mcap")).unwrap(); // no run has written the copy
    run.goes_well(&format!("a.mcap {QUIET} --mcap c.mcap"));
    assert!(run.refuses(&format!("a.mcap c.mcap {QUIET}")).contains("have the same scans"));
}

/// Killed again and again at any point, even while it saves: the same command goes on, and its results are those of a run
/// that was never interrupted, bit for bit.
#[test]
#[cfg(unix)]
fn a_killed_run_goes_on_and_ends_as_if_it_had_not_been_killed() {
    use crate::ending::send;
    use nix::sys::signal::Signal;

    const SCANS: u32 = 12_000;
    let run = Run::of("map_log");
    run.write("a.log", &standing_log(MONDAY_S, 1000));
    run.write("b.log", &standing_log(TUESDAY_S, SCANS));
    run.goes_well(&format!("a.log b.log {QUIET}"));
    let whole = results(&run);
    let command = "a.log b.log --no-rrd --state a.state --state-every 0.02";
    let modified = || fs::metadata(run.path("a.state")).and_then(|file| file.modified()).ok();
    let (mut killed, mut froms) = (0, Vec::new());
    for round in 0..8_u64 {
        let before = modified();
        let mut child = run.starts(command);
        // Until it has saved, and a little longer.
        wait_until(|| modified() != before || child.try_wait().unwrap().is_some());
        std::thread::sleep(std::time::Duration::from_millis(17 * round));
        // Now and then in good order.
        let signal = if round % 4 == 3 { Signal::SIGINT } else { Signal::SIGKILL };
        if child.try_wait().unwrap().is_none() {
            send(signal, &child);
        }
        let ended = Ended::of(child);
        assert!(matches!(ended.code, None | Some(0 | 130)), "{ended:?}");
        killed += usize::from(ended.code != Some(0));
        froms.extend(ended.stderr.lines().filter_map(|line| {
            let from = line.strip_prefix("b.log: learning what changes, from scan ")?;
            from.strip_suffix(" on")?.parse::<u32>().ok()
        }));
    }
    assert!(killed >= 2, "{killed} runs were killed");
    assert!(froms.is_sorted() && froms.iter().all(|from| *from <= SCANS), "{froms:?}");
    run.goes_well(&format!("{command} --quiet"));
    let allowed = ["trajectory.png", "trajectory.tum"];
    let differing = differing(&results(&run), &whole);
    assert!(differing.iter().all(|name| allowed.contains(&name.as_str())), "{differing:?}");
    // A complete state whose run was killed before it had its name stays: somebody could have named it so.
    let mut names = run.names();
    names.retain(|name| !name.contains(".unfinished"));
    assert_eq!(names, ["a.log", "a.state", "b.log", "out"]);
}

#[test]
#[cfg(unix)]
fn an_interrupted_run_keeps_its_part_and_goes_on_with_the_same_trajectory() {
    let run = Run::of("map_log");
    run.write("a.log", &standing_log(MONDAY_S, 100));
    run.write("b.log", &standing_log(TUESDAY_S, 12_000));
    run.goes_well(&format!("a.log b.log {QUIET}"));
    let whole = results(&run);
    let is_second = |line: &str| line == "b.log: learning what changes";
    assert_eq!(run.interrupted("a.log b.log --no-rrd --state a.state", is_second).code, Some(130));
    let scans = run.summary().number("/scans");
    assert!((101.0..12_100.0).contains(&scans), "{scans}");

    // Nothing can follow a log that is learned in part, unless it is taken out of the state.
    run.write("c.log", &standing_log(TUESDAY_S + 86_400.0, 60));
    let kept = fs::read(run.path("a.state")).unwrap();
    let part = scans - 100.0;
    let expected = format!(
        "error: b.log is learned in part ({part} of 12000 scans): give it as well, then it goes on from there, or take it out \
         of the state by state_file remove\n"
    );
    assert_eq!(run.refuses(&format!("c.log {SAVED}")), expected);
    assert!(fs::read(run.path("a.state")).unwrap() == kept);
    run.goes_well(&format!("a.log b.log {SAVED}"));
    assert_eq!(differing(&results(&run), &whole), [""; 0]);

    run.goes_well(&format!("a.log {QUIET} --state b.state"));
    assert_eq!(run.interrupted("b.log --no-rrd --state b.state", is_second).code, Some(130));
    let run = run.with("state_file");
    run.goes_well("remove b.state b.log");
    let run = run.with("map_log");
    run.goes_well(&format!("c.log {QUIET} --state b.state"));
    assert_eq!(run.summary().number("/scans"), 160.0);
}

#[test]
fn a_state_that_does_not_fit_is_refused_and_stays() {
    let run = with_logs();
    run.write("early.log", &standing_log(MONDAY_S - 86_400.0, 30));
    run.goes_well(&format!("a.log {SAVED}"));
    let saved = fs::read(run.path("a.state")).unwrap();
    let refused = |arguments: &str| {
        let message = run.refuses(&format!("{arguments} {SAVED}"));
        assert!(fs::read(run.path("a.state")).unwrap() == saved);
        message
    };
    insta::assert_snapshot!(refused("b.log --resolution 0.1"), @"error: a.state: the state is of another run: `survey.resolution_m` is `0.05` there, and `0.1` here");
    insta::assert_snapshot!(refused("b.log --pose localized"), @"error: a.state: the state is of another run: `survey.pose` is `exact` there, and `localized` here");
    insta::assert_snapshot!(refused("b.log --estimator paper"), @"error: a.state: the state is of another run: `survey.mapper.estimator` is `shared-prior` there, and `paper` here");
    insta::assert_snapshot!(refused("early.log"), @"error: early.log begins before a.log has ended: logs of one robot follow each other");
    insta::assert_snapshot!(refused("b.log b.log"), @"error: b.log is given twice: it has the content of b.log");
}

#[test]
fn a_log_adds_to_the_map_of_a_robot() {
    let run = Run::new();
    run.goes_well(&format!("--duration 2 {SAVED}"));
    let run = run.with("map_log");
    run.write("a.log", &standing_log(MONDAY_S, 60));
    insta::assert_snapshot!(run.refuses(&format!("a.log {SAVED} --resolution 0.1")), @"error: a.state: the state is of another run: `resolution_m` is `0.05` there, and `0.1` here");
    let robot = fs::read(run.path("a.state")).unwrap();
    let ended = run.goes_well("a.log --no-rrd --state a.state");
    ended.says(&["note: a.state: other settings were used so far, those of this run count: "]);
    ended.says(&["filter.max_range_m = `10.0`"]);
    let run = run.with("state_file");
    let shown = run.goes_well("show a.state").stdout;
    let sessions: Vec<&str> = shown.lines().filter(|line| line.contains("scans learned")).collect();
    assert!(sessions.len() == 2 && sessions[0].starts_with("  four_rooms 1:"), "{shown}");
    assert!(sessions[1].starts_with("  a.log: 2023-11-14 22:13 UTC"), "{shown}");
    run.goes_well("remove a.state a.log");
    assert!(fs::read(run.path("a.state")).unwrap() == robot);
    let run = run.with("map_log");
    insta::assert_snapshot!(run.refuses(&format!("a.log {QUIET} --state missing/b.state")), @"error: missing/b.state: cannot use it: No such file or directory (os error 2)");
    run.goes_well(&format!("a.log {QUIET} --state b.state"));
    let run = run.with("four_rooms");
    insta::assert_snapshot!(run.refuses(&format!("--duration 2 {QUIET} --state b.state")), @"error: b.state: the state was saved by another program: it has no part `run`");
}

#[test]
fn another_laser_is_noted() {
    let run = Run::of("map_log");
    run.write("a.log", &standing_log(MONDAY_S, 60));
    run.goes_well(&format!("a.log {SAVED}"));
    // Every other beam.
    let line = |line: &str| -> String {
        let fields: Vec<&str> = line.split(' ').collect();
        if fields[0] != "FLASER" {
            return format!("{line}\n");
        }
        let beams: Vec<&str> = fields[2..182].iter().copied().chain(["3.00"]).collect();
        format!("FLASER 181 {} {}\n", beams.join(" "), fields[182..].join(" "))
    };
    let text: String = standing_log(TUESDAY_S, 60).lines().map(line).collect();
    run.write("b.log", &text);
    let ended = run.goes_well("b.log --no-rrd --state a.state");
    let note = "the laser of b.log is not that of a.log: 181 beams over 180°, not 180 beams over 179°; where it sees another \
                plane, differences count as changes";
    ended.says(&[&format!("note: {note}\n")]);
    assert!(run.summary().at("/notes").as_array().unwrap().contains(&serde_json::json!(note)));
}

#[test]
#[cfg(unix)]
fn a_pipe_is_no_state() {
    let run = with_logs();
    nix::unistd::mkfifo(&run.path("pipe"), nix::sys::stat::Mode::S_IRWXU).unwrap();
    insta::assert_snapshot!(run.refuses(&format!("a.log {QUIET} --state pipe")), @"error: pipe: cannot read it: it is not a regular file (but a folder, a pipe or a device)");
    let run = run.with("state_file");
    insta::assert_snapshot!(run.refuses("show pipe"), @"error: pipe: cannot read it: it is not a regular file (but a folder, a pipe or a device)");
}

#[test]
fn the_last_log_can_be_removed_and_another_one_cannot() {
    let run = with_logs();
    run.goes_well(&format!("a.log {SAVED}"));
    let before = fs::read(run.path("a.state")).unwrap();
    run.goes_well(&format!("b.log {SAVED}"));
    let run = run.with("state_file");
    let shown = run.goes_well("show a.state").stdout;
    let lines: Vec<&str> = shown.lines().filter(|line| !line.starts_with("  place ")).collect();
    insta::assert_snapshot!(lines.join("\n"), @r"
    a.state
      a.log: 2023-11-14 22:13 UTC, 2 min, 120 of 120 scans learned, 180 beams over 179°
      b.log: 2023-11-15 22:13 UTC, 89 s, 90 of 90 scans learned, 180 beams over 179°
      can be removed: b.log
    ");
    let settings = run.goes_well("show a.state --settings").stdout;
    assert!(settings.contains("  survey.resolution_m = 0.05\n"), "{settings}");
    insta::assert_snapshot!(run.refuses("remove a.state a.log"), @"error: a.log cannot be removed: what was learned from all logs is one map, and only b.log was added last; map the other logs into a new file by map_log --state");
    insta::assert_snapshot!(run.refuses("remove a.state c.log"), @"error: a.state holds no session c.log, but a.log, b.log");
    insta::assert_snapshot!(run.goes_well("remove a.state logs/b.log").stdout, @"b.log is removed: a.state is as it was before");
    assert!(fs::read(run.path("a.state")).unwrap() == before);
    insta::assert_snapshot!(run.refuses("remove a.state a.log"), @"error: a.log is the only session in a.state: remove the file");
    let run = run.with("map_log");
    run.goes_well(&format!("b.log {SAVED}"));
    assert_eq!(run.summary().number("/scans"), 210.0);
}

/// The log of a robot that moves along a room of 8 m × 6 m with a pillar; its times do not say when it was recorded.
pub(crate) fn moving_log(scans: u32) -> String {
    let line = |step: u32| {
        let (x, time_s) = (0.03 * f64::from(step) - 2.0, 5.0 + 0.1 * f64::from(step));
        let range_m = |beam: u32| {
            let (sin, cos) = (f64::from(beam) - 90.0).to_radians().sin_cos();
            let wall =
                |ahead: f64, direction: f64| if direction.abs() < 1e-9 { 99.0 } else { ahead / direction };
            let walls = [wall(4.0 - x, cos), wall(3.0, sin), wall(-3.0, sin)]
                .into_iter()
                .filter(|range| *range > 0.0);
            // A pillar of 0.3 m at (2.5, 1).
            let along = (2.5 - x) * cos + sin;
            let half = 0.09 - ((2.5 - x).powi(2) + 1.0 - along * along);
            let pillar = if half > 0.0 && along > 0.0 { along - half.sqrt() } else { 99.0 };
            walls.fold(pillar, f64::min)
        };
        let ranges: String = (0..180).map(|beam| format!("{:.3} ", range_m(beam))).collect();
        let pose = format!("{x:.4} 0 0");
        format!("ODOM {pose} 0.3 0 0 {time_s:.2} h 0\nFLASER 180 {ranges}{pose} {pose} {time_s:.2} h 0\n")
    };
    (0..scans).map(line).collect()
}

/// A log and its own halves would count twice.
#[test]
fn a_log_of_which_the_halves_are_learned_is_refused() {
    let run = Run::of("map_log");
    let log = moving_log(120);
    let lines: Vec<&str> = log.lines().collect();
    let half = 120; // of each scan there are two lines
    run.write("a.log", &lines[..half].join("\n"));
    run.write("b.log", &lines[half..].join("\n"));
    run.write("whole.log", &log);
    run.goes_well(&format!("a.log {SAVED}"));
    run.goes_well(&format!("b.log {SAVED}"));
    insta::assert_snapshot!(run.refuses(&format!("whole.log {SAVED}")), @"error: whole.log and a.log have the same scans, which would count twice: leave one of them out");
    insta::assert_snapshot!(run.refuses(&format!("b.log whole.log {QUIET}")), @"error: whole.log and b.log have the same scans, which would count twice: leave one of them out");
}
