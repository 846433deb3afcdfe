//! The folder of the results, its exchange, and what it never touches.

use super::super::disk::faults;
use super::super::marker::MARKER;
use super::*;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use proptest::{collection, option, sample};
use std::collections::BTreeMap;

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
        fs::write(folder.path().join(UNFINISHED).join(".new"), LOCK_CONTENT).unwrap();
        fs::rename(folder.path().join(UNFINISHED).join(".new"), folder.path().join(UNFINISHED).join(LOCK))
            .unwrap();
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
    assert_eq!(
        error,
        format!(
            "cannot write {}: another run is writing there; wait for it, or give this one another folder by \
             --out",
            folder.path().display()
        )
    );
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
    assert_eq!(
        error.to_string().replace(&path.display().to_string(), "out"),
        "cannot write out/report.json: the results would replace it, and no run of this version wrote it (an earlier \
         version may have); move it, or give another folder by --out"
    );
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
    assert_eq!(
        opened.notes(),
        [format!("{}/a.toml was changed since a run wrote it: it stays", path.display())]
    );
    drop(opened);
    run(path, &["map.pgm"], &[]).unwrap();
    assert_eq!(names(path), [MARKER, "a.toml", "map.pgm", "summary.json"]);
    for wrong in [
        r#"{"files":["map.pgm"]}"#,
        "",
        r#"{"schema":1,"program":"","version":"","files":{"../a":{"bytes":0,"xxh3":""}}}"#,
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
    let marker = |name: &str| {
        format!(r#"{{"schema":1,"program":"","version":"","files":{{{name:?}:{{"bytes":0,"xxh3":""}}}}}}"#)
    };
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
        if fails {
            drop(run)
        } else {
            run.finish(&[]).unwrap()
        }
        assert_eq!(folder.path().join("map.pgm").exists(), !fails);
        drop(RunFolder::open(folder.path()).unwrap());
    }
    for number in [1, 2] {
        let kept = folder.path().join(format!("{UNFINISHED}_{number}/mine/notes.txt"));
        assert_eq!(fs::read_to_string(kept).unwrap(), "of the user");
    }
}

/// The files of the folder with their contents, without those of unfinished runs.
fn contents(folder: &Path) -> BTreeMap<String, String> {
    let is_result = |name: &String| !name.starts_with(UNFINISHED) && name != MARKER;
    let read = |name: String| {
        let path = folder.join(&name);
        let what = match path.symlink_metadata().unwrap() {
            known if known.is_symlink() => format!("-> {}", fs::read_link(&path).unwrap().display()),
            known if known.is_dir() => "a folder".to_owned(),
            _ => fs::read_to_string(&path).unwrap(),
        };
        (name, what)
    };
    names(folder).into_iter().filter(is_result).map(read).collect()
}

/// A run whose results are `name` with the text `name text`, with a fault in its exchange.
fn numbered_run(
    path: &Path,
    results: &[&str],
    text: &str,
    fault: Option<(usize, bool)>,
) -> Result<(), OutputError> {
    let folder = RunFolder::open(path)?;
    for name in results {
        fs::write(folder.unfinished().join(name), format!("{name} {text}")).unwrap();
    }
    faults::set(fault);
    let finished = folder.finish(&[]);
    let is_pending = faults::is_pending();
    faults::set(None);
    if is_pending {
        Err(OutputError::new(path, io::Error::other("no operation was left to fail")))
    } else {
        finished
    }
}

fn texts(results: &[&str], text: &str) -> BTreeMap<String, String> {
    results.iter().map(|name| ((*name).to_owned(), format!("{name} {text}"))).collect()
}

const FIRST: [&str; 3] = ["map.pgm", "house.rrd", "summary.json"];
const SECOND: [&str; 4] = ["a.png", "map.pgm", "office.rrd", "report.json"];

#[test]
fn a_fault_in_any_operation_loses_nothing() {
    for ends in [false, true] {
        for operation in 0.. {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path();
            fs::write(path.join("notes.txt"), "of the user").unwrap();
            numbered_run(path, &FIRST, "1", None).unwrap();
            let outcome = numbered_run(path, &SECOND, "2", Some((operation, ends)));
            let (mut old, mut new) = (texts(&FIRST, "1"), texts(&SECOND, "2"));
            for run in [&mut old, &mut new] {
                run.insert("notes.txt".into(), "of the user".into());
            }
            if outcome.as_ref().is_err_and(|error| error.why.to_string().starts_with("no operation")) {
                assert!(operation > 15, "{operation}: the exchange has more operations");
                break;
            }
            // The program lives on: one of the runs is whole. It ends: one of them is whole after the next start.
            if !ends {
                let found = contents(path);
                assert!(found == old || found == new, "{operation}: {found:?}");
            }
            let next = RunFolder::open(path).unwrap();
            let found = contents(path);
            assert!(found == new || found == old, "{operation} {ends}: {found:?}");
            if found == old {
                let kept = path.join(format!("{UNFINISHED}_1"));
                let kept = contents(&kept).into_iter().filter(|(name, _)| !name.starts_with('.'));
                assert_eq!(kept.collect::<BTreeMap<_, _>>(), texts(&SECOND, "2"), "{operation} {ends}");
            }
            drop(next);
            numbered_run(path, &FIRST, "3", None).unwrap();
            let third = texts(&FIRST, "3");
            assert!(third.iter().all(|(name, text)| contents(path).get(name) == Some(text)));
            assert_eq!(fs::read_to_string(path.join("notes.txt")).unwrap(), "of the user");
        }
    }
}

/// What happens to a folder.
#[derive(Clone, Debug)]
enum Event {
    Write(&'static str),
    Remove(&'static str),
    Folder(&'static str),
    Link(&'static str),
    Run(Vec<&'static str>, Option<(usize, bool)>),
}

fn events() -> impl Strategy<Value = Vec<Event>> {
    let name =
        || sample::select(vec!["map.pgm", "summary.json", "report.json", "a.toml", "data.csv", "thesis.tex"]);
    let fault = (0..20_usize, any::<bool>());
    let results = collection::btree_set(name(), 1..5).prop_map(Vec::from_iter);
    let event = prop_oneof![
        2 => name().prop_map(Event::Write),
        2 => name().prop_map(Event::Remove),
        1 => name().prop_map(Event::Folder),
        1 => name().prop_map(Event::Link),
        4 => (results, option::of(fault)).prop_map(|(results, fault)| Event::Run(results, fault)),
    ];
    collection::vec(event, 1..9)
}

/// `FOLDERS=20000 cargo test -p curious-results random_folders` tries more folders.
#[test]
fn random_folders_lose_nothing() {
    let cases = std::env::var("FOLDERS").map_or(500, |count| count.parse().unwrap());
    let mut runner = TestRunner::new(Config { cases, failure_persistence: None, ..Config::default() });
    runner
        .run(&events(), |events| {
            happens(&events);
            Ok(())
        })
        .unwrap();
}

/// Every file that the user has written, and every result of a run, is there until the user or a complete later run
/// removes it.
fn happens(events: &[Event]) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    // The results of the runs so far that may be in the folder: of the last complete one, or of a later one that failed.
    let mut owned: Vec<BTreeMap<String, String>> = vec![BTreeMap::new()];
    for (number, event) in events.iter().enumerate() {
        let text = number.to_string();
        match event {
            Event::Write(name) => drop(fs::write(path.join(name), &text)),
            Event::Remove(name) => {
                drop(fs::remove_file(path.join(name)).or_else(|_| fs::remove_dir(path.join(name))))
            }
            Event::Folder(name) => drop(fs::create_dir(path.join(name))),
            Event::Link(name) => drop(std::os::unix::fs::symlink("thesis.tex", path.join(name))),
            Event::Run(results, fault) => {
                let before = contents(path);
                let is_of_a_run =
                    |(name, text): &(&String, &String)| owned.iter().any(|run| run.get(*name) == Some(text));
                let foreign: Vec<_> = before.iter().filter(|file| !is_of_a_run(file)).collect();
                let outcome = numbered_run(path, results, &text, *fault);
                let after = contents(path);
                assert!(
                    foreign.iter().all(|(name, text)| after.get(*name) == Some(text)),
                    "{before:?} {after:?}"
                );
                let new = texts(results, &text);
                if let Err(error) = outcome {
                    let all = everything(path);
                    let is_kept = |file: &String| all.contains(file);
                    let refused =
                        error.is_refusal() && !all.iter().any(|file| new.values().any(|text| text == file));
                    assert!(refused || new.values().all(is_kept), "{error}; new: {new:?} {all:?}");
                    let is_lost =
                        |(name, text): (&String, &String)| before.get(name) == Some(text) && !is_kept(text);
                    let lost = owned.iter().flatten().any(is_lost);
                    owned.push(new);
                    // A start finishes the exchange of an earlier run: then its results are all there, somewhere.
                    let is_later_there = owned[1..].iter().any(|run| run.values().all(is_kept));
                    assert!(!lost || is_later_there, "{owned:?} {before:?} {all:?}");
                } else {
                    assert!(
                        new.iter().all(|(name, text)| after.get(name) == Some(text)),
                        "{new:?} {after:?}"
                    );
                    owned = vec![new];
                }
            }
        }
    }
}

/// The texts of all files, in folders as well.
fn everything(folder: &Path) -> BTreeSet<String> {
    let mut all = BTreeSet::new();
    for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
        match entry.file_type().unwrap() {
            kind if kind.is_dir() => all.extend(everything(&entry.path())),
            kind if kind.is_file() => drop(all.insert(fs::read_to_string(entry.path()).unwrap())),
            _ => {}
        }
    }
    all
}
