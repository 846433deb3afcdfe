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
            let why = "the results would replace it, and no run wrote it; move it, \
                       or give another folder by --out";
            assert_eq!(message, format!("error: cannot write out/{name}: {why}\n"));
            assert_eq!(names(&run.path("out")), [name.as_str()], "nothing is written");
        }
    }
}

/// Files that a flag names: of nobody, of a run, changed since, of the user, and a link.
#[test]
#[cfg(unix)]
fn only_files_of_a_run_are_replaced() {
    let log = crate::map_log::standing_log(1.7e9, 30);
    for (program, arguments, name) in [
        ("four_rooms", "--quiet --duration 1 --no-rrd --mcap a.mcap", "a.mcap"),
        ("four_rooms", "--quiet --duration 1 --no-rrd --gif a.gif", "a.gif"),
        ("four_rooms", "--quiet --duration 1 --rrd a.rrd", "a.rrd"),
        ("map_log", "a.log --quiet --no-rrd --mcap a.mcap", "a.mcap"),
        ("check_world", "--png rooms-7", "rooms-7.png"),
        ("check_world", "--toml rooms-7", "rooms-7.toml"),
    ] {
        let run = Run::of(program);
        run.write("a.log", &log);
        let (file, read) = (run.path(name), || std::fs::read(run.path(name)).unwrap());
        let refused = || {
            let before = read();
            run.refuses(arguments);
            assert_eq!(read(), before, "{arguments}");
        };
        let unfinished = file.with_extension("unfinished").with_added_extension(file.extension().unwrap());
        std::fs::write(&unfinished, "of the user").unwrap();
        run.write(name, "of the user");
        refused();
        run.write(name, "");
        refused();
        std::fs::remove_file(&file).unwrap();
        run.goes_well(arguments);
        run.goes_well(arguments);
        let written = read();
        std::fs::rename(&file, run.path("copy")).unwrap();
        std::os::unix::fs::symlink("copy", &file).unwrap();
        refused();
        std::fs::remove_file(&file).unwrap();
        std::fs::hard_link(run.path("copy"), &file).unwrap();
        run.goes_well(arguments);
        assert_eq!(std::fs::read(run.path("copy")).unwrap(), written, "another name of the same file");
        std::fs::write(&file, [&read()[..], b" "].concat()).unwrap();
        refused();
        assert_eq!(std::fs::read_to_string(&unfinished).unwrap(), "of the user");
    }
}

/// A bag that a run wrote is read: neither the bag of --mcap nor the results of the next run take its place.
#[test]
fn a_log_that_is_read_stays() {
    let run = Run::new();
    run.goes_well("--quiet --duration 30 --no-rrd --out bag --mcap bag/a.mcap");
    let before = std::fs::read(run.path("bag/a.mcap")).unwrap();
    let run = run.with("map_log");
    for arguments in ["bag --mcap bag/a.mcap", "bag/a.mcap --mcap bag/../bag/a.mcap", "bag --mcap bag/b.mcap"]
    {
        let ended = run.ends(&format!("{arguments} --no-rrd --quiet"));
        assert_eq!(ended.code, Some(2), "{ended:?}");
        ended.says(&["would replace a log that is read, or be in its folder"]);
    }
    for arguments in ["bag", "bag/a.mcap"] {
        run.ends(&format!("{arguments} --no-rrd --quiet --out bag"));
        assert!(run.path("bag/report.html").exists());
    }
    assert_eq!(std::fs::read(run.path("bag/a.mcap")).unwrap(), before);
}

#[test]
#[cfg(unix)]
fn a_folder_that_is_removed_during_a_run_is_an_error() {
    let run = Run::new();
    let mut child = run.starts("--quiet --duration 1h --speed 50");
    wait_until(|| run.out("unfinished_run/trajectory.unfinished.tum").exists());
    std::fs::remove_dir_all(run.path("out")).unwrap();
    crate::ending::send(nix::sys::signal::Signal::SIGINT, &child);
    assert_eq!(child.wait().unwrap().code(), Some(1));
}
