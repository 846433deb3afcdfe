//! Runs that fail or end at any operation lose nothing.

use super::super::super::disk::faults;
use super::*;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use proptest::{collection, option, sample};
use std::collections::BTreeMap;

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
        super::write(&folder, name, &format!("{name} {text}"));
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
