//! What a file that is written by its own name replaces, and what not.

use super::*;
use crate::marker::{FILES, LOCK, LOCK_CONTENT};
use proptest::prelude::*;
use proptest::{collection, sample};
use std::collections::BTreeMap;
use std::os::unix::fs::symlink;

fn write(path: &Path, text: &str) -> Result<(), OutputError> {
    UnfinishedFile::create(path)?.write(|file| file.write_all(text.as_bytes()))
}

fn names(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<_> = names.filter(|name| name != FILES).collect();
    names.sort();
    names
}

#[test]
fn a_file_appears_when_it_is_complete() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    write(&path, "old").unwrap();
    fs::write(folder.path().join("a.unfinished.txt"), "of a killed run").unwrap();
    let file = UnfinishedFile::create(&path).unwrap();
    file.file().write_all(b"new").unwrap();
    let busy = UnfinishedFile::create(&path).unwrap_err().to_string();
    assert!(busy.ends_with("another run is writing there; wait for it, or give another name"), "{busy}");
    assert_eq!(fs::read(&path).unwrap(), b"old");
    file.finish().unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    drop(UnfinishedFile::create(&path).unwrap());
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(names(folder.path()), ["a.txt", "a.unfinished.txt"]);
    assert_eq!(fs::read(folder.path().join("a.unfinished.txt")).unwrap(), b"of a killed run");
}

#[test]
fn what_killed_runs_have_left_of_a_file_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    for content in ["", "", "a part", "another", "one more"] {
        let mut file = UnfinishedFile::create(&path).unwrap();
        file.write_all(content.as_bytes()).unwrap();
        let Target { folder, partial, .. } = file.target.take().unwrap();
        assert!(folder.has_file(partial), "it is left");
    }
    let left = ["a.unfinished.txt", "a.unfinished_2.txt", "a.unfinished_3.txt"];
    assert_eq!(names(folder.path()), left);
    assert!(left.iter().all(|name| is_temporary(name.as_ref())));
    assert!(["a.txt", "unfinished.txt", "b.unfinishe.txt"].iter().all(|name| !is_temporary(name.as_ref())));
}

#[test]
fn what_happens_while_a_file_is_written_loses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    let file = UnfinishedFile::create(&path).unwrap();
    file.file().write_all(b"new").unwrap();
    fs::write(&path, "of the user").unwrap();
    let error = file.finish().unwrap_err();
    assert!(error.is_refusal() && error.to_string().contains("; the new one is "), "{error}");
    assert_eq!(fs::read(&path).unwrap(), b"of the user");
    assert_eq!(fs::read(folder.path().join("a.unfinished.txt")).unwrap(), b"new");
    let path = folder.path().join("b.txt");
    let file = UnfinishedFile::create(&path).unwrap();
    fs::remove_file(folder.path().join("b.unfinished.txt")).unwrap();
    assert!(file.finish().unwrap_err().to_string().contains("it was removed while it was written"));
}

#[test]
#[cfg(target_os = "linux")]
fn a_device_is_written_directly() {
    let file = UnfinishedFile::create(Path::new("/dev/null")).unwrap();
    file.file().write_all(b"new").unwrap();
    file.finish().unwrap();
    assert!(fs::metadata("/dev/null").unwrap().len() == 0);
}

#[test]
fn a_file_in_the_folder_of_a_run_replaces_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(LOCK), LOCK_CONTENT).unwrap();
    let path = folder.path().join("a.txt");
    write(&path, "first").unwrap();
    assert!(write(&path, "second").unwrap_err().is_refusal());
    assert_eq!(fs::read(&path).unwrap(), b"first");
    let proof = Proof { start: b"own", is_intact: |_| true };
    assert!(super::check_output(&path, Some(proof)).unwrap_err().is_refusal(), "this folder is of a run");
}

#[test]
fn a_file_with_a_proof_is_replaced_by_it_alone() {
    fn is_own(mut file: &File) -> bool {
        let mut text = String::new();
        io::Read::read_to_string(&mut file, &mut text).is_ok() && text.starts_with("own ") && text.len() == 5
    }
    let is_own = Proof { start: b"own", is_intact: is_own };
    let folder = tempfile::tempdir().unwrap();
    let [path, other] = ["a.state", "b.state"].map(|name| folder.path().join(name));
    let write = |text: &str| {
        UnfinishedFile::with_proof(&path, Some(is_own))?.write(|file| file.write_all(text.as_bytes()))
    };
    let [killed, foreign] =
        ["a.unfinished.state", "a.unfinished_2.state"].map(|name| folder.path().join(name));
    fs::write(&killed, "own half").unwrap();
    write("own 1").unwrap();
    assert!(!killed.exists(), "a part is removed");
    fs::write(&killed, "own 7").unwrap();
    write("own 1").unwrap();
    assert_eq!(fs::read(&killed).unwrap(), b"own 7", "a complete one was renamed by somebody");
    [&killed, &foreign].iter().for_each(|file| fs::write(file, "of the user").unwrap());
    write("own 1").unwrap();
    [killed, foreign].iter().for_each(|file| {
        assert_eq!(fs::read(file).unwrap(), b"of the user");
        fs::remove_file(file).unwrap();
    });
    write("own 2").unwrap();
    assert!(super::replace(&path, &other, is_own).unwrap_err().why.kind() == io::ErrorKind::NotFound);
    fs::write(&other, "of the user").unwrap();
    assert!(super::replace(&path, &other, is_own).unwrap_err().is_refusal());
    fs::write(&other, "own 3").unwrap();
    super::replace(&path, &other, is_own).unwrap();
    assert_eq!(names(folder.path()), ["a.state"]);
    assert_eq!(fs::read(&path).unwrap(), b"own 3");
    fs::write(&path, "of the user").unwrap();
    assert!(write("own 4").unwrap_err().is_refusal());
    assert_eq!(fs::read(&path).unwrap(), b"of the user");
}

/// What happens to a name in a folder.
#[derive(Clone, Debug)]
enum Event {
    /// The user writes a file anew, or into the one that is there.
    Write(&'static str),
    Into(&'static str),
    Remove(&'static str),
    Folder(&'static str),
    Link(&'static str, &'static str),
    HardLink(&'static str, &'static str),
    Rename(&'static str, &'static str),
    /// A run writes the file.
    Run(&'static str),
}

fn events() -> impl Strategy<Value = Vec<Event>> {
    let all =
        ["a.txt", "a.unfinished.txt", "a.unfinished_2.txt", "b", "b.unfinished", FILES, ".curious_run.json"];
    let name = move || sample::select(all.to_vec());
    let event = prop_oneof![
        2 => name().prop_map(Event::Write),
        2 => name().prop_map(Event::Into),
        1 => name().prop_map(Event::Remove),
        1 => name().prop_map(Event::Folder),
        1 => (name(), name()).prop_map(|(a, b)| Event::Link(a, b)),
        1 => (name(), name()).prop_map(|(a, b)| Event::HardLink(a, b)),
        1 => (name(), name()).prop_map(|(a, b)| Event::Rename(a, b)),
        6 => name().prop_map(Event::Run),
    ];
    collection::vec(event, 1..12)
}

/// The texts of all regular files, by their names.
fn texts(folder: &Path) -> BTreeMap<String, String> {
    let all = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = all.filter(|path| path.symlink_metadata().unwrap().is_file());
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    files.map(|path| (name(&path), fs::read_to_string(&path).unwrap())).collect()
}

/// Every text of the user is under its name until the user removes it, and so is every text outside of the
/// folder. `FOLDERS=5000 cargo test -p curious-files random_events` tries more folders.
#[test]
fn random_events_lose_nothing_of_the_user() {
    let cases = std::env::var("FOLDERS").map_or(150, |count| count.parse().unwrap());
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    let mut runner = proptest::test_runner::TestRunner::new(config);
    let happens = |events: Vec<Event>| {
        let outer = tempfile::tempdir().unwrap();
        let [folder, outside] = ["in", "out"].map(|name| outer.path().join(name));
        fs::create_dir(&folder).unwrap();
        fs::write(&outside, "outside").unwrap();
        let of_runs = |text: &String| text.starts_with("run ") || text.starts_with('{');
        for (number, event) in events.iter().enumerate() {
            let path = |name: &str| folder.join(name);
            let text = format!("user {number}");
            match event {
                Event::Write(name) => {
                    drop(fs::remove_file(path(name)));
                    drop(fs::write(path(name), text));
                }
                Event::Into(name) => drop(fs::write(path(name), text)),
                Event::Remove(name) => drop(fs::remove_file(path(name)).or(fs::remove_dir(path(name)))),
                Event::Folder(name) => drop(fs::create_dir(path(name))),
                Event::Link(name, to) if to.starts_with('.') => drop(symlink(&outside, path(name))),
                Event::Link(name, to) => drop(symlink(to, path(name))),
                Event::HardLink(name, to) if to.starts_with('.') => drop(fs::hard_link(&outside, path(name))),
                Event::HardLink(name, to) => drop(fs::hard_link(path(to), path(name))),
                Event::Rename(name, to) => drop(fs::rename(path(name), path(to))),
                Event::Run(name) => {
                    let mut before = texts(&folder);
                    before.retain(|_, text| !of_runs(text));
                    let far = fs::read_to_string(&outside).unwrap();
                    let outcome = write(&path(name), &format!("run {number}"));
                    let after = texts(&folder);
                    for (name, text) in before {
                        prop_assert_eq!(after.get(&name), Some(&text), "{:?}", events);
                    }
                    prop_assert_eq!(outcome.is_ok(), after.get(*name) == Some(&format!("run {number}")));
                    if outcome.is_ok() {
                        write(&path(name), &format!("run {number}")).unwrap(); // the same command works again
                    }
                    prop_assert_eq!(fs::read_to_string(&outside).unwrap(), far);
                }
            }
        }
        Ok(())
    };
    runner.run(&events(), happens).unwrap();
}
