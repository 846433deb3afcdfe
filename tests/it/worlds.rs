//! The other shipped worlds.

use crate::run::Run;

/// How soon a thing is noticed depends on the path of the robot, which may see it for a moment only: the median of
/// three runs counts.
#[test]
fn things_that_come_and_go_are_noticed() {
    let mut delays_s = [Vec::new(), Vec::new()];
    for seed in [0, 1, 2] {
        let summary = Run::quiet(&format!("--world toy_on_the_floor --seed {seed}")).summary();
        let things = summary.at("/things").as_array().unwrap();
        let names: Vec<_> = things.iter().map(|t| (t["name"].as_str(), t["appeared"].as_bool())).collect();
        assert_eq!(names, [(Some("toy"), Some(true)), (Some("parcel"), Some(false))]);
        for ((thing, happened_s), delays_s) in things.iter().zip([300.0, 600.0]).zip(&mut delays_s) {
            let time_s = |key: &str| thing[key].as_f64().unwrap_or_else(|| panic!("{key} never: {thing}"));
            assert!((time_s("happened_s") - happened_s).abs() < 0.2, "{thing}");
            assert!(time_s("in_view_s") >= time_s("happened_s"), "{thing}");
            assert!(time_s("noticed_s") >= time_s("in_view_s"), "{thing}");
            // Some cells may become right only when the robot returns.
            assert!(time_s("right_s") >= time_s("noticed_s"), "{thing}");
            delays_s.push(time_s("noticed_s") - time_s("in_view_s"));
        }
        assert!(summary.number("/map_quality") > 0.99);
    }
    for mut delays_s in delays_s {
        delays_s.sort_by(f64::total_cmp);
        assert!(delays_s[1] <= 1.0, "{delays_s:?}");
    }
}

/// The number depends on the path of the robot: the median of three runs counts. `examples/flicker` measures the
/// same on a fixed path.
#[test]
fn walls_that_stand_askew_and_a_noisy_laser_make_few_false_changes() {
    let mut false_changes = [0, 1, 2].map(|seed| {
        let summary = Run::quiet(&format!("--world turned_house --duration 10m --seed {seed}")).summary();
        assert!(summary.number("/coverage") >= 0.98, "{}", summary.number("/coverage"));
        assert!(summary.number("/static_cells") > 40_000.0);
        assert_eq!(summary.number("/collisions"), 0.0);
        summary.number("/false_change_events")
    });
    false_changes.sort_by(f64::total_cmp);
    assert!(false_changes[1] <= 5.0, "{false_changes:?}");
}

/// Door leaves are thinner than a cell, and hide cells that stay free.
#[test]
fn swinging_and_sliding_doors_make_few_false_changes() {
    let summary = Run::quiet("--world house").summary();
    assert!(summary.number("/block_latency/shown") > 1000.0);
    assert!(summary.number("/static_cells") > 10_000.0);
    assert!(summary.number("/false_change_events") <= 20.0, "{}", summary.number("/false_change_events"));
}

/// The example of docs/worlds.md: the map can show a thing with the very scan that shows it first, and the report knows it.
#[test]
fn the_world_of_the_page_runs_and_its_parcel_is_seen() {
    let page = include_str!("../../docs/worlds.md");
    let world = page.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let run = Run::new();
    run.write("room.toml", world);
    run.goes_well("--world room.toml --duration 40s --seed 1 --no-rrd --quiet");
    let summary = run.summary();
    for thing in summary.at("/things").as_array().unwrap() {
        assert!(thing["in_view_s"].as_f64() >= thing["happened_s"].as_f64(), "{thing}");
        assert!(thing["right_s"].as_f64() >= thing["in_view_s"].as_f64(), "{thing}");
    }
    assert_eq!(summary.at("/things").as_array().unwrap().len(), 2);
}
