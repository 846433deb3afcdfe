//! The folder of the results, its exchange, and what it never touches.

mod faults;

use super::*;
use crate::exchange::MARKER;

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// A run that writes files, and a summary that lists them.
fn run(path: &Path, files: &[&str], inputs: &[&Path]) -> Result<(), OutputError> {
    let folder = RunFolder::open(path).unwrap();
    for file in files {
        fs::write(folder.unfinished().join(file), format!("{file} of {files:?}")).unwrap();
    }
    let summary = serde_json::json!({ "files": folder.results().unwrap() });
    fs::write(folder.unfinished().join("summary.json"), summary.to_string()).unwrap();
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
        fs::write(&file, text).unwrap();
        assert_eq!(run.results().unwrap(), ["own.rrd"]);
        let summary = serde_json::json!({ "files": run.results().unwrap() });
        fs::write(run.unfinished().join("summary.json"), summary.to_string()).unwrap();
        run.finish(&[]).unwrap();
        assert_eq!(fs::read_to_string(&file).unwrap(), text);
    }
    run(folder.path(), &["map.pgm"], &[]).unwrap();
    assert_eq!(names(folder.path()), [MARKER, "map.pgm", "summary.json"]);
}

#[test]
fn a_failed_run_leaves_the_earlier_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out");
    run(&path, &["map.pgm", "house.rrd"], &[]).unwrap();
    let failing = RunFolder::open(&path).unwrap();
    fs::write(failing.unfinished().join("map.pgm"), "half").unwrap();
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
        std::mem::forget(killed); // its lock as well: another file description has none
        let [new, lock] = [".new", LOCK].map(|name| folder.path().join(UNFINISHED).join(name));
        fs::write(&new, LOCK_CONTENT).unwrap();
        fs::rename(new, lock).unwrap();
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
    for wrong in [r#"{"files":["map.pgm"]}"#, "", r#"{"schema":1,"files":{"../a":{"bytes":0,"xxh3":""}}}"#] {
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
        fs::write(run.unfinished().join("map.pgm"), "new").unwrap();
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
