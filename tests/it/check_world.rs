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

/// Worlds and a map that differ from the shipped ones.
fn write_variants(folder: &Path) {
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    let four_rooms = include_str!("../../worlds/four_rooms.toml");
    write("none.toml", &four_rooms.replace("kind = \"driven\"", "kind = \"standing\""));
    write("omni.toml", &four_rooms.replacen("[robot.drive]", "[robot.drive]\nkind = \"omni\"", 1));
    write(
        "noisy.toml",
        &four_rooms.replacen("noise_std_m = 0.0", "noise_std_m = 0.01", 1).replacen(
            "[robot.drive]",
            "[robot.odometry]\ndistance_gain = 0.01\n[robot.drive]",
            1,
        ),
    );
    write(
        "slash.toml",
        &include_str!("../../worlds/two_blocks.toml").replacen("two blocks", "two/blocks", 1),
    );
    write(
        "map.yaml",
        "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.2\n",
    );
    write("map.pgm", "P2 2 1 255 0 255\n");
}

#[test]
fn robots_are_described_and_the_program_that_runs_the_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    write_variants(folder.path());
    let said = |file: &str| {
        let ended = check(folder.path(), &[file]);
        assert_eq!(ended.status.code(), Some(0), "{ended:?}");
        text(&ended.stdout).to_owned()
    };
    let lab = concat!(env!("CARGO_MANIFEST_DIR"), "/worlds/stage/lab.world");
    for (file, parts) in [
        (
            "four_rooms",
            vec!["10 Hz, noise 0 m; poses are exact\n", "runs in   four_rooms --world four_rooms\n"],
        ),
        ("two_blocks", vec!["runs in   grid_world --world two_blocks\n"]),
        (
            "none.toml",
            vec![
                "runs in   not in four_rooms: no robot is driven (exactly one robot has `kind = \"driven\"`",
            ],
        ),
        (
            "omni.toml",
            vec!["runs in   not in four_rooms: the driven robot `curious` has a drive of `kind = \"omni\"`"],
        ),
        (
            "noisy.toml",
            vec!["noise 0.01 m; its odometry drifts\n", "runs in   four_rooms --world noisy.toml\n"],
        ),
        (
            "slash.toml",
            vec!["runs in   not in grid_world: the world `two/blocks` in `slash.toml` needs another name"],
        ),
        ("map.yaml", vec!["map.yaml: valid, a floor plan", "runs in   four_rooms --map map.yaml\n"]),
        (lab, vec!["runs in   four_rooms --world "]),
    ] {
        let said = said(file);
        assert!(parts.iter().all(|part| said.contains(part)), "{said}");
    }
}

#[test]
fn of_many_robots_the_first_are_described() {
    let folder = tempfile::tempdir().unwrap();
    let robot = |i: usize| {
        format!(
            "[[robot]]\nname = \"r{i}\"\nradius_m = 0.{:03}\npose_m = [{}.5, {}.5]\n\
             [robot.drive]\nmax_linear_mps = 0.5\nmax_angular_degps = 90.0\n\
             max_linear_acceleration_mps2 = 1.0\nmax_angular_acceleration_degps2 = 360.0\n\
             [robot.laser]\nbeams = 360\nrange_max_m = 10.0\nrate_hz = 10.0\n\
             [robot.behavior]\nkind = \"standing\"\n",
            200 + i,
            i % 10,
            i / 10
        )
    };
    let robots: String = (0..30).map(robot).collect();
    let world = format!("name = \"many\"\n[map]\nsize_m = [10.0, 10.0]\ncell_m = 0.05\n{robots}");
    std::fs::write(folder.path().join("many.toml"), world).unwrap();
    let ended = check(folder.path(), &["many.toml"]);
    let said = text(&ended.stdout);
    assert_eq!(said.matches("  robot     `r").count(), 10, "{said}");
    assert!(said.contains("  robots    … and 20 more\n"), "{said}");
}

/// Names of files, descriptions and names in Stage files.
#[test]
fn nothing_that_is_printed_has_control_characters() {
    let folder = tempfile::tempdir().unwrap();
    let world = include_str!("../../worlds/two_blocks.toml");
    let forged = "a\u{1b}[2J\nforged.toml: valid";
    let described = world.replacen("description = \"", "description = \"\\u001b[2J\\nforged.toml: valid ", 1);
    let files = [
        (format!("{forged}.toml"), described),
        (format!("{forged}.world"), "model( name \"a\u{1b}[2J\" )\n".to_owned()),
        (format!("{forged}.yaml"), "image: \"\\e[2J\"\nresolution: \"\\e[2J\"".to_owned()),
    ];
    for (name, text) in &files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let mut arguments: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    arguments.push("--png");
    arguments.push("\u{1b}[2J\nno such file");
    let ended = check(folder.path(), &arguments);
    assert_eq!(ended.status.code(), Some(2), "{ended:?}");
    for output in [&ended.stdout, &ended.stderr] {
        let is_plain = |line: &str| !line.chars().any(char::is_control) && !line.starts_with("forged");
        assert!(text(output).lines().all(is_plain), "{ended:?}");
    }
    assert!(text(&ended.stderr).contains("`name` has a character that is not printable"), "{ended:?}");
}

#[test]
fn what_is_wrong_is_reported_for_every_file() {
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
