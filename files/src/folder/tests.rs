//! The folder of the results, its exchange, and what it never touches.

mod faults;

use super::*;
use crate::marker::RESULTS as MARKER;

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// A run that writes files, and a summary that lists them.
/// Writes a result.
fn write(folder: &RunFolder, name: &str, text: &str) {
    crate::write_file(&folder.unfinished().join(name), |file| file.write_all(text.as_bytes())).unwrap();
}

fn kill(run: RunFolder) {
    let [new, lock] = [".new", LOCK].map(|name| run.unfinished().join(name));
    std::mem::forget(run); // its lock as well: another file description has none
    fs::write(&new, LOCK_CONTENT).unwrap();
    fs::rename(new, lock).unwrap();
}

fn run(path: &Path, files: &[&str], inputs: &[&Path]) -> Result<(), OutputError> {
    let folder = RunFolder::open(path).unwrap();
    for file in files {
        write(&folder, file, &format!("{file} of {files:?}"));
    }
    let summary = serde_json::json!({ "files": folder.results().unwrap() });
    write(&folder, "summary.json", &summary.to_string());
    folder.finish(inputs)
}

#[test]
fn a_folder_holds_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a/b");
    run(&path, &["map.pgm", "house.rrd", "a.toml", "b.toml"], &[]).unwrap();
    fs::write(path.join("notes.txt"), "of the user").unwrap();
    run(&path, &["map.pgm"], &[&path.join("b.toml")]).unwrap();
    assert_eq!(names(&path), [MARKER, "b.toml", "map.pgm", "notes.txt", "summary.json"]);
    assert_eq!(fs::read_to_string(path.join("map.pgm")).unwrap(), "map.pgm of [\"map.pgm\"]");
}

#[test]
fn a_file_that_is_written_directly_is_a_result() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("own.rrd");
    for text in ["first", "second"] {
        let mut run = RunFolder::open(folder.path()).unwrap();
        run.adopt(&file, "rrd").unwrap();
        run.adopt(Path::new("elsewhere"), "rrd").unwrap();
        for wrong in ["map.pgm", "unfinished_run/own.rrd"] {
            run.adopt(&folder.path().join(wrong), "rrd").unwrap_err();
        }
        crate::write_file(&file, |file| file.write_all(text.as_bytes())).unwrap();
        assert_eq!(run.results().unwrap(), ["own.rrd"]);
        let summary = serde_json::json!({ "files": run.results().unwrap() });
        write(&run, "summary.json", &summary.to_string());
        run.finish(&[]).unwrap();
        assert_eq!(fs::read_to_string(&file).unwrap(), text);
    }
    run(folder.path(), &["map.pgm"], &[]).unwrap();
    assert_eq!(names(folder.path()), [marker::FILES, MARKER, "map.pgm", "summary.json"]);
    // The user puts another file in its place during a run.
    let mut own = RunFolder::open(folder.path()).unwrap();
    own.adopt(&file, "rrd").unwrap();
    fs::write(&file, "of the user").unwrap();
    assert!(crate::write_file(&file, |file| file.write_all(b"third")).unwrap_err().is_refusal());
    own.finish(&[]).unwrap();
    run(folder.path(), &["map.pgm"], &[]).unwrap();
    assert_eq!(fs::read_to_string(&file).unwrap(), "of the user");
}

#[test]
fn a_failed_run_leaves_the_earlier_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out");
    run(&path, &["map.pgm", "house.rrd"], &[]).unwrap();
    let failing = RunFolder::open(&path).unwrap();
    write(&failing, "map.pgm", "half");
    drop(failing);
    fs::create_dir(path.join("taken.png")).unwrap();
    run(&path, &["a.png", "map.pgm", "taken.png"], &[]).unwrap_err();
    let left = [MARKER, "house.rrd", "map.pgm", "summary.json", "taken.png", UNFINISHED];
    assert_eq!(names(&path), left);
    assert!(path.join(UNFINISHED).join("a.png").exists(), "the new results are not lost");
    let map = fs::read_to_string(path.join("map.pgm")).unwrap();
    assert_eq!(map, "map.pgm of [\"map.pgm\", \"house.rrd\"]");
    let new = folder.path().join("new");
    drop(RunFolder::open(&new).unwrap());
    assert!(!new.exists());
}

#[test]
fn what_a_killed_run_has_left_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    for number in 1..3 {
        let killed = RunFolder::open(folder.path()).unwrap();
        fs::write(killed.unfinished().join("house.rrd"), "half").unwrap();
        kill(killed);
        let next = RunFolder::open(folder.path()).unwrap();
        assert_eq!(next.notes().len(), 1, "{:?}", next.notes());
        drop(next);
        let kept = folder.path().join(format!("{UNFINISHED}_{number}/house.rrd"));
        assert_eq!(fs::read_to_string(kept).unwrap(), "half");
    }
}

#[test]
fn a_folder_that_no_run_has_left_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let unfinished = folder.path().join(UNFINISHED);
    fs::create_dir(&unfinished).unwrap();
    for name in ["notes.txt", LOCK] {
        fs::write(unfinished.join(name), "of the user").unwrap();
        assert!(RunFolder::open(folder.path()).unwrap_err().is_refusal());
        assert_eq!(fs::read_to_string(unfinished.join(name)).unwrap(), "of the user");
    }
}

#[test]
fn two_runs_at_once_are_one_too_many() {
    let folder = tempfile::tempdir().unwrap();
    let first = RunFolder::open(folder.path()).unwrap();
    let error = RunFolder::open(folder.path()).unwrap_err().to_string();
    let why = "another run is writing there; wait for it, or give this one another folder by --out";
    assert_eq!(error, format!("cannot write {}: {why}", folder.path().display()));
    drop(first);
    RunFolder::open(folder.path()).unwrap();
}

#[test]
fn a_summary_that_no_run_wrote_removes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for name in ["thesis.tex", "data.csv"] {
        fs::write(path.join(name), "of the user").unwrap();
    }
    fs::write(path.join("report.json"), r#"{"files":["thesis.tex","data.csv"]}"#).unwrap();
    let before = names(path);
    let error = RunFolder::open(path).unwrap_err();
    assert!(error.is_refusal());
    assert!(error.to_string().contains("/report.json: the results would replace it, and no run"), "{error}");
    assert_eq!(names(path), before);
    fs::remove_file(path.join("report.json")).unwrap();
    run(path, &["map.pgm"], &[]).unwrap();
    assert_eq!(names(path), [MARKER, "data.csv", "map.pgm", "summary.json", "thesis.tex"]);
}

#[test]
fn a_marker_from_elsewhere_removes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, &["house.rrd", "a.toml"], &[]).unwrap();
    fs::write(path.join("a.toml"), "edited").unwrap();
    let opened = RunFolder::open(path).unwrap();
    let note = format!("{}/a.toml was changed since a run wrote it: it stays", path.display());
    assert_eq!(opened.notes(), [note]);
    drop(opened);
    run(path, &["map.pgm"], &[]).unwrap();
    assert_eq!(names(path), [MARKER, "a.toml", "map.pgm", "summary.json"]);
    for wrong in [
        r#"{"files":["map.pgm"]}"#,
        "",
        r#"{"schema":1,"files":{"../a":{"bytes":0,"xxh3":""}}}"#,
        r#"{"schema":1,"files":{"__init__.py":{"bytes":0,"xxh3":""}}}"#,
    ] {
        fs::write(path.join(MARKER), wrong).unwrap();
        assert!(RunFolder::open(path).unwrap_err().is_refusal(), "{wrong}");
    }
}

/// A folder that came with an archive, say.
#[test]
fn a_journal_from_elsewhere_moves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out");
    fs::create_dir_all(path.join(UNFINISHED)).unwrap();
    fs::write(path.join(UNFINISHED).join(LOCK), LOCK_CONTENT).unwrap();
    fs::write(path.join("thesis.tex"), "of the user").unwrap();
    let marker = |name: &str| format!(r#"{{"schema":1,"files":{{{name:?}:{{"bytes":0,"xxh3":""}}}}}}"#);
    let journal = path.join(UNFINISHED).join(".exchange.json");
    let outside = format!(r#"{{"earlier":{},"new":{}}}"#, marker("a"), marker("../thesis.tex"));
    for text in [&outside[..], "", "{}"] {
        fs::write(&journal, text).unwrap();
        let error = RunFolder::open(&path).unwrap_err();
        assert!(
            error.is_refusal() && error.to_string().contains(".exchange.json: no run of this"),
            "{error}"
        );
        assert_eq!(names(&path), ["thesis.tex", UNFINISHED]);
        assert_eq!(names(folder.path()), ["out"]);
    }
}

#[test]
fn a_folder_of_the_user_in_that_of_a_run_stays() {
    let folder = tempfile::tempdir().unwrap();
    for fails in [true, false] {
        let run = RunFolder::open(folder.path()).unwrap();
        write(&run, "map.pgm", "new");
        fs::create_dir(run.unfinished().join("mine")).unwrap();
        fs::write(run.unfinished().join("mine/notes.txt"), "of the user").unwrap();
        match fails {
            true => drop(run),
            false => run.finish(&[]).unwrap(),
        }
        assert_eq!(folder.path().join("map.pgm").exists(), !fails);
        drop(RunFolder::open(folder.path()).unwrap());
    }
    for number in [1, 2] {
        let kept = folder.path().join(format!("{UNFINISHED}_{number}/mine/notes.txt"));
        assert_eq!(fs::read_to_string(kept).unwrap(), "of the user");
    }
}

/// Every file below a folder, with its content, and every link, with its target.
fn everything(folder: &Path) -> Vec<(std::path::PathBuf, String)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let path = entry.path();
        match entry.file_type().unwrap() {
            kind if kind.is_symlink() => {
                all.push((path.clone(), fs::read_link(&path).unwrap().display().to_string()))
            }
            kind if kind.is_dir() => all.extend(everything(&path)),
            _ => all.push((path.clone(), fs::read_to_string(&path).unwrap())),
        }
    }
    all.sort();
    all
}

/// A folder of results from a stranger, who has prepared an exchange and put links in the place of any two
/// files and folders.
#[test]
fn a_prepared_folder_changes_nothing_outside() {
    let [text, evil] = ["of the user", "of the stranger"];
    let places = [
        MARKER,
        ".curious_run.json_1",
        ".curious_files.json",
        UNFINISHED,
        "unfinished_run_1",
        "map.pgm",
        ".bashrc",
        "a.mcap",
        "a.unfinished.mcap",
        "unfinished_run/.lock",
        "unfinished_run/.exchange.json",
        "unfinished_run/.exchange.json_1",
        "unfinished_run/.earlier",
        "unfinished_run/.earlier/.bashrc",
        "unfinished_run/map.pgm",
        "unfinished_run/.bashrc",
    ];
    let hash = |text: &str| format!("{:032x}", xxhash_rust::xxh3::xxh3_128(text.as_bytes()));
    let listed = |names: &[&str]| {
        let content = format!(r#"{{"bytes":{},"xxh3":"{}"}}"#, evil.len(), hash(evil));
        let files = names.iter().map(|name| format!("{name:?}:{content}")).collect::<Vec<_>>().join(",");
        format!(r#"{{"schema":1,"files":{{{files}}}}}"#)
    };
    let pairs = places
        .iter()
        .enumerate()
        .flat_map(|(at, first)| places[at..].iter().map(move |second| (first, second)));
    for (first, second) in pairs {
        for to_folder in [false, true] {
            let outer = tempfile::tempdir().unwrap();
            let [path, home] = ["out", "home"].map(|name| outer.path().join(name));
            fs::create_dir_all(path.join(UNFINISHED)).unwrap();
            fs::create_dir(&home).unwrap();
            for name in [".bashrc", "map.pgm", "a.mcap", LOCK, MARKER, "summary.json"] {
                fs::write(home.join(name), text).unwrap();
            }
            for name in [".bashrc", "a.mcap", "unfinished_run/map.pgm"] {
                fs::write(path.join(name), evil).unwrap();
            }
            let both = format!(r#"{{"earlier":{},"new":{}}}"#, listed(&[".bashrc"]), listed(&["map.pgm"]));
            fs::write(path.join(MARKER), listed(&[".bashrc", "a.mcap"])).unwrap();
            fs::write(path.join(UNFINISHED).join(LOCK), LOCK_CONTENT).unwrap();
            fs::write(path.join(UNFINISHED).join(".exchange.json"), both).unwrap();
            for place in [first, second].map(|place| path.join(place)) {
                drop(fs::remove_file(&place).or_else(|_| fs::remove_dir_all(&place)));
                let to = if to_folder { home.clone() } else { home.join(".bashrc") };
                if place.parent().unwrap().symlink_metadata().is_ok_and(|parent| parent.is_dir()) {
                    std::os::unix::fs::symlink(to, &place).unwrap();
                }
            }
            let before = everything(&home);
            for _ in 0..2 {
                if let Ok(mut run) = RunFolder::open(&path) {
                    let bag = path.join("a.mcap");
                    drop(run.adopt(&bag, "mcap"));
                    drop(crate::write_file(&bag, |file| file.write_all(b"bag")));
                    drop(crate::write_file(&run.unfinished().join("map.pgm"), |file| file.write_all(b"map")));
                    drop(run.finish(&[]));
                }
            }
            assert_eq!(everything(&home), before, "{first} {second} {to_folder}");
        }
    }
}

#[test]
fn a_folder_that_is_removed_during_a_run_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out");
    for made_again in [false, true] {
        let run = RunFolder::open(&path).unwrap();
        write(&run, "map.pgm", "new");
        fs::remove_dir_all(&path).unwrap();
        if made_again {
            fs::create_dir_all(run.unfinished()).unwrap();
        }
        assert!(run.finish(&[]).unwrap_err().to_string().contains("was moved or removed while the run"));
        drop(fs::remove_dir_all(&path));
    }
}

#[test]
fn killed_runs_leave_a_bounded_number_of_folders() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let kept = |number: u32| path.join(format!("{UNFINISHED}_{number}"));
    for number in 1..=3 * MAX_LEFT {
        let killed = RunFolder::open(path).unwrap();
        write(&killed, "map.pgm", &format!("map {number}"));
        fs::write(killed.unfinished().join("house.unfinished.rrd"), "half").unwrap();
        kill(killed);
        if number == MAX_LEFT {
            drop(RunFolder::open(path).unwrap());
            // Somebody keeps something in the oldest one.
            fs::write(kept(1).join("notes.txt"), "of the user").unwrap();
        }
    }
    drop(RunFolder::open(path).unwrap());
    let maps: std::collections::BTreeSet<String> =
        (2..=MAX_LEFT).map(|number| fs::read_to_string(kept(number).join("map.pgm")).unwrap()).collect();
    let expected = (2 * MAX_LEFT + 2..=3 * MAX_LEFT).map(|number| format!("map {number}")).collect();
    assert_eq!(maps, expected, "the newest ones");
    assert_eq!(fs::read_to_string(kept(1).join("notes.txt")).unwrap(), "of the user");
    assert_eq!(names(path).len(), MAX_LEFT as usize, "{:?}", names(path));
}

/// What somebody else has put into the folder of a run that goes on is no result: it stays.
#[test]
fn a_file_of_the_user_in_the_folder_of_a_run_stays() {
    for is_ended_well in [true, false] {
        let folder = tempfile::tempdir().unwrap();
        let run = RunFolder::open(folder.path()).unwrap();
        write(&run, "map.pgm", "new");
        write(&run, "edited.csv", "new");
        fs::write(run.unfinished().join("notes.txt"), "of the user").unwrap();
        fs::write(run.unfinished().join("edited.csv"), "of the user").unwrap();
        match is_ended_well {
            true => run.finish(&[]).unwrap(),
            false => drop(run),
        }
        let next = RunFolder::open(folder.path()).unwrap();
        assert!(next.notes()[0].contains("has what a killed run has left"), "{:?}", next.notes());
        next.finish(&[]).unwrap();
        let left = folder.path().join(format!("{UNFINISHED}_1"));
        for name in ["notes.txt", "edited.csv"] {
            assert_eq!(fs::read_to_string(left.join(name)).unwrap(), "of the user");
        }
        assert!(!folder.path().join("notes.txt").exists());
    }
}
