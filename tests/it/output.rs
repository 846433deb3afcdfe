//! All output files of a run exist, and agree with each other.

use crate::recording::Recording;
use crate::run::Run;
use std::sync::LazyLock;

/// No option except the duration: four simulated minutes.
static RUN: LazyLock<Run> = LazyLock::new(|| {
    let run = Run::new();
    run.goes_well("--duration 4m");
    run
});

const SIDE: usize = 240;

#[test]
fn the_output_folder_is_complete() {
    assert_eq!(RUN.names(), ["out"]);
    let expected = "cell_statistics.csv change_probability.png figure5.png four_rooms.rrd interval.png \
                    map.pgm map.yaml occupancy.png predicted.png recency.png summary.json things.json \
                    trajectory.png trajectory.tum trajectory_true.tum";
    assert_eq!(crate::run::names(&RUN.path("out")).join(" "), expected);
}

#[test]
fn the_summary_says_what_was_run_and_how_it_went() {
    let summary = RUN.summary();
    assert_eq!(summary.text("/version"), env!("CARGO_PKG_VERSION"));
    assert_eq!(summary.at("/arguments").as_array().unwrap().len(), 4);
    for part in ["mapper", "agent", "drive"] {
        assert!(summary.at("/settings")[part].is_object(), "{part}");
    }
    let choice = ["world", "drive", "strategy", "estimator", "occupancy", "ended_by"];
    assert_eq!(
        choice.map(|key| summary.text(&format!("/{key}"))),
        ["four rooms", "agent", "curious", "shared-prior", "steady", "duration"]
    );
    assert_eq!(summary.number("/seed"), 0.0);
    assert!((summary.number("/simulated_s") - 240.0).abs() < 1e-6);
    let speed = summary.number("/simulated_s") / summary.number("/wall_s");
    assert!((summary.number("/real_time_factor") - speed).abs() < 1e-6 * speed);
    for share in ["/coverage", "/map_quality", "/map_quality_changing", "/rate_auc"] {
        assert!((0.5..=1.0).contains(&summary.number(share)), "{share}");
    }
    assert!(summary.number("/static_cells") > 50_000.0);
    assert!(summary.number("/rate_error") > 0.0);
    assert!(summary.number("/goals/reached") + summary.number("/goals/approached") > 5.0);
    assert_eq!(summary.hash().len(), 32);
    let shares = summary.at("/strategy_share").as_object().unwrap();
    assert_eq!(shares.keys().collect::<Vec<_>>(), ["poisson", "recency"]);
    assert!((shares.values().map(|share| share.as_f64().unwrap()).sum::<f64>() - 1.0).abs() < 1e-9);

    let curve = summary.curve();
    assert_eq!(curve.len(), 25);
    // The number of cells that can be seen depends a little on the position of the dummy robot.
    assert!(curve.windows(2).all(|pair| pair[0][0] < pair[1][0] && pair[0][1] <= pair[1][1] + 0.002));
    assert_eq!(curve[24][1..], [summary.number("/coverage"), summary.number("/map_quality")]);
}

#[test]
fn the_recording_agrees_with_the_summary() {
    let (summary, recording) = (RUN.summary(), Recording::read(&RUN.out("four_rooms.rrd")));
    let entities = recording.entities();
    let bodies = |path: &&String| path.starts_with("/world/robots/") && path.ends_with("/body");
    assert_eq!(
        entities.iter().filter(bodies).collect::<Vec<_>>(),
        ["/world/robots/curious/body", "/world/robots/dummy/body"]
    );
    for part in ["occupancy", "interval", "recency", "change_probability", "predicted"] {
        assert!(entities.contains(&format!("/world/maps/{part}")), "{part} in {entities:?}");
    }
    assert!((recording.end_s() - 240.0).abs() < 1e-6, "{}", recording.end_s());
    assert_eq!(recording.times("/", "step").last(), Some(&2401)); // 240 s at 10 Hz, and the first reading

    // The dummy robot moves at every tick, except where it turns and while it waits.
    assert!(recording.times("/world/robots/dummy/body", "sim_time").len() > 2000);
    for (index, name) in [(1, "coverage"), (2, "map_quality")] {
        let curve = recording.curve(&format!("/curves/scores/{name}"));
        assert!((240..=242).contains(&curve.len()), "{}", curve.len());
        for point in summary.curve() {
            let recorded = curve.iter().rev().find(|(time_s, _)| *time_s <= point[0] + 1e-6);
            // Reading JSON may round the last bit.
            assert!((recorded.unwrap().1 - point[index]).abs() < 1e-12, "{name} at {} s", point[0]);
        }
        assert!((curve.last().unwrap().1 - summary.number(&format!("/{name}"))).abs() < 1e-12);
    }
}

#[test]
fn map_and_table_tell_the_same_of_every_cell() {
    let map = image::open(RUN.out("map.pgm")).unwrap().into_luma8();
    assert_eq!((map.width() as usize, map.height() as usize), (SIDE, SIDE));
    let mut states = vec!["unknown"; SIDE * SIDE];
    let cells = RUN.cells();
    for cell in &cells {
        assert_eq!(((cell.x_m / 0.05) as usize, (cell.y_m / 0.05) as usize), (cell.column, cell.row));
        assert!((0.0..=240.0).contains(&cell.recency_s));
        let [blocked, freed] = cell.events();
        assert!(blocked.abs_diff(freed) <= 1, "{blocked} times blocked and {freed} freed");
        assert_eq!(cell.rate_hz == 0.0, cell.interval_s.is_infinite());
        assert!(cell.rate_hz == 0.0 || (cell.rate_hz * cell.interval_s - 1.0).abs() < 1e-4);
        states[cell.row * SIDE + cell.column] = match cell.state.as_str() {
            "free" => "free",
            "blocked" => "blocked",
            _ => "unknown",
        };
    }
    for (x, y, pixel) in map.enumerate_pixels() {
        let drawn = match pixel.0[0] {
            254 => "free",
            0 => "blocked",
            205 => "unknown",
            other => panic!("{other} is no colour of a map"),
        };
        let (column, row) = (x as usize, SIDE - 1 - y as usize);
        assert_eq!(drawn, states[row * SIDE + column], "column {column}, row {row}");
    }
    // The table must agree with the summary.
    let summary = RUN.summary();
    let oldest = cells.iter().map(|cell| cell.recency_s).fold(0.0, f64::max);
    assert!(oldest + 1e-6 >= summary.number("/age/max_s") || summary.number("/coverage") < 1.0);
}
