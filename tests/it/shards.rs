//! Experiments in shards: the merged results are those of a single run, byte by byte, whatever happens to a shard; and
//! what does not belong together is refused.

use crate::grid::same;
use crate::run::{Ended, Run, names, wait_until};
use std::fs;
use std::sync::LazyLock;

/// Twenty-four trials.
const GRID: &str = "--steps 300 --trials 2 --generate 2 --seed 100 --strategy curious --strategy recency \
                    --strategy poisson";

/// The results of [`GRID`] without shards.
static REFERENCE: LazyLock<Vec<(String, Vec<u8>)>> = LazyLock::new(|| single(Run::of("grid_world"), GRID));

/// The results of a run without shards.
fn single(run: Run, arguments: &str) -> Vec<(String, Vec<u8>)> {
    run.goes_well(&format!("--quiet {arguments}"));
    same::files(&run)
}

/// Runs shards into the folder `shards`.
fn start(run: &Run, arguments: &str, count: u64, numbers: impl IntoIterator<Item = u64>) {
    for number in numbers {
        run.goes_well(&format!("--quiet {arguments} --shard {number}/{count} --out shards"));
    }
}

/// The results of a merge of the folder `shards`.
fn merged(run: &Run) -> Vec<(String, Vec<u8>)> {
    run.goes_well("merge shards --quiet --out out");
    same::files(run)
}

#[test]
fn any_number_of_shards_in_any_order_gives_the_files_of_a_single_run() {
    assert!(REFERENCE.iter().any(|(name, _)| name == "trials.csv"));
    for count in [1, 3, 64] {
        let run = Run::of("grid_world");
        // The last shard first. Neither threads nor the order of the arguments matter.
        let odd = (1..=count).rev().filter(|number| number % 2 == 1);
        start(&run, &format!("--threads 1 {GRID}"), count, odd);
        let even = (1..=count).filter(|number| number % 2 == 0);
        let grid = GRID.replacen("--steps 300 --trials 2", "--trials 2 --steps 300", 1);
        start(&run, &format!("--threads 3 {grid}"), count, even);
        same::assert_same(&merged(&run), &REFERENCE, &format!("with {count} shards"));
    }
}

#[test]
fn houses_have_shards_as_well() {
    let short = "--generate 2 --seed 103 --duration 30s --strategy curious --strategy random";
    let run = Run::of("house_trials");
    start(&run, short, 3, [2, 3, 1]);
    assert!(merged(&run) == single(Run::of("house_trials"), short));
    let error = Run::of("grid_world").refuses(&format!("merge {}", run.path("shards").display()));
    assert!(error.contains("has shards of house_trials: merge them with `house_trials merge "), "{error}");
}

#[test]
#[cfg(unix)]
fn an_interrupted_shard_leaves_no_file_and_no_other_process_may_have_it() {
    use nix::sys::signal::Signal;
    let long = GRID.replacen("--steps 300", "--steps 30000", 1);
    let run = Run::of("grid_world");
    for signal in [Signal::SIGKILL, Signal::SIGTERM] {
        let child = run.starts(&format!("--threads 1 {long} --shard 1/2 --out shards"));
        wait_until(|| run.path("shards/shard-1-of-2.unfinished.jsonl").exists());
        let error = run.refuses(&format!("{long} --shard 1/2 --out shards"));
        assert!(error.contains("another run is writing there; wait for it"), "{error}");
        crate::ending::send(signal, &child);
        let ended = Ended::of(child);
        if signal == Signal::SIGTERM {
            assert_eq!(ended.code, Some(130), "{ended:?}");
            ended.says(&["interrupted: start shard 1/2 again, nothing of it is kept\n"]);
            assert_eq!(names(&run.path("shards")), [""; 0]);
        }
        assert!(!run.path("shards/shard-1-of-2.jsonl").exists());
    }
    let ended = run.goes_well(&format!("{GRID} --shard 1/2 --out shards"));
    assert_eq!(ended.stdout, "shard 1/2 is complete: 12 trials in shards/shard-1-of-2.jsonl\n");
    let again = run.goes_well(&format!("{GRID} --shard 1/2 --out shards"));
    assert_eq!(again.stdout, "shard 1/2 is complete already\n");
    start(&run, GRID, 2, [2]);
    same::assert_same(&merged(&run), &REFERENCE, "after interruptions");
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_leaves_no_file() {
    let run = Run::of("grid_world");
    let arguments = format!("--quiet {GRID} --shard 1/2 --out shards");
    // 50 kB: the header and a few trials.
    let ended = run.ends_with_files_up_to(100, &arguments);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(1), ""), "{ended:?}");
    insta::assert_snapshot!(ended.stderr, @"error: cannot write shards/shard-1-of-2.jsonl: File too large (os error 27)");
    assert_eq!(names(&run.path("shards")), [""; 0]);
}

#[test]
fn invalid_input_is_refused_and_nothing_is_overwritten() {
    let run = Run::of("grid_world");
    for wrong in ["0/3", "4/3", "1/0", "3", "1/1001", "x/y"] {
        let error = run.refuses(&format!("{GRID} --shard {wrong} --out shards"));
        assert!(error.contains("must be I/N with I from 1 to N, and N at most 1000"), "{error}");
    }
    start(&run, GRID, 3, [1, 3]);
    insta::assert_snapshot!(run.refuses("merge shards"), @"error: shards is not complete: run --shard I/3 for I = 2, whose files are missing");
    start(&run, GRID, 3, [2]);
    let files = || {
        let read = |name: String| fs::read(run.path("shards").join(name)).unwrap();
        names(&run.path("shards")).into_iter().map(read).collect::<Vec<_>>()
    };
    let before = files();
    let refusals = [
        run.refuses(&format!("{GRID} --shard 1/4 --out shards")),
        run.refuses(&format!("{GRID} --max-steps 7 --shard 1/3 --out shards")),
        run.refuses("merge nowhere"),
        run.refuses("merge ."),
    ];
    insta::assert_snapshot!(refusals.concat(), @"
    error: shards/shard-1-of-3.jsonl: this shard is one of 3 shards, not of 4; give another folder by --out
    error: shards/shard-1-of-3.jsonl: this shard is of the experiment `--generate 2 --strategy curious --strategy recency --strategy poisson --trials 2 --steps 300 --seed 100`, not `--generate 2 --strategy curious --strategy recency --strategy poisson --trials 2 --steps 300 --max-steps 7 --seed 100`; give another folder by --out
    error: cannot read nowhere: No such file or directory (os error 2)
    error: .: this folder has no complete shard
    ");
    for (arguments, says) in [
        ("--shard 1/3 --generate 1 --save-worlds", "cannot be used with"),
        ("merge shards --steps 3", "unexpected argument '--steps'"),
    ] {
        let message = run.refuses(arguments);
        assert!(message.contains(says), "{arguments}: {message}");
    }
    assert!(files() == before);
    // A line edited by hand.
    let path = run.path("shards/shard-3-of-3.jsonl");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replacen("\"seed\":100", "\"seed\":101", 1)).unwrap();
    insta::assert_snapshot!(run.refuses("merge shards"), @"error: shards/shard-3-of-3.jsonl: line 2 is not the trial that belongs there; remove the file, and run its shard again");
    assert_eq!(names(&run.path("shards")).len(), 3, "no result is written");
}

#[test]
#[cfg(target_os = "linux")]
fn a_folder_that_cannot_be_written_is_refused() {
    let run = Run::of("grid_world");
    // Root can write to every ordinary folder.
    let error = run.refuses(&format!("{GRID} --shard 1/3 --out /sys"));
    let says = ["error: cannot write ", "Permission denied (os error 13)\n"];
    assert!(error.starts_with(says[0]) && error.ends_with(says[1]), "{error}");
    start(&run, GRID, 1, [1]);
    let error = run.refuses("merge shards --out /sys");
    assert!(error.starts_with("error: cannot write /sys"), "{error}");
}

#[test]
fn a_world_that_was_changed_is_not_merged() {
    let run = Run::of("grid_world");
    let world = include_str!("../../worlds/two_blocks.toml");
    run.write("world.toml", world);
    start(&run, "--world world.toml --steps 100 --trials 1", 2, 1..=2);
    run.write("world.toml", &world.replacen("sensor_radius = 4", "sensor_radius = 5", 1));
    insta::assert_snapshot!(run.refuses("merge shards"), @"error: the experiment of shards cannot be repeated: a world file was changed after the shards ran, or the program is another one");
    let error = run.refuses("--quiet --world world.toml --steps 100 --trials 1 --shard 1/2 --out shards");
    assert!(
        error.contains("of an experiment with the same arguments, but other worlds or settings"),
        "{error}"
    );
}
