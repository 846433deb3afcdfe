//! `check_world` describes files of every kind, draws them, and reports what is invalid.

use std::path::Path;
use std::process::{Command, Output};

fn check(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_check_world")).args(arguments).current_dir(folder).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

#[test]
fn worlds_are_described_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let lab = concat!(env!("CARGO_MANIFEST_DIR"), "/worlds/stage/lab.world");
    let ended = check(folder.path(), &["--png", "--out", "plans", "two_blocks", "four_rooms", lab]);
    assert_eq!(ended.status.code(), Some(0), "{ended:?}");
    let said = text(&ended.stdout);
    assert!(said.contains("two_blocks: valid, a grid world named `two blocks`"), "{said}");
    assert!(said.contains("`dummy` follows a wall back and forth"), "{said}");
    assert!(text(&ended.stderr).contains("`gui_grid` (21)"));
    for (name, is_wide) in [("two_blocks", false), ("four_rooms", false), ("lab.world", true)] {
        let picture = image::open(folder.path().join("plans").join(format!("{name}.png"))).unwrap();
        let picture = picture.to_rgb8();
        // The plot of a square world is a square, with a title, axes and a legend above and below it.
        assert_eq!(picture.height() < picture.width(), is_wide, "{name}: {:?}", picture.dimensions());
        let walls = picture.pixels().filter(|pixel| pixel.0 == [70, 74, 82]).count();
        assert!(walls > 2000, "{name}: {walls} pixels of wall");
    }
}

/// Standard output that goes to a file on a full disk. The pictures are complete.
#[test]
#[cfg(target_os = "linux")]
fn a_description_on_a_full_disk() {
    let folder = tempfile::tempdir().unwrap();
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_check_world"));
    command.args(["--png", "two_blocks", "open_hall"]).current_dir(folder.path()).stdout(full);
    let ended = command.output().unwrap();
    assert_eq!(ended.status.code(), Some(1), "{ended:?}");
    let error = "error: cannot write to the standard output: No space left on device (os error 28)\n";
    assert_eq!(text(&ended.stderr), error);
    assert!(["two_blocks.png", "open_hall.png"].iter().all(|name| folder.path().join(name).exists()));
}

#[test]
fn what_is_wrong_is_told_of_every_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("ragged.toml"),
        "name = 'x'\nsensor_radius = 2\nmap = '''\n####\n#R#\n'''\n",
    )
    .unwrap();
    let ended = check(folder.path(), &["--png", "ragged.toml", "gone.toml", "two_blocks"]);
    assert_eq!(ended.status.code(), Some(2), "{ended:?}");
    let said = text(&ended.stderr);
    assert!(said.contains("error: the rows of the map are not equally long\n --> ragged.toml:5:1"), "{said}");
    assert!(said.contains("error: cannot read `gone.toml`"), "{said}");
    assert!(text(&ended.stdout).contains("gone.toml: invalid, 1 error"));
    let mut names: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|file| file.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["ragged.toml", "two_blocks.png"]);
}
