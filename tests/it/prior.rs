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
fn a_map_of_another_place_is_reported() {
    let map = |origin: &str| {
        let run = Run::new();
        let walls: Vec<&str> = (0..48 * 48).map(|pixel| if pixel % 49 == 4 { "0" } else { "254" }).collect();
        run.write("m.pgm", &format!("P2\n48 48\n255\n{}\n", walls.join(" ")));
        let thresholds = "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196";
        run.write(
            "m.yaml",
            &format!("image: m.pgm\nresolution: 0.25\norigin: [{origin}, 0.0]\n{thresholds}\n"),
        );
        run.ends("--quiet --no-rrd --duration 1 --map m.yaml")
    };
    let other = map("0.0, 0.0");
    assert_eq!(other.code, Some(0), "{other:?}");
    insta::assert_snapshot!(other.stderr.trim_end(), @"
    warning: only 17 % of the walls and 100 % of the free space of the map agree with the world `four rooms`: it looks like a map of another place
      = help: the robot takes the map as its knowledge, and unlearns it cell by cell
    ");
    let far = map("100.0, 0.0");
    assert_eq!(far.code, Some(2), "{far:?}");
    insta::assert_snapshot!(far.stderr.trim_end(), @"error: m.yaml: the map shows nothing of the world `four rooms`: check `origin` and `resolution`");
}
