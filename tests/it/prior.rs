//! A map that one run has written can be the start of the next run.

use crate::run::Run;

#[test]
fn a_known_map_is_right_from_the_start() {
    let run = Run::quiet("--duration 10m");
    let learned = run.summary();
    assert!(learned.curve()[0][2] < 0.5, "the first run knew something");

    run.goes_well("--quiet --no-rrd --duration 60 --seed 1 --map out/map.yaml --out again");
    let again = std::fs::read(run.path("again/summary.json")).unwrap();
    let again: serde_json::Value = serde_json::from_slice(&again).unwrap();
    let first = &again["curve"][0];
    assert!(first["map_quality"].as_f64().unwrap() > 0.98, "{first}");
    // A known cell does not count as seen.
    assert!(first["coverage"].as_f64().unwrap() < 0.5, "{first}");
    assert_eq!(again["false_change_events"], 0);
}
