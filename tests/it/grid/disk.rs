//! What cannot be written is one clear error, before the trials begin where that can be known; the
//! exit code is 1.

use crate::run::{Run, names};
use std::path::Path;

#[track_caller]
fn fails(run: &Run, arguments: &str) -> String {
    let ended = run.ends(&format!("--steps 200 --trials 1 {arguments}"));
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert_eq!(ended.stdout, "");
    assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
    ended.stderr
}

#[test]
fn an_output_folder_that_is_a_file() {
    let run = Run::grid();
    run.write("file", "precious");
    insta::assert_snapshot!(fails(&run, "--out file"), @"error: cannot write file: File exists (os error 17)");
    insta::assert_snapshot!(fails(&run, "--out file/below"), @"error: cannot write file/below: Not a directory (os error 20)");
    assert_eq!(std::fs::read_to_string(run.path("file")).unwrap(), "precious");
    assert_eq!(run.names(), ["file"]);
}

#[test]
fn a_file_that_cannot_be_replaced() {
    let run = Run::grid();
    std::fs::create_dir_all(run.out("report.json/taken")).unwrap();
    let error = fails(&run, "");
    assert!(error.starts_with("error: cannot write out/report.json: "), "{error}");
    let left = names(&run.path("out"));
    assert!(left.iter().all(|name| !name.ends_with(".part")), "{left:?}");
}

#[test]
fn a_recording_in_a_folder_that_is_not_there() {
    let run = Run::grid();
    insta::assert_snapshot!(fails(&run, "--rrd no/such/trial.rrd"), @"error: cannot write the recording no/such/trial.rrd: No such file or directory (os error 2)");
    assert_eq!(names(&run.path("out")), [""; 0]);
}

#[test]
fn a_disk_that_is_full() {
    if !Path::new("/dev/full").exists() {
        return;
    }
    let run = Run::grid();
    insta::assert_snapshot!(fails(&run, "--rrd /dev/full"), @"error: cannot write the recording /dev/full: No space left on device (os error 28)");
    assert_eq!(names(&run.path("out")), [""; 0]);
}

/// As when a disk fills up in the middle: here a pipe whose other end is closed after a while.
#[test]
#[cfg(unix)]
fn a_recording_that_cannot_go_on_costs_no_trial() {
    use std::io::Read;
    let run = Run::grid();
    let pipe = run.path("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let arguments = "--steps 3000 --trials 2 --strategy recency --estimator paper --rrd pipe";
    let child = run.starts(arguments);
    std::fs::File::open(&pipe).unwrap().read_exact(&mut [0; 1000]).unwrap();
    let ended = crate::run::Ended::from(child.wait_with_output().unwrap());
    assert_eq!(ended.code, Some(1), "{ended:?}");
    insta::assert_snapshot!(ended.stderr, @"error: cannot write the recording pipe: Broken pipe (os error 32)");
    let without = super::ran(&arguments.replace("--rrd pipe", ""));
    let trials = |run: &Run| std::fs::read(run.out("trials.csv")).unwrap();
    assert!(trials(&run) == trials(&without), "the trials are others");
}
