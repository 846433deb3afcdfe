//! The folder of the results holds one run.

use crate::run::{Run, names, wait_until};

#[test]
fn nothing_of_an_earlier_run_stays() {
    let run = Run::new();
    run.goes_well("--quiet --world house --duration 2");
    assert!(run.out("house.rrd").exists());
    run.write("out/notes.txt", "of the user");
    run.goes_well("--quiet --duration 2 --rrd out/own.rrd");
    assert!(!run.out("house.rrd").exists() && run.out("own.rrd").exists());
    run.goes_well("--quiet --no-rrd --duration 2");
    let files = names(&run.path("out"));
    assert_eq!(files.len(), 15, "{files:?}");
    assert!(files.iter().all(|name| !name.ends_with(".rrd")), "{files:?}");
    assert_eq!(run.summary().text("/world"), "four rooms");
    let listed = run.summary().at("/files").as_array().unwrap().len();
    assert_eq!(listed, 13, "all but the summary and the notes");
}

#[test]
fn worlds_of_an_earlier_run_stay_if_they_are_the_input() {
    let run = Run::of("grid_world");
    let arguments = "--quiet --steps 100 --trials 1 --strategy recency --estimator paper";
    run.goes_well(&format!("{arguments} --generate 2 --save-worlds"));
    let worlds = || names(&run.path("out")).into_iter().filter(|name| name.ends_with(".toml"));
    let [first, second] = &worlds().collect::<Vec<_>>()[..] else { panic!("not two worlds") };
    run.goes_well(&format!("{arguments} --world out/{second}"));
    assert_eq!(worlds().collect::<Vec<_>>(), [second.as_str()], "{first} is of the earlier run");
}

#[test]
fn a_second_run_into_the_same_folder_is_refused() {
    let run = Run::new();
    let mut first = run.starts("--duration 1h --speed 1 --quiet");
    wait_until(|| run.out("unfinished_run/.lock").exists());
    let second = run.ends("--duration 2 --no-rrd");
    first.kill().unwrap();
    first.wait().unwrap();
    assert_eq!(second.code, Some(1), "{second:?}");
    insta::assert_snapshot!(second.stderr, @"error: cannot write out: another run is writing there; wait for it, or give this one another folder by --out");
    let ended = run.goes_well("--duration 2 --no-rrd");
    // What the killed run has left is kept, and named.
    ended.says(&["note: out/unfinished_run_1 has what a killed run has left; remove it if it is not needed"]);
}

/// Each file that a program writes is refused before the run, not after it, if it is not of a run.
#[test]
fn a_foreign_file_ends_a_run_before_it_begins() {
    let logs = Run::of("map_log");
    logs.write("a.log", &crate::map_log::standing_log(1.7e9, 60));
    let grid = "--quiet --steps 20 --trials 2 --strategy recency --strategy random --estimator paper";
    for (run, arguments) in
        [(Run::new(), "--quiet --duration 1"), (logs, "--quiet a.log"), (Run::of("grid_world"), grid)]
    {
        run.goes_well(arguments);
        let results = names(&run.path("out"));
        for name in &results {
            std::fs::remove_dir_all(run.path("out")).unwrap();
            std::fs::create_dir(run.path("out")).unwrap();
            run.write(&format!("out/{name}"), "of the user");
            let message = run.refuses(arguments);
            let why = "the results would replace it, and no run of this version wrote it (an earlier version may have); move it, \
                       or give another folder by --out";
            assert_eq!(message, format!("error: cannot write out/{name}: {why}\n"));
            assert_eq!(names(&run.path("out")), [name.as_str()], "nothing is written");
        }
    }
}
