//! `map_log`: logs and bags become maps of what changes.

use crate::run::{Run, names};
use std::fs;
use std::sync::LazyLock;

/// A folder for `map_log` with `a.mcap`: a bag of a robot with drifting odometry in a house, for 90 s.
pub(crate) fn with_bag() -> Run {
    static DRIVE: LazyLock<Run> =
        LazyLock::new(|| Run::quiet("--world drifting_house --seed 101 --duration 90 --mcap a.mcap"));
    let run = Run::of("map_log");
    fs::copy(DRIVE.path("a.mcap"), run.path("a.mcap")).unwrap();
    run
}

#[test]
fn a_bag_becomes_a_page_maps_masks_and_numbers() {
    let run = with_bag();
    let ended = run.goes_well("a.mcap --mcap copy.mcap");
    ended.prints(&["a.mcap: 901 scans in 90 s", "  route ", "  seen ", "  changes ", "  files     out"]);
    let expected = "cell_statistics.csv change_probability.png figure5.png interval.png keepout_mask.pgm \
                    keepout_mask.yaml map.pgm map.yaml map_log.rrd occupancy.png \
                    permanent.pgm permanent.yaml predicted.png recency.png report.html speed_mask.pgm \
                    speed_mask.yaml summary.json things.json trajectory.png trajectory.tum";
    let mut expected: Vec<&str> = expected.split(' ').collect();
    assert_eq!(names(&run.path("out")), expected);
    let summary = run.summary();
    expected.retain(|name| *name != "summary.json");
    assert_eq!(summary.0["files"], serde_json::json!(expected));
    assert_eq!(summary.number("/scans"), 901.0);
    assert!((30.0..110.0).contains(&summary.number("/seen_m2")), "{}", summary.number("/seen_m2"));
    assert!(summary.number("/scans_left_out") < 30.0);
    let poses = fs::read_to_string(run.out("trajectory.tum")).unwrap();
    assert_eq!(poses.lines().count(), 901);
    let page = fs::read_to_string(run.out("report.html")).unwrap();
    for text in ["This map is good", "Where it changes", "901 scans in 2 min", "never seen"] {
        assert!(page.contains(text), "{text}");
    }

    // The same bag gives the same map, bit for bit. The copy has the same readings, but for the last bits of headings.
    let (cells, seen_m2) = (fs::read(run.out("cell_statistics.csv")).unwrap(), summary.number("/seen_m2"));
    run.goes_well("a.mcap --quiet --no-rrd");
    assert!(fs::read(run.out("cell_statistics.csv")).unwrap() == cells);
    run.goes_well("copy.mcap --quiet --no-rrd");
    let copied_m2 = run.summary().number("/seen_m2");
    assert!((copied_m2 / seen_m2 - 1.0).abs() < 0.005, "{copied_m2} and {seen_m2} m²");
}

/// Along the odometry, whose heading drifts, walls are there twice.
#[test]
fn a_map_that_is_not_usable_says_so() {
    let run = with_bag();
    run.goes_well("a.mcap --quiet --no-rrd --state a.state");
    let (state, summary) = (fs::read(run.path("a.state")).unwrap(), run.summary());
    assert_eq!((summary.text("/verdict"), summary.at("/verdict_reasons")), ("good", &serde_json::json!([])));

    let ended = run.ends("a.mcap --pose odometry --no-rrd --state other.state");
    assert_eq!(ended.code, Some(3), "{}", ended.stderr);
    ended.prints(&["  map       not usable\n            - "]);
    let summary = run.summary();
    assert_eq!((summary.text("/verdict"), summary.at("/is_refused")), ("not-usable", &true.into()));
    assert!(summary.0["quality"][0]["doubts"].as_array().is_some_and(|doubts| !doubts.is_empty()));
    let page = fs::read_to_string(run.out("report.html")).unwrap();
    assert!(["This map is not usable", "Uncertain places of the map"].iter().all(|text| page.contains(text)));
    assert!(!page.contains("per hour"));
    let found = names(&run.path("out"));
    assert!(found.contains(&"map.pgm".to_owned()));
    assert!(!found.iter().any(|name| name.contains("mask") || name.contains("statistics")), "{found:?}");
    assert!(!run.path("other.state").exists() && fs::read(run.path("a.state")).unwrap() == state);

    run.goes_well("a.mcap --pose odometry --no-rrd --state other.state --accept-map");
    assert!(run.path("other.state").exists() && run.out("speed_mask.pgm").exists());
}

/// A CARMEN log of a laser that stands before a wall, in a room 6 m wide: something is before it for every other 10 s.
pub(crate) fn standing_log(begin_s: f64, seconds: u32) -> String {
    let line = |step: u32| standing_line(begin_s + f64::from(step), (step / 10).is_multiple_of(2));
    (0..seconds).map(line).collect()
}

/// One scan of this log. What is `near` is 0.35 m wide.
pub(crate) fn standing_line(time_s: f64, near: bool) -> String {
    scan_line(time_s, |beam| match f64::from(beam).to_radians().sin_cos() {
        _ if near && (80..100).contains(&beam) => 1.0,
        (ahead, aside) => (4.0 / ahead.max(1e-9)).min(3.0 / aside.abs().max(1e-9)),
    })
}

/// A scan of a laser that stands, with the ranges of 180 beams, a degree apart.
pub(crate) fn scan_line(time_s: f64, range_m: impl Fn(u32) -> f64) -> String {
    let ranges: String = (0..180).map(|beam| format!("{:.2} ", range_m(beam))).collect();
    format!("ODOM 1 2 0 0 0 0 {time_s} h 0\nFLASER 180 {ranges}0 0 0 0 0 0 {time_s} h 0\n")
}

#[test]
fn a_thing_that_comes_and_goes_from_the_first_scan_on_is_a_place_with_its_rate() {
    let run = Run::of("map_log");
    let (mut lines, mut time_s, mut scans) = (String::new(), 0.0, 0);
    for stay in 0..180_u32 {
        // 0.8 to 1.2 s, in an order without a pattern.
        time_s += 0.8 + f64::from(stay * stay % 41) / 100.0;
        while f64::from(scans) * 0.1 < time_s {
            lines += &standing_line(1.7e9 + f64::from(scans) * 0.1, stay.is_multiple_of(2));
            scans += 1;
        }
    }
    run.write("a.log", &lines);
    run.goes_well("a.log --no-rrd --quiet");
    let summary = run.summary();
    let place = &summary.0["places"][0];
    let number = |key: &str| place[key].as_f64().unwrap();
    assert_eq!(summary.0["places"].as_array().unwrap().len(), 1, "{place}");
    assert!(number("area_m2") < 0.02 && number("changes") > 170.0, "{place}");
    assert!((number("cycles_per_hour") / (90.0 / time_s * 3600.0) - 1.0).abs() < 0.05, "{place}");
}

#[test]
fn a_parked_robot_is_a_laser_that_stands_and_the_page_has_dates() {
    let run = Run::of("map_log");
    // 2023-11-14 22:13:20 UTC.
    run.write("a.log", &standing_log(1.7e9, 120));
    run.write("b.log", &standing_log(1.7e9 + 86_400.0, 120));
    run.goes_well("b.log a.log --no-rrd --quiet --mcap out/run.mcap");
    let summary = run.summary();
    assert_eq!(summary.0["settings"]["pose"], "exact");
    assert_eq!((summary.number("/begin_s"), summary.number("/scans")), (1.7e9, 240.0));
    assert_eq!(summary.0["logs"], serde_json::json!(["a.log", "b.log"]));
    assert!(summary.0["files"].as_array().unwrap().contains(&serde_json::json!("run.mcap")));
    assert!(summary.number("/changes") > 100.0);
    let page = fs::read_to_string(run.out("report.html")).unwrap();
    for text in ["from 2023-11-14 22:13 UTC on", "2023-11-15 22:1"] {
        assert!(page.contains(text), "{text}: {page}");
    }
    // The bag of the run is a log of the next one, which does not remove it.
    run.goes_well("out/run.mcap --no-rrd --quiet");
    assert_eq!(run.summary().number("/scans"), 240.0);
    assert!(run.out("run.mcap").exists());
}

#[cfg(unix)]
#[test]
fn the_numbers_of_an_interrupted_run_are_those_of_its_part() {
    const SCANS: u32 = 30_000;
    let run = Run::of("map_log");
    run.write("a.log", &standing_log(1.7e9, SCANS));
    let ended = run.interrupted("a.log --no-rrd", |line| line.contains("learning what changes"));
    assert_eq!(ended.code, Some(130), "{ended:?}");
    let summary = run.summary();
    let scans = summary.number("/scans");
    assert!((1.0..f64::from(SCANS)).contains(&scans), "{scans} scans");
    assert_eq!(summary.number("/duration_s"), scans - 1.0);
    let page = fs::read_to_string(run.out("report.html")).unwrap();
    assert!(page.contains("the maps and the numbers are of the part of the logs up to then"));
    assert!(page.contains(&format!("{scans} scans in")), "{page}");
}

#[test]
fn an_invalid_path_of_the_bag_is_found_at_once() {
    let run = Run::of("map_log");
    run.write("a.log", &standing_log(1.7e9, 30));
    let refused = |path: &str| run.refuses(&format!("a.log --no-rrd --mcap {path}"));
    insta::assert_snapshot!(refused("no/such/folder.mcap"), @"error: cannot write the bag of --mcap: cannot write no/such/folder.mcap: No such file or directory (os error 2)");
    insta::assert_snapshot!(refused("a.log"), @"error: --mcap a.log would replace a log that is read, or be in its folder; choose another name");
    insta::assert_snapshot!(refused("out/map.pgm"), @"error: cannot write out/map.pgm: in the folder of the results its name must end in .mcap");
}

#[cfg(unix)]
#[test]
fn an_interrupt_in_the_first_pass_says_what_happened() {
    let run = with_bag();
    for (state, kept) in
        [("", ""), (" --state s", "; s keeps the logs that are finished, and the same command goes on")]
    {
        let ended = run.interrupted(&format!("a.mcap{state}"), |line| line.contains("first pass"));
        assert_eq!(ended.code, Some(130), "{ended:?}");
        let says = format!("interrupted in the first pass: no results are written{kept}\n");
        assert!(ended.stderr.ends_with(&says), "{ended:?}");
    }
}
