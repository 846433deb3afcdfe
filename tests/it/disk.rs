//! Output that cannot be written leads to one clear error, in both programs. The exit code is 1, and no incomplete
//! file remains.

use crate::run::{Ended, Run, names};

/// A program, the arguments of a short run, and a file that the run writes.
const PROGRAMS: [(&str, &str, &str); 2] = [
    ("four_rooms", "--duration 30", "summary.json"),
    ("grid_world", "--steps 200 --trials 1", "report.json"),
];

#[test]
fn an_output_folder_that_is_a_file() {
    for (program, arguments, _) in PROGRAMS {
        let run = Run::of(program);
        run.write("file", "precious");
        for out in ["file", "file/below"] {
            let message = run.refuses(&format!("{arguments} --out {out}"));
            let says =
                format!("error: invalid value '{out}' for '--out <DIR>': file is a file, not a folder\n");
            assert!(message.starts_with(&says), "{message}");
        }
        assert_eq!(std::fs::read_to_string(run.path("file")).unwrap(), "precious");
    }
}

#[test]
fn a_file_that_cannot_be_replaced() {
    for (program, arguments, file) in PROGRAMS {
        let run = Run::of(program);
        std::fs::create_dir_all(run.out(file).join("taken")).unwrap();
        let error = run.refuses(arguments);
        let says = format!("error: cannot write out/{file}: the results would replace it");
        assert!(error.starts_with(&says), "{error}");
        assert_eq!(names(&run.path("out")), [file], "known before the run");
    }
}

#[test]
fn recordings_and_moving_pictures_that_cannot_be_written() {
    let error = |code: i32, arguments: &str| {
        let run = Run::new();
        run.write("thesis.rrd", "precious");
        let ended = run.ends(&format!("--duration 30 --quiet {arguments}"));
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(code), ""), "{ended:?}");
        assert_eq!(run.names(), ["thesis.rrd"]);
        assert_eq!(std::fs::read_to_string(run.path("thesis.rrd")).unwrap(), "precious");
        ended.stderr
    };
    insta::assert_snapshot!(error(2, "--rrd no/such/run.rrd"), @"error: cannot write no/such/run.rrd: No such file or directory (os error 2)");
    if cfg!(target_os = "linux") {
        insta::assert_snapshot!(error(1, "--rrd /dev/full"), @"error: cannot write the recording /dev/full: No space left on device (os error 28)");
    }
    insta::assert_snapshot!(error(2, "--rrd thesis.rrd"), @"error: cannot write thesis.rrd: the results would replace it, and no run wrote it; move it, or choose another name");
    insta::assert_snapshot!(error(2, "--no-rrd --gif no/such/run.gif"), @"error: cannot write no/such/run.gif: No such file or directory (os error 2)");
}

#[test]
fn a_recording_outside_the_output_folder() {
    let run = Run::new();
    run.goes_well("--duration 30 --quiet --rrd elsewhere.rrd");
    assert_eq!(run.names(), ["elsewhere.rrd", "out"]);
    assert!(!run.out("four_rooms.rrd").exists());
    let recording = crate::recording::Recording::read(&run.path("elsewhere.rrd"));
    assert!((recording.end_s() - 30.0).abs() < 1e-6);
}

/// Standard output that goes to a file on a full disk. The results are complete.
#[test]
#[cfg(target_os = "linux")]
fn a_summary_on_a_full_disk() {
    let cannot_print = |run: &Run, arguments: &str| {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let ended = Ended::from(run.command(arguments).stdout(full).output().unwrap());
        assert_eq!(ended.code, Some(1), "{arguments}: {ended:?}");
        let error = "error: cannot write to the standard output: No space left on device (os error 28)";
        assert_eq!(ended.stderr.lines().last(), Some(error));
    };
    for (program, arguments, file) in PROGRAMS {
        let run = Run::of(program);
        cannot_print(&run, arguments);
        assert!(run.out(file).exists());
        cannot_print(&run, "--list-worlds");
        cannot_print(&run, "--help");
    }
    let run = Run::of("check_world");
    cannot_print(&run, "--png two_blocks open_hall");
    assert_eq!(run.names(), ["open_hall.png", "two_blocks.png"], "the pictures are complete");
}

/// A disk that becomes full during the run: a named pipe whose reader closes the pipe after a while.
#[test]
#[cfg(unix)]
fn a_recording_that_cannot_go_on_costs_no_result() {
    use std::io::Read;
    let run = Run::new();
    let pipe = run.path("pipe");
    nix::unistd::mkfifo(&pipe, nix::sys::stat::Mode::S_IRWXU).unwrap();
    let child = run.starts("--duration 2m --quiet --rrd pipe");
    std::fs::File::open(&pipe).unwrap().read_exact(&mut [0; 1000]).unwrap();
    let ended = Ended::of(child);
    assert_eq!(ended.code, Some(1), "{ended:?}");
    let error =
        "error: cannot write the recording pipe: Broken pipe (os error 32); the run goes on without it";
    assert_eq!(ended.stderr.trim_end(), error);
    let without = Run::quiet("--duration 2m");
    assert_eq!(run.summary().hash(), without.summary().hash());
    assert_eq!(names(&run.path("out")), names(&without.path("out")));
}

/// A file can become larger than the operating system allows.
#[test]
#[cfg(target_os = "linux")]
fn a_limit_on_the_size_of_files_costs_no_result() {
    let run = Run::new();
    // 10 MB: enough for every result (every free cell has a rate), not for the recording.
    let ended = run.ends_with_files_up_to(20_000, "--duration 50m --quiet");
    assert_eq!(ended.code, Some(1), "{ended:?}");
    let expected = "error: cannot write the recording out/unfinished_run/four_rooms.rrd: File too large";
    assert!(ended.stderr.starts_with(expected), "{}", ended.stderr);
    assert_eq!(run.summary().text("/ended_by"), "duration");
    assert!(!run.out("four_rooms.rrd").exists());
}
