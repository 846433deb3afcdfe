//! The other shipped worlds.

use crate::run::Run;

#[test]
fn things_that_come_and_go_are_mapped() {
    let summary = Run::quiet("--world toy_on_the_floor").summary();
    assert!(summary.number("/map_quality") > 0.99, "{}", summary.number("/map_quality"));
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

#[test]
fn the_world_of_the_page_runs_and_its_parcel_is_seen() {
    let page = include_str!("../../docs/worlds.md");
    let world = page.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let run = Run::new();
    run.write("room.toml", world);
    run.goes_well("--world room.toml --duration 40s --seed 1 --no-rrd --quiet");
    let summary = run.summary();
    assert!(summary.number("/free_latency/shown") > 10.0, "the robot sees where the parcel was");
    assert_eq!(summary.number("/free_latency/never_noticed"), 0.0);
    assert!(summary.number("/map_quality") > 0.99, "{}", summary.number("/map_quality"));
}
