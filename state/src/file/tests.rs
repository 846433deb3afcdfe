use super::*;
use crate::Facts;
use proptest::prelude::*;
use std::collections::BTreeMap;

fn state() -> State {
    let facts =
        Facts::default().with("world", "house").with_settings("mapper", &BTreeMap::from([("max_gap", 8.0)]));
    State::default().with("mapper", facts, vec![1, 2, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 4])
}

#[test]
fn a_file_appears_when_it_is_complete_and_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("house.state");
    fs::write(unfinished_name(&path), "of a killed run").unwrap();
    let mut file = StateFile::new(&path);
    assert!(file.load().unwrap().is_none() && !file.is_due());
    file.save(State::default).unwrap();
    file.save(state).unwrap();
    file.wait().unwrap();
    assert_eq!(file.load().unwrap(), Some(state()));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    fs::write(&path, "[world]").unwrap();
    assert_eq!(file.load().unwrap_err().to_string(), "this is not a state file");
    let busy = File::create(unfinished_name(&path)).unwrap();
    busy.lock().unwrap();
    file.save(State::default).unwrap();
    assert_eq!(file.wait().unwrap_err().to_string(), "another run is writing it");
    assert_eq!(fs::read(&path).unwrap(), b"[world]");
    assert!(file.every(Duration::ZERO).is_due());
}

#[test]
fn a_file_that_cannot_be_written_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let mut file = StateFile::new(&folder.path().join("missing").join("house.state"));
    file.save(state).unwrap();
    assert_eq!(file.wait().unwrap_err().kind(), io::ErrorKind::NotFound);
}

#[test]
fn other_facts_and_files_are_refused_with_a_sentence() {
    let refused = |name: &str, facts| state().section(name, &facts).unwrap_err().to_string();
    let house = Facts::default().with("world", "house");
    insta::assert_snapshot!(refused("mapper", Facts::default().with("world", "office")), @"the state is of another run: `world` is `house` there, and `office` here");
    insta::assert_snapshot!(refused("mapper", house.clone()), @"the state is of another run: `mapper.max_gap` is `8.0` there, and not set here");
    insta::assert_snapshot!(refused("pilot", house), @"the state was saved by another program: it has no part `pilot`");
    let read = |bytes: &[u8]| State::from_bytes(bytes).unwrap_err().to_string();
    insta::assert_snapshot!(read(b"[world]\nname = \"house\""), @"this is not a state file");
    insta::assert_snapshot!(read(b""), @"this is not a state file");
    insta::assert_snapshot!(read(&state().to_bytes().unwrap()[..20]), @"the state file is damaged: its checksum does not fit");
    // A later version of the format, with a checksum as this version has it.
    let mut later = state().to_bytes().unwrap();
    later[8] = 5;
    let checksum = xxhash_rust::xxh3::xxh3_64_with_seed(&later[20..], 5);
    later[12..20].copy_from_slice(&checksum.to_le_bytes());
    insta::assert_snapshot!(read(&later), @"this state file has version 5 of the format, and this program reads version 4");
}

proptest! {
    #[test]
    fn any_flipped_bit_and_any_cut_is_refused(
        snapshot in prop::collection::vec(0..4_u8, 0..300),
        place in any::<prop::sample::Index>(),
        bit in 0..8_u8,
    ) {
        let facts = Facts::default().with("world", "house");
        let state = State::default().with("mapper", facts, snapshot);
        let whole = state.to_bytes().unwrap();
        prop_assert_eq!(State::from_bytes(&whole), Ok(state));
        let mut flipped = whole.clone();
        flipped[place.index(whole.len())] ^= 1 << bit;
        prop_assert!(State::from_bytes(&flipped).is_err());
        prop_assert!(State::from_bytes(&whole[..place.index(whole.len())]).is_err());
    }
}

#[test]
fn a_file_system_without_locks_is_written_to() {
    locked(Err(TryLockError::Error(io::ErrorKind::Unsupported.into()))).unwrap();
    locked(Err(TryLockError::WouldBlock)).unwrap_err();
}
