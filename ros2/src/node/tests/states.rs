//! States that earlier versions of the node have written stay readable, and the layout has a version, as for the states of
//! the other programs (`tests/it/state_examples.rs` of the workspace). The next example:
//! `cargo test -p curious-ros2 write_the_state -- --ignored`

use super::*;
use robot::state::{State, read_state};
use std::path::PathBuf;

/// The version of the format that this program writes.
const VERSION: u32 = 11;

fn example(version: u32) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../tests/states/{version}/curious_node.state"))
}

/// A tiny map: the file is small.
fn small() -> Parameters {
    Parameters { map_size_m: 6.0, ..parameters(Mode::Explore) }
}

/// The parts that depend on the layout, not on the build; without what was learned about beams without a return, which is in a
/// state only once something was.
fn parts(state: &State) -> Vec<(&str, Vec<u8>)> {
    let parts = state.sections().filter(|(name, ..)| !["build", "filter"].contains(name));
    parts.map(|(name, _, bytes)| (name, bytes.to_vec())).collect()
}

#[test]
fn states_of_all_versions_are_read_and_the_layout_belongs_to_its_version() {
    for version in 6..=VERSION {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("curious_node.state");
        std::fs::copy(example(version), &path).unwrap();
        let was = read_state(&path).unwrap();
        let (mut node, _, said) = node(&small(), Some(&path));
        let said = said.lock().unwrap().join("\n");
        assert!(said.contains("the map goes on from 10 readings"), "{version}: {said}");
        // After ten readings the map has no surface yet.
        assert_eq!(said.contains("its map has no surface"), version < 7, "{version}: {said}");
        let CuriousNode { robot, state_file, continued, .. } = &mut node;
        let state_file = state_file.as_mut().unwrap();
        state_file.save(continued.unwrap(), robot).unwrap();
        state_file.file.wait().unwrap();
        let is = read_state(&path).unwrap();
        let kept = parts(&is);
        let names =
            |parts: &[(&str, Vec<u8>)]| parts.iter().map(|(name, _)| name.to_string()).collect::<Vec<_>>();
        assert_eq!(names(&kept), names(&parts(&was)), "{version}");
        assert!(version < VERSION || kept == parts(&was), "the layout has changed: count up the version");
    }
}

#[test]
#[ignore = "writes the example of this version"]
fn write_the_state() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("curious_node.state");
    let world = worldfile::physics::parse_world("block.toml", include_str!("block.toml")).unwrap();
    let mut pair = Pair::in_world(&world, &small(), 1_700_000_000, Some(&path));
    while pair.node.report().readings < 10 {
        pair.run(0.1);
    }
    pair.node.run(&Signals { stop: AtomicBool::new(true), ..Signals::default() }).unwrap();
    std::fs::copy(path, example(VERSION)).unwrap();
}
