//! States that earlier versions have written stay readable, and the layout has a version: `tests/states` has a folder of
//! examples for each version of the format.
//!
//! After a change of the layout, count up `VERSION` in `robot/src/state/format.rs`, and write the next examples:
//! `cargo test --test it write_the_states -- --ignored`

use crate::map_log::standing_log;
use crate::run::Run;
use robot::state::{State, read_state};
use std::fs;
use std::path::PathBuf;

/// The version of the format that this program writes.
const VERSION: u32 = 11;
/// What the examples are of. With the same duration or log again, a run only reads the state and writes it.
const RUNS: [(&str, &str); 3] = [
    ("four_rooms.state", "--duration 4"),
    ("drifting_house.state", "--world drifting_house --duration 4"),
    ("map_log.state", "a.log"),
];

/// The estimator that was the default of a version; with the present default, a run writes a prior as well.
fn estimator(version: u32) -> &'static str {
    if version < 8 { "--estimator two-state-gaps" } else { "" }
}

fn examples(version: u32) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("tests/states/{version}"))
}

/// Runs an example, from its state or from nothing; the state after it.
fn run(name: &str, arguments: &str, state: Option<&PathBuf>) -> (State, String) {
    let run = match name {
        "map_log.state" => Run::new().with_map_log(),
        _ => Run::new(),
    };
    run.write("a.log", &standing_log(1.7e9, 120));
    let flag = match state {
        Some(from) => {
            fs::copy(from, run.path(name)).unwrap();
            if name == "map_log.state" { "" } else { "--allow-other-build" }
        }
        None => "",
    };
    let said = run.goes_well(&format!("{arguments} {flag} --quiet --no-rrd --state {name}")).stderr;
    let version = fs::read(run.path(name)).unwrap()[8..12].try_into().unwrap();
    assert_eq!(u32::from_le_bytes(version), VERSION, "{name}");
    (read_state(&run.path(name)).unwrap(), said)
}

/// The parts that depend on the layout, not on the build.
fn parts(state: &State) -> Vec<(&str, Vec<u8>)> {
    // The filter of scans is in no example: a state without it is read as well.
    let parts = state.sections().filter(|(name, ..)| !["build", "filter"].contains(name));
    parts.map(|(name, _, bytes)| (name, bytes.to_vec())).collect()
}

fn mapper(state: &State) -> Option<Vec<u8>> {
    parts(state).into_iter().find(|(name, _)| *name == "mapper").map(|(_, bytes)| bytes)
}

#[test]
fn states_of_all_versions_are_read() {
    for version in 6..=VERSION {
        for (name, arguments) in RUNS {
            let path = examples(version).join(name);
            run(name, arguments, Some(&path)); // with the present default
            let (read, said) = run(name, &format!("{arguments} {}", estimator(version)), Some(&path));
            let was = read_state(&path).unwrap();
            let names =
                |state: &State| parts(state).iter().map(|(name, _)| name.to_string()).collect::<Vec<_>>();
            assert_eq!(names(&read), names(&was), "{version}/{name}");
            // What was learned about the place is as it was, without things before version 8; the poses of a localizer
            // before version 7 are searched for.
            let [read, was] = [&read, &was].map(|state| mapper(state).unwrap_or_default());
            assert!(read.starts_with(&was) && (version < 8 || read == was), "{version}/{name}");
            let searches = name == "drifting_house.state" && version < 7;
            assert_eq!(said.contains("searches for its pose"), searches, "{version}/{name}: {said}");
        }
    }
}

/// A state of this version that was read and written again is the same: otherwise its layout was changed, and `VERSION`
/// and the examples must follow.
#[test]
fn the_layout_of_a_state_belongs_to_its_version() {
    assert!(!examples(VERSION + 1).exists(), "examples of a later version: count up VERSION here");
    for (name, arguments) in RUNS {
        let path = examples(VERSION).join(name);
        let ((is, _), was) = (run(name, arguments, Some(&path)), read_state(&path).unwrap());
        assert!(parts(&is) == parts(&was), "{name}: the layout has changed: count up the version");
    }
}

#[test]
#[ignore = "writes the examples of this version"]
fn write_the_states() {
    fs::create_dir_all(examples(VERSION)).unwrap();
    for (name, arguments) in RUNS {
        fs::write(examples(VERSION).join(name), run(name, arguments, None).0.to_bytes().unwrap()).unwrap();
    }
}
