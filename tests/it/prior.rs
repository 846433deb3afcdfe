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

#[test]
fn a_map_that_shows_nothing_of_the_world_is_refused() {
    let run = Run::new();
    run.write("m.pgm", "P2\n2 2\n255\n0 254 254 254\n");
    let thresholds = "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196";
    for origin in ["100.0, 0.0", "-3.0, 5.0"] {
        let map = format!("image: m.pgm\nresolution: 0.25\norigin: [{origin}, 0.0]\n{thresholds}\n");
        run.write("m.yaml", &map);
        insta::allow_duplicates! {
            insta::assert_snapshot!(run.refuses("--quiet --no-rrd --duration 1 --map m.yaml"), @"error: m.yaml: the map shows nothing of the world `four rooms`: check `origin` and `resolution`");
        }
    }
}
