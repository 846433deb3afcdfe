//! `--rrd` records the first trial as it was.

use super::{ran, rows};
use crate::recording::Recording;
use curious::worlds::load_grid;
use interfaces::Cell;
use sim::grid::GridSpec;

/// The cell that contains a position.
fn cell([x, y]: [f32; 2]) -> Cell {
    Cell::new(x.floor() as i32, y.floor() as i32)
}

fn is_a_step(from: Cell, to: Cell) -> bool {
    from.neighbours4().contains(&to)
}

#[test]
fn a_recording_agrees_with_its_world_and_its_trial() {
    let run = ran(
        "--steps 3000 --trials 2 --seed 6 --world open_hall --world two_blocks --estimator two-state-gaps \
                   --strategy curious --strategy random --rrd trial.rrd",
    );
    let (recording, world) = (Recording::read(&run.path("trial.rrd")), load_grid("open_hall").unwrap());
    assert_eq!(recording.timelines(), ["step"]);
    assert_eq!(recording.times("/", "step").last(), Some(&3000));

    // The robot moves from cell to cell, and never through a wall.
    let robot = recording.places("/world/robots/robot/body");
    assert_eq!((robot[0].0, cell(robot[0].1)), (0, world.start));
    assert!(robot.len() > 500, "{} moves", robot.len());
    assert!(robot.iter().all(|(_, at)| world.walls.get(cell(*at)) == Some(&false)));
    for pair in robot.windows(2) {
        assert!(pair[0].0 < pair[1].0 && is_a_step(cell(pair[0].1), cell(pair[1].1)), "{pair:?}");
    }

    blocks_keep_their_paths_and_dwell(&recording, &world);

    // The field of view moves with the robot, and the maps exist.
    let entities = recording.entities();
    for part in ["occupancy", "interval", "change_probability", "recency", "predicted"] {
        assert!(recording.times(&format!("/world/maps/{part}/cells"), "step").len() > 10, "{part}");
    }
    assert!(recording.times("/world/field_of_view/cells", "step").len() > 100);
    assert_eq!(recording.times("/world/field_of_view", "step").len(), robot.len());
    assert!(!entities.iter().any(|path| path.contains("field_of_view/outline")), "{entities:?}");

    // The curves end at the values of the first trial.
    let last = rows(&run).into_iter().find(|row| {
        (row.world.as_str(), row.strategy.as_str(), row.seed, row.step) == ("open hall", "curious", 6, 3000)
    });
    let last = last.unwrap();
    for (curve, value) in [
        ("scores/coverage", last.coverage),
        ("scores/map_quality", last.map_quality),
        ("rate_errors/relative", last.rate_error.unwrap()),
        ("rate_errors/log", last.log_error.unwrap()),
    ] {
        let curve = recording.curve_over_steps(&format!("/curves/{curve}"));
        assert!(curve.len() > 250, "{}", curve.len());
        let (step, recorded) = curve.last().unwrap();
        assert_eq!(*step, 3000);
        assert!((recorded - value).abs() < 1e-12, "{recorded} and {value}");
    }

    // For every goal there is a line with the strategy that chose it.
    let log = recording.log();
    assert!(log.len() > 20, "{log:?}");
    assert!(log.iter().any(|(_, line)| line.starts_with("recency ")), "{log:?}");
    assert!(log.iter().any(|(_, line)| line.starts_with("poisson ")), "{log:?}");
}

/// The blocks move on their paths, and never faster than their dwell allows.
fn blocks_keep_their_paths_and_dwell(recording: &Recording, world: &GridSpec) {
    for block in &world.blocks {
        let outlines = recording.outlines(&format!("/world/obstacles/{}", escaped(&block.name)));
        let ways: Vec<(i64, Cell)> =
            outlines.iter().map(|(step, corners)| (*step, middle(corners))).collect();
        assert_eq!(ways[0], (0, block.path[0]), "{}", block.name);
        assert!(ways.len() > 10, "{} moved {} times", block.name, ways.len());
        assert!(ways.iter().all(|(_, at)| block.path.contains(at)), "{}", block.name);
        for pair in ways.windows(2).skip(1) {
            assert!(pair[1].0 - pair[0].0 >= i64::from(block.dwell), "{}: {pair:?}", block.name);
            assert!(is_a_step(pair[0].1, pair[1].1), "{}: {pair:?}", block.name);
        }
    }
}

/// The cell in the middle of four corners, the first of which closes the outline.
fn middle(corners: &[[f32; 2]]) -> Cell {
    assert_eq!(corners.len(), 5, "{corners:?}");
    let mean = |axis: usize| corners[..4].iter().map(|corner| corner[axis]).sum::<f32>() / 4.0;
    cell([mean(0), mean(1)])
}

/// A name as a part of a path.
fn escaped(name: &str) -> String {
    rerun::EntityPathPart::new(name).escaped_string()
}

#[test]
fn a_long_trial_is_recorded_from_its_beginning_in_a_few_megabytes() {
    let run = ran("--steps 21000 --trials 1 --strategy recency --estimator paper --rrd trial.rrd");
    let recording = Recording::read(&run.path("trial.rrd"));
    assert_eq!(recording.times("/", "step").last(), Some(&20_000));
    let (step, line) = recording.log().pop().unwrap();
    assert_eq!((step, line.as_str()), (20_000, "the recording ends here; the trial goes on to step 21000"));
    assert_eq!(rows(&run).last().unwrap().step, 21_000);
    let bytes = std::fs::metadata(run.path("trial.rrd")).unwrap().len();
    assert!(bytes < 8_000_000, "{bytes}");
}
