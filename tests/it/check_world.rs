//! `check_world` describes files of every kind, draws them, and reports what is invalid.

use crate::run::{Ended, Run};

const LAB: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/worlds/stage/lab.world");

#[test]
fn worlds_are_described_and_drawn() {
    let run = Run::of("check_world");
    let ended = run.goes_well(&format!("--png --out plans two_blocks four_rooms {LAB}"));
    ended.prints(&[
        "two_blocks: valid, a grid world named `two blocks`",
        "`dummy` follows a wall back and forth",
    ]);
    ended.says(&["`gui_grid` (21)"]);
    for (name, is_wide) in [("two_blocks", false), ("four_rooms", false), ("lab.world", true)] {
        let picture = image::open(run.path(&format!("plans/{name}.png"))).unwrap().to_rgb8();
        // The plot of a square world is a square, with a title, axes and a legend above and below it.
        assert_eq!(picture.height() < picture.width(), is_wide, "{name}: {:?}", picture.dimensions());
        let walls = picture.pixels().filter(|pixel| pixel.0 == [70, 74, 82]).count();
        assert!(walls > 2000, "{name}: {walls} pixels of wall");
    }
}

#[test]
fn robots_and_plans_are_described() {
    let run = Run::of("check_world");
    let four_rooms = include_str!("../../worlds/four_rooms.toml");
    let odometry = "[robot.odometry]\ndistance_gain = 0.01\n[robot.drive]";
    let noisy = four_rooms.replacen("noise_std_m = 0.0", "noise_std_m = 0.01", 1);
    run.write("noisy.toml", &noisy.replacen("[robot.drive]", odometry, 1));
    let map =
        "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.2\n";
    run.write("map.yaml", map);
    run.write("map.pgm", "P2 2 1 255 0 255\n");
    for (file, description) in [
        ("four_rooms", "10 Hz, noise 0 m; poses are exact\n"),
        ("two_blocks", "two_blocks: valid, a grid world"),
        ("noisy.toml", "noise 0.01 m; its odometry drifts\n"),
        ("map.yaml", "map.yaml: valid, a floor plan"),
    ] {
        run.goes_well(file).prints(&[description]);
    }
}

/// Names of files, descriptions and names in Stage files.
#[test]
fn nothing_that_is_printed_has_control_characters() {
    let run = Run::of("check_world");
    let world = include_str!("../../worlds/two_blocks.toml");
    let forged = "a\u{1b}[2J\nforged.toml: valid";
    let described = world.replacen("description = \"", "description = \"\\u001b[2J\\nforged.toml: valid ", 1);
    let mut command = run.command("--png");
    for (ending, text) in [
        ("toml", &described[..]),
        ("world", "model( name \"a\u{1b}[2J\" )\n"),
        ("yaml", "image: \"\\e[2J\"\nresolution: \"\\e[2J\""),
    ] {
        run.write(&format!("{forged}.{ending}"), text);
        command.arg(format!("{forged}.{ending}"));
    }
    let ended = Ended::from(command.arg("\u{1b}[2J\nno such file").output().unwrap());
    assert_eq!(ended.code, Some(2), "{ended:?}");
    for output in [&ended.stdout, &ended.stderr] {
        let is_plain = |line: &str| !line.chars().any(char::is_control) && !line.starts_with("forged");
        assert!(output.lines().all(is_plain), "{ended:?}");
    }
    ended.says(&["`name` has a character that is not printable"]);
}

#[test]
fn what_is_wrong_is_reported_for_every_file() {
    let run = Run::of("check_world");
    run.write("ragged.toml", "name = 'x'\nsensor_radius = 2\nmap = '''\n####\n#R#\n'''\n");
    let ended = run.ends("--png ragged.toml gone.toml two_blocks");
    assert_eq!(ended.code, Some(2), "{ended:?}");
    ended.says(&["error: the rows of the map are not equally long\n --> ragged.toml:5:1"]);
    ended.says(&["error: cannot read `gone.toml`"]);
    ended.prints(&["gone.toml: invalid, 1 error"]);
    assert_eq!(run.names(), ["ragged.toml", "two_blocks.png"]);
}
