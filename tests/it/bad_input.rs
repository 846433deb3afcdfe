//! Invalid input leads to one message with the place, what is invalid and what would be valid. The exit code is 2,
//! and nothing is written.

use crate::run::Run;

const WORLD: &str = include_str!("../../worlds/four_rooms.toml");
const MAP: &str = "image: gone.pgm\nresolution: 0.05\norigin: [0.0, 0.0, 0.0]\nnegate: 0\n\
                   occupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// The output of `four_rooms` for `arguments`, with an input file `name`.
#[track_caller]
fn refused_file(name: &str, text: &str, arguments: &str) -> String {
    let run = Run::new();
    run.write(name, text);
    run.refuses(arguments)
}

#[track_caller]
fn refused(arguments: &str) -> String {
    Run::new().refuses(arguments)
}

#[track_caller]
fn refused_world(right: &str, wrong: &str) -> String {
    assert!(WORLD.contains(right), "{right} is not in the world");
    refused_file("house.toml", &WORLD.replacen(right, wrong, 1), "--world house.toml")
}

#[test]
fn worlds() {
    insta::assert_snapshot!(refused("--world nowhere"), @"error: --world: there is no world `nowhere`: it is neither a file nor one of those that ship (four_rooms, toy_on_the_floor, turned_house, house, drifting_house, office, warehouse, cave, yard, office_week; or a generated building: house-7, office-7, rooms-7, rooms-day-7, calendar-office-7 and so on)");
    insta::assert_snapshot!(refused_world("pose_m = [2.0, 2.0]", "pose_m = [6.0, 2.0]"), @"
    error: the robot `curious` starts in a wall or an obstacle
      --> house.toml:71:10
       |
    38 | [[wall]]
       | -------- in this one
    ...
    71 | pose_m = [6.0, 2.0]     # initial position of the robot's center
       |          ^^^^^^^^^^ stands here
       |
       = help: its middle must keep its radius of 0.2 m away
    ");
    let noise = ["nan", "inf", "-0.1", "1e300"].map(|wrong| format!("noise_std_m = {wrong}"));
    let noise = noise
        .each_ref()
        .map(|wrong| ("noise_std_m = 0.0 ", wrong.as_str(), "robot.laser.noise_std_m", "house.toml:96:15"));
    let others = [
        ("cell_m = 0.05", "cell_m = = 0.05", "error: this is not valid TOML: extra `=`", "house.toml:9:10"),
        ("max_linear_mps", "max_liner_mps", "error: unknown key `max_liner_mps`\n", "house.toml:75:1"),
        (
            "radius_m = 0.2 ",
            "radius_m = \"big\"",
            "`robot.radius_m` has the wrong type\n",
            "house.toml:70:12",
        ),
    ];
    for (right, wrong, says, place) in noise.into_iter().chain(others) {
        let message = refused_world(right, wrong);
        assert!(message.contains(says) && message.contains(place), "{message}");
    }
    let folder = Run::new();
    std::fs::create_dir(folder.path("attic")).unwrap();
    insta::assert_snapshot!(folder.refuses("--world attic"), @"error: --world: cannot read the world file `attic`: it is not a regular file (but a folder, a pipe or a device)");
}

/// A pipe would let a reader wait for ever, a device would fill the memory.
#[cfg(unix)]
#[test]
fn pipes_and_devices() {
    let folder = Run::new();
    nix::unistd::mkfifo(&folder.path("pipe"), nix::sys::stat::Mode::S_IRWXU).unwrap();
    for argument in ["--world", "--drive tour --tour", "--map"] {
        for file in ["pipe", "/dev/zero"] {
            let message = folder.refuses(&format!("{argument} {file}"));
            assert!(message.contains("it is not a regular file"), "{argument} {file}: {message}");
        }
    }
}

/// Escape sequences would reach the terminal, newlines would forge lines.
#[test]
fn names_and_values_that_are_not_printable() {
    let forged = "\\u001b[2J\\nerror: forged";
    for (right, wrong) in [
        ("name = \"four rooms\"", format!("name = \"{forged}\"")),
        ("kind = \"driven\"", format!("kind = \"{forged}\"")),
        ("max_linear_mps", format!("\"{forged}\" = 1\nmax_linear_mps")),
        ("[map]", format!("[[floor_plan]]\nimage = \"{forged}\"\npixel_m = 1.0\n[map]")),
        ("cell_m = 0.05", "cell_m = 1e9 # \u{1b}[2J\u{9b}2J".to_owned()),
    ] {
        let message = refused_world(right, &wrong);
        assert!(message.lines().all(|line| !line.chars().any(char::is_control)), "{message:?}");
    }
    let map = MAP.replace("gone.pgm", "\"\\e[2J\\nerror: forged\"");
    let message = refused_file("m.yaml", &map, "--map m.yaml");
    assert!(message.lines().all(|line| !line.chars().any(char::is_control)), "{message:?}");
}

#[test]
fn maps() {
    insta::assert_snapshot!(refused_file("m.yaml", MAP, "--map m.yaml"), @"
    error: cannot read the picture gone.pgm: No such file or directory (os error 2)
     --> m.yaml:1:8
      |
    1 | image: gone.pgm
      |        ^^^^^^^^
      |
      = help: `image` names a PNG or PGM picture, relative to this file
    ");
    for (yaml, pixels, says) in [
        (MAP.replace("0.05", "-1"), "P2 1 1 1 0", "error: `resolution` is `-1`\n --> m.yaml:2:13"),
        (MAP.to_owned(), "P5\n1000000 1000000\n255\n", "1000000 × 1000000 pixels are too many: at most"),
    ] {
        let run = Run::new();
        run.write("m.yaml", &yaml);
        run.write("gone.pgm", pixels);
        let message = run.refuses("--map m.yaml");
        assert!(message.contains(says), "{message}");
    }
    for broken in ["image: [", "resolution: 0.05", "", "\u{0}"] {
        let run = Run::new();
        run.write("m.yaml", broken);
        let ended = run.ends("--map m.yaml");
        assert_eq!((ended.code, run.names()), (Some(2), vec!["m.yaml".to_owned()]));
        ended.says(&["error: ", "m.yaml:1"]);
    }
}

#[test]
fn drives_without_a_controller() {
    let drive = |keys: &str| refused_world("[robot.drive]           #", &format!("[robot.drive]\n{keys}\n#"));
    insta::assert_snapshot!(drive("kind = \"omni\""), @r#"error: cannot run `house.toml`: the driven robot `curious` has a drive of `kind = "omni"`, but the controller supports only `kind = "diff"`: change `[robot.drive]`, or let another robot be the driven one"#);
    let car = drive("kind = \"car\"\nwheelbase_m = 0.2");
    assert!(car.contains("has a drive of `kind = \"car\"`, but"), "{car}");
}

#[test]
fn tours() {
    let message = refused_file("t.toml", "waypoint_m = [[1, 2]]", "--drive tour --tour t.toml");
    assert!(message.starts_with("error: unknown key `waypoint_m`\n --> t.toml:1:1\n"), "{message}");
    insta::assert_snapshot!(refused_file("t.toml", "waypoints_m = [[1, 2]]", "--tour t.toml"), @"error: --tour needs --drive tour");
    insta::assert_snapshot!(refused("--drive tour --strategy recency"), @"error: --strategy is for the agent: leave out --drive, or --strategy");
    insta::assert_snapshot!(refused("--drive tour --world house"), @"error: the tour that ships is for the walls of `four_rooms`: for `house`, give waypoints by --tour FILE");
}

#[test]
fn command_lines() {
    for (arguments, says) in [
        ("--duration=1001h", "at most 1000h"),
        ("--speed=inf", "a factor from 0.001 to 1000000, or max"),
        ("--rrd a.rrd --no-rrd", "'--rrd <FILE>' cannot be used with '--no-rrd'"),
        ("--connect=viewer:here", "`viewer:here` is not the address of a viewer: "),
        ("--sped=2", "a similar argument exists: '--speed'"),
    ] {
        let message = refused(arguments);
        assert!(message.contains(says), "{arguments}: {message}");
    }
}
