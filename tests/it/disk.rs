//! Output that cannot be written leads to one clear error, in both programs. The exit code is 1, and no incomplete
//! file remains.

use crate::run::{Ended, Run, names};

/// A program, the arguments of a short run, and a file that the run writes.
struct Program {
    run: fn() -> Run,
    arguments: &'static str,
    file: &'static str,
}

const PROGRAMS: [Program; 2] = [
    Program { run: Run::new, arguments: "--duration 30", file: "summary.json" },
    Program { run: Run::grid, arguments: "--steps 200 --trials 1", file: "report.json" },
];

/// The only line on standard error, after lines of progress.
#[track_caller]
fn error(run: &Run, arguments: &str) -> String {
    let ended = run.ends(arguments);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(1), ""), "{ended:?}");
    let lines: Vec<&str> = ended.stderr.lines().filter(|line| !line.contains(" of 30 s, ")).collect();
    assert_eq!(lines.len(), 1, "{}", ended.stderr);
    lines[0].to_owned()
}

#[test]
fn an_output_folder_that_is_a_file() {
    for program in PROGRAMS {
        let run = (program.run)();
        run.write("file", "precious");
        for out in ["file", "file/below"] {
            let message =
                crate::bad_input::refuses(&run, &format!("{} --out {out}", program.arguments), &["file"]);
            let says =
                format!("error: invalid value '{out}' for '--out <DIR>': file is a file, not a folder\n");
            assert!(message.starts_with(&says), "{message}");
        }
        assert_eq!(std::fs::read_to_string(run.path("file")).unwrap(), "precious");
    }
}

#[test]
fn a_file_that_cannot_be_replaced() {
    for program in PROGRAMS {
        let run = (program.run)();
        let file = program.file;
        std::fs::create_dir_all(run.out(file).join("taken")).unwrap();
        let error = crate::bad_input::refuses(&run, program.arguments, &["out"]);
        let says = format!("error: cannot write out/{file}: the results would replace it");
        assert!(error.starts_with(&says), "{error}");
        assert_eq!(names(&run.path("out")), [file], "known before the run");
    }
}

#[test]
fn a_recording_in_a_folder_that_does_not_exist() {
    let reason = "No such file or directory (os error 2)";
    cannot_record("no/such/run.rrd", reason);
}

#[test]
#[cfg(target_os = "linux")]
fn a_recording_on_a_full_disk() {
    cannot_record("/dev/full", "No space left on device (os error 28)");
}

#[track_caller]
fn cannot_record(file: &str, reason: &str) {
    let run = Run::new();
    let error = error(&run, &format!("--duration 30 --rrd {file}"));
    assert_eq!(error, format!("error: cannot write the recording {file}: {reason}"));
    assert_eq!(run.names(), [""; 0]);
}

#[test]
fn a_moving_picture_in_a_folder_that_does_not_exist() {
    let run = Run::new();
    let error = error(&run, "--duration 30 --no-rrd --gif no/such/run.gif");
    assert_eq!(error, "error: cannot write no/such/run.gif: No such file or directory (os error 2)");
    assert_eq!(run.names(), [""; 0]);
}

#[test]
fn a_file_that_is_no_recording_is_not_replaced() {
    let run = Run::new();
    run.write("thesis.rrd", "precious");
    let error = error(&run, "--duration 30 --rrd thesis.rrd");
    assert_eq!(
        error,
        "error: cannot write the recording thesis.rrd: there is a file with this name that is not a recording; \
         choose another name"
    );
    assert_eq!(std::fs::read_to_string(run.path("thesis.rrd")).unwrap(), "precious");
    assert_eq!(run.names(), ["thesis.rrd"]);
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
        let error = ended.stderr.lines().last().unwrap();
        assert_eq!(
            error,
            "error: cannot write to the standard output: No space left on device (os error 28)"
        );
    };
    for program in PROGRAMS {
        let run = (program.run)();
        cannot_print(&run, program.arguments);
        assert!(run.out(program.file).exists());
        cannot_print(&run, "--list-worlds");
        cannot_print(&run, "--help");
    }
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
    let ended = Ended::from(child.wait_with_output().unwrap());
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert_eq!(
        ended.stderr.trim_end(),
        "error: cannot write the recording pipe: Broken pipe (os error 32); the run goes on without it"
    );
    let without = Run::quiet("--duration 2m");
    assert_eq!(run.summary().hash(), without.summary().hash());
    assert_eq!(names(&run.path("out")), names(&without.path("out")));
}

/// A file can become larger than the operating system allows.
#[test]
#[cfg(target_os = "linux")]
fn a_limit_on_the_size_of_files_costs_no_result() {
    let run = Run::new();
    let program = run.command("--duration 20m --quiet");
    let mut limited = std::process::Command::new("sh");
    // 10 MB: enough for every result (every free cell has a rate), not for the recording.
    limited.arg("-c").arg("ulimit -f 20000 && exec \"$0\" \"$@\"").arg(program.get_program());
    let ended = Ended::from(limited.args(program.get_args()).current_dir(run.path("")).output().unwrap());
    assert_eq!(ended.code, Some(1), "{ended:?}");
    let expected = "error: cannot write the recording out/unfinished_run/four_rooms.rrd: File too large";
    assert!(ended.stderr.starts_with(expected), "{}", ended.stderr);
    assert_eq!(run.summary().text("/ended_by"), "duration");
    assert!(!run.out("four_rooms.rrd").exists());
}
