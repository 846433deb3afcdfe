//! Invalid input leads to one message with the place, what is invalid and what would be valid. The exit code is 2,
//! and nothing is written.

use crate::run::Run;

const WORLD: &str = include_str!("../../../worlds/two_blocks.toml");

#[track_caller]
fn refused(arguments: &str) -> String {
    Run::of("grid_world").refuses(arguments)
}

/// The messages for a shipped world with a mistake in it.
#[track_caller]
fn refused_world(right: &str, wrong: &str) -> String {
    assert!(WORLD.contains(right), "{right} is not in the world");
    let run = Run::of("grid_world");
    run.write("grid.toml", &WORLD.replacen(right, wrong, 1));
    run.refuses("--world two_blocks --world grid.toml")
}

#[test]
fn worlds() {
    insta::assert_snapshot!(refused("--world nowhere"), @"error: --world: there is no world `nowhere`: it is neither a file nor one of those that ship (two_blocks, open_hall, corridor_with_doors, many_slow_blocks, one_fast_block; or a generated building: generated-7, grid-rooms-7, grid-rooms-day-7, calendar-office-7 and so on)");
    let message = refused_world("sensor_radius", "sensor_radios");
    assert!(message.starts_with("error: unknown key `sensor_radios`\n  --> grid.toml:10:1\n"), "{message}");
    for wrong in ["4.5", "0", "-1", "101", "1000000000000"] {
        let message = refused_world("sensor_radius = 4", &format!("sensor_radius = {wrong}"));
        assert!(message.contains("sensor_radius") && message.contains("grid.toml:10:17"), "{message}");
    }
    insta::assert_snapshot!(refused_world("name = \"two blocks\"", "name = \"two blocks\""), @"error: two worlds have the name `two blocks`: results are listed by name, so give each world its own name");
    let folder = Run::of("grid_world");
    std::fs::create_dir(folder.path("grid")).unwrap();
    insta::assert_snapshot!(folder.refuses("--world grid"), @"error: --world: cannot read the world file `grid`: it is not a regular file (but a folder, a pipe or a device)");
}

/// Files of results contain the names of worlds.
#[test]
fn names_that_are_no_names_of_files() {
    let named = |name: &str| refused_world("name = \"two blocks\"", &format!("name = \"{name}\""));
    insta::assert_snapshot!(named("a/b"), @"error: --world: the world `a/b` in `grid.toml` needs another name, since files of results contain it: it has the character `/`; `a_b` would be valid");
    for (name, why) in [
        ("..", "it begins with a dot"),
        (".hidden", "it begins with a dot"),
        ("a\\\\b", "it has the character"),
        (&"n".repeat(101), "it has 101 bytes, and 100 are the most"),
    ] {
        let message = named(name);
        assert!(message.contains(why) && message.contains("grid.toml"), "{message}");
    }
}

#[test]
fn worlds_of_the_other_kind() {
    let file = |name: &str| format!("{}/worlds/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let message = refused(&format!("--world {}", file("four_rooms")));
    assert!(message.starts_with("error: this is a physics world, not a grid world\n"), "{message}");
    assert!(message.contains("a grid world draws its `map` as text"), "{message}");
    insta::assert_snapshot!(refused("--world four_rooms"), @"error: --world: `four_rooms` is a physics world: it is for the program four_rooms");

    let message = Run::new().refuses(&format!("--world {}", file("two_blocks")));
    assert!(message.starts_with("error: this is a grid world, not a physics world\n"), "{message}");
    assert!(message.contains("a physics world has a table `[map]`"), "{message}");
    insta::assert_snapshot!(Run::new().refuses("--world two_blocks"), @"error: --world: `two_blocks` is a grid world: it is for the program grid_world");
}

#[test]
fn command_lines() {
    for (arguments, says) in [
        ("--stochastic=nan", "must be above 0, and at most 1"),
        ("--save-worlds", "--generate <N>"),
        ("--sead=2", "a similar argument exists: '--seed'"),
    ] {
        let message = refused(arguments);
        assert!(message.contains(says), "{arguments}: {message}");
    }
}
