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
fn a_run_that_fails_leaves_the_earlier_one() {
    let run = Run::new();
    run.goes_well("--quiet --duration 2");
    let before = std::fs::read(run.out("summary.json")).unwrap();
    let files = names(&run.path("out"));
    assert_eq!(run.ends("--duration 2 --seed 1 --rrd no/such/folder.rrd").code, Some(1));
    assert_eq!(std::fs::read(run.out("summary.json")).unwrap(), before);
    assert_eq!(names(&run.path("out")), files);
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

/// What a run may not replace: files that no run wrote, whatever they say.
#[test]
fn foreign_files_are_refused_and_stay() {
    let run = Run::new();
    std::fs::create_dir(run.path("out")).unwrap();
    let report = r#"{"files":["thesis.tex","data.csv"]}"#;
    for (name, text) in [("report.json", report), ("thesis.tex", "my thesis"), ("data.csv", "1,2,3")] {
        run.write(&format!("out/{name}"), text);
    }
    insta::assert_snapshot!(run.refuses("--duration 2 --no-rrd --quiet"), @"error: cannot write out/report.json: the results would replace it, and no run of this version wrote it (an earlier version may have); move it, or give another folder by --out");
    assert_eq!(names(&run.path("out")), ["data.csv", "report.json", "thesis.tex"]);
    // Beside files with other names, there is place for a run; they stay, even if a report lists them.
    std::fs::rename(run.out("report.json"), run.out("old_report.json")).unwrap();
    run.goes_well("--duration 2 --no-rrd --quiet");
    run.goes_well("--duration 2 --no-rrd --quiet");
    for (name, text) in [("old_report.json", report), ("thesis.tex", "my thesis"), ("data.csv", "1,2,3")] {
        assert_eq!(std::fs::read_to_string(run.out(name)).unwrap(), text);
    }
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
            let before = format!("error: cannot write out/{name}: the results would replace it");
            assert!(message.starts_with(&before), "{message}");
            assert_eq!(names(&run.path("out")), [name.as_str()], "nothing is written");
        }
    }
}
