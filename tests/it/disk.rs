//! What cannot be written is one clear error; the exit code is 1, and nothing half-written stays.

use crate::run::{Run, names};
use std::path::Path;

/// One line on standard error, after the lines of progress.
#[track_caller]
fn fails(run: &Run, arguments: &str) -> String {
    let ended = run.ends(&format!("--duration 30 {arguments}"));
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert_eq!(ended.stdout, "");
    let errors: Vec<&str> = ended.stderr.lines().filter(|line| line.starts_with("error: ")).collect();
    assert_eq!(errors.len(), 1, "{}", ended.stderr);
    errors[0].to_owned()
}

#[test]
fn an_output_folder_that_is_a_file() {
    let run = Run::new();
    run.write("file", "precious");
    insta::assert_snapshot!(fails(&run, "--out file"), @"error: cannot write file: File exists (os error 17)");
    insta::assert_snapshot!(fails(&run, "--out file/below"), @"error: cannot write file/below: Not a directory (os error 20)");
    assert_eq!(std::fs::read_to_string(run.path("file")).unwrap(), "precious");
    assert_eq!(run.names(), ["file"]);
}

#[test]
fn a_recording_in_a_folder_that_is_not_there() {
    let run = Run::new();
    insta::assert_snapshot!(fails(&run, "--rrd no/such/run.rrd"), @"error: cannot write the recording no/such/run.rrd: No such file or directory (os error 2)");
    assert_eq!(names(&run.path("out")), [""; 0]);
}

#[test]
fn a_disk_that_is_full() {
    if !Path::new("/dev/full").exists() {
        return;
    }
    let run = Run::new();
    insta::assert_snapshot!(fails(&run, "--rrd /dev/full"), @"error: cannot write the recording /dev/full: No space left on device (os error 28)");
    assert_eq!(names(&run.path("out")), [""; 0]);
}

#[test]
fn a_file_that_cannot_be_replaced() {
    let run = Run::new();
    std::fs::create_dir_all(run.out("summary.json/taken")).unwrap();
    let error = fails(&run, "--no-rrd");
    assert!(error.starts_with("error: cannot write out/summary.json: "), "{error}");
    let left = names(&run.path("out"));
    assert!(left.iter().all(|name| !name.ends_with(".part")), "{left:?}");
}

#[test]
fn a_recording_elsewhere() {
    let run = Run::new();
    run.goes_well("--duration 30 --quiet --rrd elsewhere.rrd");
    assert_eq!(run.names(), ["elsewhere.rrd", "out"]);
    assert!(!run.out("four_rooms.rrd").exists());
    let recording = crate::recording::Recording::read(&run.path("elsewhere.rrd"));
    assert!((recording.end_s() - 30.0).abs() < 1e-6);
}
