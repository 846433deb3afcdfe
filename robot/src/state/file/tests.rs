use super::*;
use crate::state::{SavedSettings, Session};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::fs;

fn state() -> State {
    State {
        sessions: vec![Session { name: "a".to_owned(), ..Session::default() }],
        surfaces: vec![1, 2, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 4],
        ..State::default()
    }
}

#[test]
fn a_file_appears_when_it_is_complete_and_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("house.state");
    let left = folder.path().join("house.unfinished.state");
    fs::write(&left, &state().to_bytes().unwrap()[..30]).unwrap(); // of a killed run
    fs::write(path.with_added_extension("lock"), "").unwrap();
    let mut file = StateFile::open(&path).unwrap();
    assert!(file.load().unwrap().is_none() && !file.is_due());
    file.save(State::default).unwrap();
    file.save(state).unwrap();
    file.wait().unwrap();
    assert_eq!(file.load().unwrap(), Some(state()));
    let file = file.every(Duration::ZERO);
    assert!(file.is_due());
    drop(file);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    fs::write(&left, "of the user").unwrap();
    let mut file = StateFile::open(&path).unwrap();
    file.save(state).unwrap();
    file.wait().unwrap();
    drop(file);
    assert_eq!(fs::read_to_string(&left).unwrap(), "of the user");
    fs::write(&path, "[world]").unwrap();
    insta::assert_snapshot!(read_state(&path).unwrap_err().to_string(), @"this is not a state file");
}

#[test]
fn a_file_that_cannot_be_written_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing");
    assert_eq!(StateFile::open(&missing.join("house.state")).unwrap_err().kind(), io::ErrorKind::NotFound);
    fs::create_dir(&missing).unwrap();
    let mut file = StateFile::open(&missing.join("house.state")).unwrap();
    fs::remove_dir_all(&missing).unwrap();
    file.save(state).unwrap();
    assert_eq!(file.wait().unwrap_err().kind(), io::ErrorKind::NotFound);
}

/// The lock lasts from before the reading to after the last writing, under any name of the file.
#[test]
fn a_second_user_is_refused_until_the_first_has_ended() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("house.state");
    let mut file = StateFile::open(&path).unwrap();
    let refused = |path: &Path| StateFile::open(path).unwrap_err().to_string();
    let why = "another run uses it; wait for its end, or give another file by --state";
    assert_eq!(refused(&path), why);
    file.save(state).unwrap();
    file.wait().unwrap();
    assert_eq!(refused(&path), why);
    #[cfg(unix)]
    {
        let link = folder.path().join("link.state");
        std::os::unix::fs::symlink(&path, &link).unwrap();
        assert_eq!(refused(&link), why);
    }
    assert_eq!(read_state(&path).unwrap(), state(), "whoever only reads is not refused");
    drop(file);
    assert_eq!(StateFile::open(&path).unwrap().load().unwrap(), Some(state()));
}

/// Many threads add one to a number in a file: no addition is lost, though the lock file comes and goes.
#[test]
fn whoever_has_the_lock_is_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("house.state");
    let count = || read_state(&path).map_or(0, |state| state.filter[0]);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..25 {
                    let mut tries = std::iter::repeat_with(|| StateFile::open(&path));
                    let mut file = tries.find_map(Result::ok).unwrap();
                    let next = count() + 1;
                    file.save(move || State { filter: vec![next], ..State::default() }).unwrap();
                    file.wait().unwrap();
                }
            });
        }
    });
    assert_eq!(count(), 100);
}

/// A state `Cargo` has the lock `Cargo.lock`.
#[test]
fn files_of_others_beside_the_state_stay() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("Cargo");
    let [lock, earlier] = ["lock", "earlier"].map(|ending| path.with_added_extension(ending));
    for other in [lock, earlier] {
        fs::write(&other, "of the user").unwrap();
        let error = StateFile::open(&path).unwrap_err().to_string();
        let why = "no run has written it, or it was changed since, and this one would replace it; move it, or give another file by \
                   --state";
        assert_eq!(error, format!("{}: {why}", other.display()));
        assert_eq!(fs::read_to_string(&other).unwrap(), "of the user");
        fs::remove_file(other).unwrap();
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn what_is_no_file_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    insta::assert_snapshot!(read_state(folder.path()).unwrap_err().to_string(), @"cannot read it: it is not a regular file (but a folder, a pipe or a device)");
}

/// The file is kept when the first session is added to it, and not for a second one.
#[test]
fn a_file_without_the_last_session_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("house.state");
    let with_sessions =
        |count: usize| State { sessions: vec![Session::default(); count], ..State::default() };
    let save = |counts: &[usize]| {
        let mut file = StateFile::open(&path).unwrap();
        file.load().unwrap();
        for count in counts {
            let state = with_sessions(*count);
            file.save(move || state).unwrap();
            file.wait().unwrap();
        }
        file
    };
    save(&[1, 1]).restore_earlier().unwrap_err();
    save(&[1, 2, 2, 3]);
    assert_eq!(read_state(&earlier_name(&path)).unwrap(), with_sessions(1));
    let mut file = save(&[]);
    file.restore_earlier().unwrap();
    assert_eq!(file.load().unwrap(), Some(with_sessions(1)));
    file.restore_earlier().unwrap_err();
}

#[test]
fn other_files_are_refused_with_a_sentence() {
    let read = |bytes: &[u8]| State::from_bytes(bytes).unwrap_err().to_string();
    insta::assert_snapshot!(read(b"[world]\nname = \"house\""), @"this is not a state file");
    insta::assert_snapshot!(read(b""), @"this is not a state file");
    insta::assert_snapshot!(read(&state().to_bytes().unwrap()[..20]), @"the state file is damaged: its checksum does not fit");
    // Another version of the format, and another layout, with a checksum as this version has it.
    let mut other = state().to_bytes().unwrap();
    other[8] = 12;
    let checksum = xxhash_rust::xxh3::xxh3_64_with_seed(&other[36..], 12);
    other[28..36].copy_from_slice(&checksum.to_le_bytes());
    insta::assert_snapshot!(read(&other), @"this state file has version 12 of the format, and this program reads version 1");
    let mut other = state().to_bytes().unwrap();
    other[12] ^= 1;
    insta::assert_snapshot!(read(&other), @"this state file has another layout: until version 0.1.0, only builds with the same layout read it; map the place again");
}

proptest! {
    #[test]
    fn any_flipped_bit_and_any_cut_is_refused(
        snapshot in prop::collection::vec(0..4_u8, 0..300),
        place in any::<prop::sample::Index>(),
        bit in 0..8_u8,
    ) {
        let state = State { surfaces: snapshot, ..State::default() };
        let whole = state.to_bytes().unwrap();
        prop_assert_eq!(State::from_bytes(&whole).unwrap(), state);
        let mut flipped = whole.clone();
        flipped[place.index(whole.len())] ^= 1 << bit;
        prop_assert!(State::from_bytes(&flipped).is_err());
        prop_assert!(State::from_bytes(&whole[..place.index(whole.len())]).is_err());
    }
}

#[test]
fn settings_that_must_agree_are_refused_and_others_are_a_note() {
    let settings = |estimator: &str, gap: f64| {
        let mapper = BTreeMap::from([("estimator", estimator.to_owned()), ("max_gap", gap.to_string())]);
        SavedSettings::default().with("world", &"house").with("mapper", &mapper)
    };
    let saved = settings("paper", 8.0);
    assert_eq!(saved.get::<String>("world").as_deref(), Some("house"));
    saved.check(&settings("paper", 8.0)).unwrap();
    assert_eq!(saved.agree(&settings("paper", 8.0)).unwrap(), None);
    insta::assert_snapshot!(saved.agree(&settings("paper", 9.0)).unwrap().unwrap(), @"other settings were used so far, those of this run count: mapper.max_gap = `8`");
    let refused = |result: Result<(), StateError>| result.unwrap_err().to_string();
    insta::assert_snapshot!(refused(saved.check(&settings("paper", 9.0))), @"the state is of another run: `mapper.max_gap` is `8` there, and `9` here");
    insta::assert_snapshot!(refused(saved.agree(&settings("shared-prior", 9.0)).map(drop)), @"the state is of another run: `mapper.estimator` is `paper` there, and `shared-prior` here");
    insta::assert_snapshot!(refused(saved.check(&SavedSettings::default().with("world", &"house"))), @"the state is of another run: `mapper.estimator` is `paper` there, and not set here");
}

/// A file that the user or another program puts in the place of the state is not replaced, whatever it is.
#[test]
fn what_is_no_state_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("house.state");
    let mut damaged = state().to_bytes().unwrap();
    *damaged.last_mut().unwrap() ^= 1;
    for other in [b"of the user".to_vec(), Vec::new(), State::MAGIC.to_vec(), damaged] {
        let mut file = StateFile::open(&path).unwrap();
        file.save(state).unwrap();
        file.wait().unwrap();
        fs::write(&path, &other).unwrap();
        file.save(State::default).unwrap();
        let error = file.wait().unwrap_err().to_string();
        assert!(error.starts_with("no run has written it, or it was changed"), "{error}");
        assert_eq!(fs::read(&path).unwrap(), other);
        fs::remove_file(&path).unwrap();
    }
    let mut other_version = state().to_bytes().unwrap();
    other_version[12] ^= 1; // the layout, of which the checksum knows nothing
    fs::write(&path, other_version).unwrap();
    let mut file = StateFile::open(&path).unwrap();
    file.save(state).unwrap();
    file.wait().unwrap();
}

#[test]
#[cfg(unix)]
fn a_link_that_leads_to_no_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("house.state");
    std::os::unix::fs::symlink("disk/house.state", &path).unwrap();
    let error = StateFile::open(&path).unwrap_err().to_string();
    assert!(error.starts_with("it is a link to disk/house.state, which is not there"), "{error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
